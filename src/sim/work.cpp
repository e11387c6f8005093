#include "corda/sim/work.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "corda/sim/distance.hpp"
#include "corda/sim/elastic_forces.hpp"

namespace corda::sim {
namespace {

std::span<const Bar> bars_of(const System& system, const Body& body) {
    return std::span(system.bars).subspan(body.first_bar, body.bar_count);
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

double expected_steps(double frequency_1_s, double time_s) {
    constexpr double kFrequencyTimesStep = 5.0;
    return frequency_1_s * time_s / kFrequencyTimesStep;
}

}  // namespace corda::sim
