#include "corda/sim/trial.hpp"

#include <algorithm>
#include <cmath>

#include "corda/core/error.hpp"
#include "corda/sim/distance.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

/// A turn of the plane by the angle whose cosine is 0.8 and whose sine is 0.6.
Vec2 turned(Vec2 v) {
    return {0.8 * v.x - 0.6 * v.y, 0.6 * v.x + 0.8 * v.y};
}

/// The same scene in turned coordinates: another start by rounding alone, and other rounding from there on.
System turned(const System& system) {
    System result = system;
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        const Vec2 position = turned(Vec2{system.x_m[i], system.y_m[i]});
        const Vec2 velocity = turned(Vec2{system.vx_m_s[i], system.vy_m_s[i]});
        result.x_m[i] = position.x;
        result.y_m[i] = position.y;
        result.vx_m_s[i] = velocity.x;
        result.vy_m_s[i] = velocity.y;
    }
    return result;
}

/// Largest distance of a particle of `state` from where the turned `checked` has it; infinite for a NaN.
double largest_distance_m(const State& state, const State& checked) {
    double largest_m = 0.0;
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        const Vec2 position = turned(Vec2{state.x_m[i], state.y_m[i]});
        const double distance_m = length(position.x - checked.x_m[i], position.y - checked.y_m[i]);
        if (!(distance_m <= largest_m)) largest_m = std::isnan(distance_m) ? HUGE_VAL : distance_m;
    }
    return largest_m;
}

}  // namespace

double bound_per_difference(const System& system) {
    constexpr double kSmooth = 3.0;
    constexpr double kWithKinks = 30.0;
    const bool has_kinks = std::any_of(system.bodies.begin(), system.bodies.end(), [](const Body& body) {
        return body.material.is_string && body.material.compliance_1_n > 0.0;
    });
    return has_kinks ? kWithKinks : kSmooth;
}

void run_trial(const System& system, const WorldDef& world, const PlanDef& def, Trial& trial) {
    const double interval_s = def.frames.interval_s();
    const double factor = bound_per_difference(system);
    const System turned_system = turned(system);
    WorldDef turned_world = world;
    turned_world.gravity_m_s2 = turned(world.gravity_m_s2);
    const auto run = make_solver(system, world, trial.solver, interval_s);
    const auto check = make_solver(turned_system, turned_world, trial.check, interval_s);
    State state{0.0, system.x_m, system.y_m};
    State checked{0.0, turned_system.x_m, turned_system.y_m};
    for (std::int64_t k = 0; k <= def.last_frame; ++k) {
        if (def.watch) def.watch(k, def.last_frame);
        const double time_s = def.frames.time_s(k);
        trial.diverged = run->advance_to(time_s, state) == Status::kDiverged ||
                         check->advance_to(time_s, checked) == Status::kDiverged;
        if (trial.diverged) return;
        const double difference_m = largest_distance_m(state, checked);
        if (factor * difference_m > def.tolerance_m) return;
        trial.largest_difference_m = std::max(trial.largest_difference_m, difference_m);
        trial.reached_s = time_s;
        trial.steps = run->steps();
        trial.check_steps = check->steps();
    }
    trial.to_the_end = true;
}

std::string refusal(const System& system, const WorldDef& world, const SolverDef& solver,
                    double frame_interval_s) {
    try {
        static_cast<void>(make_solver(system, world, solver, frame_interval_s));
    } catch (const Error& error) {
        if (error.code() != ExitCode::kInvalidScene) throw;
        return error.what();
    }
    return {};
}

}  // namespace corda::sim
