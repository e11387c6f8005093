#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "support/estimate_families.hpp"

namespace corda::test {
namespace {

using Real = ExtendedMotion::Real;

/// Masses that differ by up to 1e14 in a straight rope at rest, which comes taut when it has fallen, and by
/// up to 1e8 in a crooked one.
EstimateCase mass_mix(Random& random) {
    const bool is_straight = pick(random, 0, 1) == 0;
    RopeDef rope = crooked_rope(random, pick(random, 2, 5), any_angle(random),
                                is_straight ? 0.0 : pick_log(random, 1e-6, 1.0));
    const double spread = pick_log(random, 1e2, is_straight ? 1e7 : 1e4);
    for (std::size_t i = 0; i < rope.points_m.size(); ++i)
        rope.mass_kg.push_back(pick_log(random, 1.0 / spread, spread));
    return one_rope(random, rope, pick_real(random, 0.2, 0.8));
}

/// Masses that differ by up to 1e14 in a thrown rope without pins.
EstimateCase mass_mix_free(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 1, 5), any_angle(random),
                                pick(random, 0, 1) == 0 ? 0.0 : pick_log(random, 1e-6, 1.0));
    const double spread = pick_log(random, 1e2, 1e7);
    for (std::size_t i = 0; i < rope.points_m.size(); ++i)
        rope.mass_kg.push_back(pick_log(random, 1.0 / spread, spread));
    throw_it(random, rope);
    if (pick(random, 0, 1) == 0) {  // bent as well
        for (Vec2& v : rope.velocity_m_s)
            v = v + Vec2{pick_real(random, -3.0, 3.0), pick_real(random, -3.0, 3.0)};
    }
    return one_rope(random, rope, pick_real(random, 0.2, 0.8));
}

/// Share of a motion without forces that linear drag leaves until `time_s`: the integral of exp(-drag t).
Real passed_s(const WorldDef& world, double time_s) {
    const Real drag_1_s = world.drag_1_s;
    return drag_1_s == 0 ? Real{time_s} : -std::expm1(-drag_1_s * time_s) / drag_1_s;
}

/// Way of a thrown particle.
Real fall_m(const WorldDef& world, double acceleration_m_s2, double speed_m_s, double time_s) {
    const Real drag_1_s = world.drag_1_s;
    const Real passed = passed_s(world, time_s);
    return speed_m_s * passed +
           acceleration_m_s2 * (drag_1_s == 0 ? Real{time_s} * time_s / 2 : (time_s - passed) / drag_1_s);
}

/// A closed rope of four equal links and masses, thrown: its half angle and its direction change uniformly,
/// as r^2 is the same over all of its particles in every shape. It is often flat at a frame.
EstimateCase rhombus(Random& random) {
    const double side_m = pick_log(random, 0.3, 3.0);
    const double half = pick_real(random, 0.2, 1.3);
    const double turned = any_angle(random);
    const double turn_1_s = pick(random, 0, 1) == 0 ? 0.0 : pick_real(random, -2.0, 2.0);
    const Vec2 thrown_m_s{pick_real(random, -1.0, 1.0), pick_real(random, -1.0, 1.0)};
    EstimateCase made = one_rope(random, RopeDef{}, 3.0);
    WorldDef& world = made.scene.world;
    if (pick(random, 0, 1) == 0) world.gravity_m_s2 = {};
    const double frame_s = made.scene.video.fps.interval_s() * pick(random, 1, 30);
    const double until_s = pick(random, 0, 2) == 0 ? pick_real(random, 0.1, 2.0) : frame_s;
    const double close_1_s = -half / static_cast<double>(passed_s(world, until_s));

    RopeDef& rope = made.scene.ropes.front();
    rope.closed = true;
    rope.pinned = {};
    // Corner i is at `arm` along the axis that is turned by i right angles.
    const auto corner = [=](int i, Real shape, Real direction) {
        const Real arm = side_m * (i % 2 == 0 ? std::cos(shape) : std::sin(shape));
        const Real angle = direction + i * std::numbers::pi_v<Real> / 2;
        return std::array<Real, 2>{arm * std::cos(angle), arm * std::sin(angle)};
    };
    std::vector<std::array<Real, 2>> start;
    for (int i = 0; i < 4; ++i) {
        start.push_back(corner(i, half, turned));
        const double arm_m_s = close_1_s * side_m * (i % 2 == 0 ? -std::sin(half) : std::cos(half));
        const double angle = turned + i * std::numbers::pi / 2;
        rope.points_m.push_back({static_cast<double>(start[i][0]), static_cast<double>(start[i][1])});
        rope.velocity_m_s.push_back(thrown_m_s + arm_m_s * Vec2{std::cos(angle), std::sin(angle)} +
                                    turn_1_s * left_of(rope.points_m.back()));
    }
    made.truth = [=](double time_s, std::size_t i) {
        const Real passed = passed_s(world, time_s);
        auto at = corner(static_cast<int>(i), half + close_1_s * passed, turned + turn_1_s * passed);
        at[0] += fall_m(world, world.gravity_m_s2.x, thrown_m_s.x, time_s);
        at[1] += fall_m(world, world.gravity_m_s2.y, thrown_m_s.y, time_s);
        return at;
    };
    return made;
}

