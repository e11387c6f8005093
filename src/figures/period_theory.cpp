#include "corda/figures/period_theory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "corda/reference/pendulum.hpp"

namespace corda::figures {
namespace {

/// Whether a rope hangs from its first particle, and only weight acts on it.
bool is_plain(const RopeDef& rope, const Scene& scene) {
    return !rope.closed && rope.rest_m.empty() && rope.bending_n_m2 == 0.0 &&
           rope.pinned == std::vector<std::uint32_t>{0} && scene.world.drag_1_s == 0.0 &&
           rope.material.compliance_1_n == 0.0;
}

/// The length of all links if they are equal.
std::optional<double> link_length_m(const RopeDef& rope) {
    const auto length_m = [&](std::size_t link) {
        const Vec2 d = rope.points_m[link + 1] - rope.points_m[link];
        return std::hypot(d.x, d.y);
    };
    for (std::size_t link = 1; link + 1 < rope.points_m.size(); ++link)
        if (std::abs(length_m(link) - length_m(0)) > 1e-9 * length_m(0)) return std::nullopt;
    return length_m(0);
}

/// Whether a rope is straight and its particles have at most 1 % of the payload's mass, which then shorten
/// the period of a point pendulum by a twelfth of that: less than 0.1 %.
bool has_heavy_end(const RopeDef& rope, double length_m) {
    constexpr double kSmallShare = 0.01;
    const Vec2 span = rope.points_m.back() - rope.points_m.front();
    const bool is_straight = std::abs(std::hypot(span.x, span.y) - length_m) <= 1e-9 * length_m;
    return is_straight &&
           std::accumulate(rope.mass_kg.begin(), rope.mass_kg.end(), 0.0) <= kSmallShare * rope.payload_kg;
}

/// The acceleration downwards that a rope feels; 0 or less: none that theory knows.
double gravity_m_s2(const RopeDef& rope, const Scene& scene) {
    Vec2 gravity = scene.world.gravity_m_s2;
    if (const auto* const relaxation = std::get_if<RelaxationDef>(&scene.solver);
        relaxation != nullptr && relaxation->force_n)
        gravity = {relaxation->force_n->x / rope.mass_kg.front(),
                   relaxation->force_n->y / rope.mass_kg.front()};
    return gravity.x == 0.0 ? -gravity.y : 0.0;
}

}  // namespace

std::optional<PeriodTheory> period_theory(const Scene& scene, double angle_deg) {
    if (scene.ropes.size() != 1 || !scene.nets.empty()) return std::nullopt;
    const RopeDef& rope = scene.ropes.front();
    const auto length_m = link_length_m(rope);
    const double gravity = gravity_m_s2(rope, scene);
    if (!is_plain(rope, scene) || !length_m || !(gravity > 0.0) || !(angle_deg < 180.0)) return std::nullopt;
    constexpr long double kPi = std::numbers::pi_v<long double>;
    const auto pendulum_s = [&](long double omega0_1_s) {
        return reference::Pendulum(omega0_1_s, angle_deg * kPi / 180.0L).period_s();
    };
    const int links = static_cast<int>(rope.points_m.size()) - 1;
    if (links == 1)
        return {{pendulum_s(std::sqrt(gravity / *length_m)), "a point pendulum of this amplitude"}};
    if (has_heavy_end(rope, links * *length_m))
        return {{pendulum_s(std::sqrt(gravity / (links * *length_m))),
                 "a point pendulum of this amplitude, with all mass at the end of the rope,"}};
    const bool has_equal_masses =
        rope.payload_kg == 0.0 &&
        std::ranges::all_of(rope.mass_kg, [&](double mass_kg) { return mass_kg == rope.mass_kg.front(); });
    if (!has_equal_masses) return std::nullopt;
    if (rope.reach > 1)
        return {{pendulum_s(reference::rod_omega0_1_s(links, *length_m, gravity)),
                 "a rigid rod of this amplitude, as which longer bars tend to hold a rope,"}};
    return {{static_cast<double>(2.0L * kPi / reference::rope_omega0_1_s(links, *length_m, gravity)),
             fmt::format("a hanging rope of {} links at small angles", links)}};
}

}  // namespace corda::figures
