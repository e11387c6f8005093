#include "corda/sim/work.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/forces/elastic_forces.hpp"

namespace corda::sim {
namespace {

std::span<const Bar> bars_of(const System& system, const Body& body) {
    return std::span(system.bars).subspan(body.first_bar, body.bar_count);
}

/// The free mass in kg that hangs on each bar.
std::vector<double> carried_kg(const System& system, const Body& body) {
    double all_kg = 0.0;
    bool is_pinned_elsewhere = false;
    for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i) {
        if (!system.is_pinned(i)) all_kg += system.mass_kg[i];
        is_pinned_elsewhere = is_pinned_elsewhere || (system.is_pinned(i) && i > body.first_particle);
    }
    std::vector<double> carried(body.bar_count, all_kg);
    if (!body.is_chain || is_pinned_elsewhere || !system.is_pinned(body.first_particle)) return carried;
    for (std::size_t k = 1; k < body.link_count; ++k)
        carried[k] = carried[k - 1] - system.mass_kg[body.first_particle + k];
    return carried;
}

}  // namespace

double vibration_frequency_1_s(const System& system, const Body& body) {
    return std::sqrt(
        ElasticForces(system, body.first_particle, body.particle_count).common_square_frequency());
}

double angular_velocity_1_s(const System& system, const Body& body) {
    double largest_1_s = 0.0;
    for (const Bar& bar : bars_of(system, body)) {
        const double speed_m_s =
            length(system.vx_m_s[bar.b] - system.vx_m_s[bar.a], system.vy_m_s[bar.b] - system.vy_m_s[bar.a]);
        largest_1_s = std::max(largest_1_s, speed_m_s / bar.rest_m);
    }
    return largest_1_s;
}

double pendulum_frequency_1_s(const System& system, const Body& body, const Forces& forces) {
    double shortest_m = std::numeric_limits<double>::infinity();
    for (const Bar& bar : bars_of(system, body)) shortest_m = std::min(shortest_m, bar.rest_m);
    return forces.inverse_timescale_1_s(shortest_m, 0.0);
}

double tension_frequency_1_s(const System& system, const Body& body, const Forces& forces,
                             bool is_moved_by_rounding) {
    if (body.material.compliance_1_n > 0.0) return 0.0;
    const std::span<const Bar> bars = bars_of(system, body);
    const Vec2 pull_m_s2 = forces.uniform_m_s2();
    double fastest_m_s2 = 0.0;
    bool stays = true;  // bars along gravity that do not turn
    for (const Bar& bar : bars) {
        const double speed_m_s =
            length(system.vx_m_s[bar.b] - system.vx_m_s[bar.a], system.vy_m_s[bar.b] - system.vy_m_s[bar.a]);
        fastest_m_s2 = std::max(fastest_m_s2, speed_m_s * (speed_m_s / bar.rest_m));
        const double across = (system.x_m[bar.b] - system.x_m[bar.a]) * pull_m_s2.y -
                              (system.y_m[bar.b] - system.y_m[bar.a]) * pull_m_s2.x;
        stays = stays && speed_m_s == 0.0 && across == 0.0;
    }
    if (stays && !is_moved_by_rounding) return 0.0;
    const std::vector<double> carried = carried_kg(system, body);
    std::vector<double> load_n_m(body.particle_count, 0.0);
    for (std::size_t k = 0; k < bars.size(); ++k) {
        const double tension_n = carried[k] * (forces.strength_m_s2() + fastest_m_s2);
        load_n_m[bars[k].a - body.first_particle] += tension_n / bars[k].rest_m;
        load_n_m[bars[k].b - body.first_particle] += tension_n / bars[k].rest_m;
    }
    double largest = 0.0;
    for (std::size_t i = 0; i < load_n_m.size(); ++i)
        largest = std::max(largest, 2.0 * system.inverse_mass_1_kg[body.first_particle + i] * load_n_m[i]);
    return std::sqrt(largest);
}

}  // namespace corda::sim