/// Angles of the pendulum angle'' = -a sin(angle) - drag angle', by Taylor series of order 24 in extended
/// precision with steps that shrink with its speed.
class PendulumTruth {
  public:
    PendulumTruth(Real square_1_s2, Real drag_1_s, Real angle, Real rate_1_s)
        : square_(square_1_s2), drag_(drag_1_s), angle_(angle), rate_(rate_1_s) {}

    Real angle_at(Real time_s) {
        while (time_ < time_s) {
            const Real most = Real{0.05L} / (std::sqrt(square_) + std::abs(rate_) + drag_);
            step(std::min(most, time_s - time_));
        }
        return angle_;
    }

  private:
    static constexpr int kOrder = 24;
    void step(Real h) {
        std::array<Real, kOrder + 1> angle{angle_, rate_};
        std::array<Real, kOrder + 1> sine{std::sin(angle_)};
        std::array<Real, kOrder + 1> cosine{std::cos(angle_)};
        for (int k = 0; k + 2 <= kOrder; ++k) {
            angle[k + 2] = (-square_ * sine[k] - drag_ * (k + 1) * angle[k + 1]) / ((k + 1) * (k + 2));
            for (int j = 0; j <= k; ++j) {
                sine[k + 1] += (j + 1) * angle[j + 1] * cosine[k - j] / (k + 1);
                cosine[k + 1] -= (j + 1) * angle[j + 1] * sine[k - j] / (k + 1);
            }
        }
        Real rate = 0;
        Real moved = 0;
        for (int k = kOrder; k > 0; --k) {
            rate = rate * h + k * angle[k];
            moved = (moved + angle[k]) * h;
        }
        angle_ += moved;
        rate_ = rate;
        time_ += h;
    }

    Real square_, drag_, angle_, rate_;
    Real time_ = 0;
};

/// Two equal cranks on pins, joined by a bar as long as the pins are apart: each of its particles is a
/// pendulum. Many pass the line of all bars, where a second motion branches off.
EstimateCase parallelogram(Random& random) {
    const double crank_m = pick_log(random, 0.3, 2.0);
    const double base_m = crank_m * pick_log(random, 0.2, 4.0);
    const double along = any_angle(random);
    const double lean = along + any_angle(random);  // of the cranks
    const double turn_1_s = pick_real(random, -12.0, 12.0) / std::sqrt(crank_m);
    const Vec2 base = base_m * Vec2{std::cos(along), std::sin(along)};
    const Vec2 crank = crank_m * Vec2{std::sin(lean), -std::cos(lean)};
    RopeDef rope;
    rope.points_m = {{}, crank, base + crank, base};
    rope.pinned = {0, 3};
    rope.velocity_m_s = {{}, turn_1_s * left_of(crank), turn_1_s * left_of(crank), {}};
    for (int i = 0; i < 4; ++i) rope.mass_kg.push_back(pick_log(random, 0.1, 10.0));
    EstimateCase made = one_rope(random, rope, 3.0);
    if (pick(random, 0, 1) == 0) {  // as a graph, which another method moves
        NetDef net;
        net.points_m = rope.points_m;
        net.bars = {{0, 1}, {1, 2}, {2, 3}};
        net.pinned = rope.pinned;
        net.velocity_m_s = rope.velocity_m_s;
        net.mass_kg = rope.mass_kg;
        made.scene.ropes.clear();
        made.scene.nets = {net};
    }
    const auto pendulum = std::make_shared<PendulumTruth>(
        -made.scene.world.gravity_m_s2.y / std::hypot(Real{crank.x}, Real{crank.y}),
        made.scene.world.drag_1_s, std::atan2(Real{crank.x}, -Real{crank.y}), turn_1_s);
    made.truth = [=](double time_s, std::size_t i) {
        const Real angle = pendulum->angle_at(time_s);
        const Real length_m = std::hypot(Real{crank.x}, Real{crank.y});
        const Real moves = i == 1 || i == 2 ? 1 : 0;
        const Real shift = i >= 2 ? 1 : 0;
        return std::array<Real, 2>{shift * base.x + moves * length_m * std::sin(angle),
                                   shift * base.y - moves * length_m * std::cos(angle)};
    };
    return made;
}

}  // namespace

std::span<const EstimateFamily> mass_and_linkage_families() {
    static const auto families = std::to_array<EstimateFamily>({{"mass_mix", mass_mix},
                                                                {"mass_mix_free", mass_mix_free},
                                                                {"rhombus", rhombus},
                                                                {"parallelogram", parallelogram}});
    return families;
}

}  // namespace corda::test
