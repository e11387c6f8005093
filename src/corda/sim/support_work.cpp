#include "corda/sim/support_work.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <utility>

#include "corda/sim/events.hpp"
#include "corda/sim/forces/forces.hpp"
#include "corda/sim/moving_pins.hpp"

namespace corda::sim {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Points and weights on -1 .. 1 of Gauss' rule: M. Abramowitz, I. A. Stegun, Handbook of Mathematical
/// Functions, table 25.4.
constexpr std::array<std::pair<double, double>, 4> kGauss{{{-0.861136311594053, 0.347854845137454},
                                                           {-0.339981043584856, 0.652145154862546},
                                                           {0.339981043584856, 0.652145154862546},
                                                           {0.861136311594053, 0.347854845137454}}};

/// Steps of high order are longer than the rule follows.
constexpr double kPartsPerStep = 3.0;

/// A sixteenth of the shortest cycle of the pins, and at most a common frame.
double most_of_part_s(const System& system) {
    constexpr double kFrame = 1.0 / 60.0;
    double frequency_1_s = 0.0;
    for (const MoveDef& move : system.moves)
        frequency_1_s = std::max(frequency_1_s, displacement_of(move).frequency_1_s());
    return std::min(kFrame, 0.125 * std::numbers::pi / frequency_1_s);
}

}  // namespace

SupportWork::SupportWork(const System& system, const WorldDef& world, std::span<const MethodDef> methods,
                         double frame_interval_s)
    : run_(system, world, methods, frame_interval_s),
      meter_(system),
      weight_m_s2_(Forces(world).weight_m_s2()),
      event_s_(event_times_s(system)),
      longest_s_(most_of_part_s(system)),
      most_s_(longest_s_) {
    run_.set_outputs({.velocities = true, .tensions = true, .unknown_tensions = true});
    const bool snaps = std::ranges::any_of(system.bodies, [](const Body& body) {
        return body.material.is_string && body.material.compliance_1_n == 0.0;
    });
    if (snaps) work_j_ = kUnknown;
}

double SupportWork::until_j(double time_s) {
    while (until_s_ < time_s) {
        const auto event = std::ranges::upper_bound(event_s_, until_s_);
        const double end_s = event == event_s_.end() ? time_s : std::min(*event, time_s);
        const double left_s = end_s - until_s_;
        const double part_s = longest_s_ < left_s ? std::min(longest_s_, 0.5 * left_s) : left_s;
        const std::uint64_t steps = run_.steps();
        for (const auto& [point, weight] : kGauss) {
            if (run_.advance_to(until_s_ + 0.5 * (1.0 + point) * part_s) == Status::kDiverged)
                return work_j_ = std::numeric_limits<double>::infinity();
            const State& state = run_.state();
            work_j_ += 0.5 * weight * part_s * meter_.support_power_w(run_.system(), state, state.tension_n);
        }
        const auto taken = static_cast<double>(run_.steps() - steps);
        longest_s_ = std::min(part_s / std::max(0.5, kPartsPerStep * taken), most_s_);
        until_s_ = part_s == left_s ? end_s : until_s_ + part_s;
    }
    return work_j_ + on_masses_j(time_s);
}

double SupportWork::on_masses_j(double time_s) const {
    const System& system = run_.system();
    double work_j = 0.0;
    for (const MoveDef& move : system.moves) {
        if (system.stays_pinned(move.pin)) continue;
        const TimeFunction displacement = displacement_of(move);
        const Vec2 start_m_s = displacement.derivative()(0.0);
        const double until_s = std::min(time_s, system.release_s[move.pin]);
        const Vec2 velocity_m_s = displacement.derivative()(until_s);
        const double kinetic = 0.5 * (dot(velocity_m_s, velocity_m_s) - dot(start_m_s, start_m_s));
        work_j += system.mass_kg[move.pin] * (kinetic - dot(weight_m_s2_, displacement(until_s)));
    }
    return work_j;
}

}  // namespace corda::sim
