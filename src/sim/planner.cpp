#include "corda/sim/planner.hpp"

#include <algorithm>
#include <cmath>

#include "corda/core/error.hpp"
#include "corda/sim/distance.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

constexpr double kLoosestTolerance = 1e-3;
constexpr double kTightestTolerance = 1e-13;  // below, rounding is all that is left
constexpr double kCheckPerTolerance = 1e-2;
constexpr double kTightestCheck = 1e-15;

double chain_length_m(const System& system) {
    double longest_m = 0.0;
    for (const Body& body : system.bodies) {
        double length_m = 0.0;
        for (std::size_t i = 0; i < body.link_count; ++i) length_m += system.bars[body.first_bar + i].rest_m;
        longest_m = std::max(longest_m, length_m);
    }
    return longest_m;
}

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

/// Runs the trial's two solvers frame by frame until they part by more than the tolerance allows, or to the
/// end.
void compare(const System& system, const WorldDef& world, const PlanDef& def, Trial& trial) {
    const double interval_s = def.frames.interval_s();
    const System turned_system = turned(system);
    WorldDef turned_world = world;
    turned_world.gravity_m_s2 = turned(world.gravity_m_s2);
    const auto run = make_solver(system, world, trial.solver, interval_s);
    const auto check = make_solver(turned_system, turned_world, trial.check, interval_s);
    State state{0.0, system.x_m, system.y_m};
    State checked{0.0, turned_system.x_m, turned_system.y_m};
    for (std::int64_t k = 0; k <= def.last_frame; ++k) {
        const double time_s = def.frames.time_s(k);
        if (run->advance_to(time_s, state) == Status::kDiverged) return;
        if (check->advance_to(time_s, checked) == Status::kDiverged) return;
        const double difference_m = largest_distance_m(state, checked);
        if (kBoundPerDifference * difference_m > def.tolerance_m) return;
        trial.largest_difference_m = std::max(trial.largest_difference_m, difference_m);
        trial.reached_s = time_s;
        trial.steps = run->steps();
    }
    trial.to_the_end = true;
}

/// Trials of `exact`, each a hundred times tighter than the last.
std::vector<Trial> exact_trials(const System& system, const PlanDef& def) {
    std::vector<Trial> trials;
    const double wanted = def.tolerance_m / chain_length_m(system);
    double tolerance = std::clamp(wanted, kTightestTolerance, kLoosestTolerance);
    for (bool tightest = false; !tightest; tolerance *= kCheckPerTolerance) {
        tightest = tolerance <= kTightestTolerance;
        Trial& trial = trials.emplace_back();
        trial.solver.method = Method::kExact;
        trial.solver.reach = 1;
        trial.solver.tolerance = std::max(tolerance, kTightestTolerance);
        trial.check = trial.solver;
        trial.check.tolerance = std::max(kCheckPerTolerance * trial.solver.tolerance, kTightestCheck);
    }
    return trials;
}

}  // namespace

Plan plan_solver(const System& system, const WorldDef& world, const PlanDef& def) {
    Plan plan;
    plan.reason = "every body is a chain: exact, whose links keep their lengths whatever the step";
    for (Trial& trial : exact_trials(system, def)) {
        compare(system, world, def, trial);
        plan.trials.push_back(trial);
        if (trial.to_the_end) break;
    }
    // Where none gets to the end, the one that gets farthest; of equals the first, which is the cheapest.
    const auto best =
        std::max_element(plan.trials.begin(), plan.trials.end(), [](const Trial& a, const Trial& b) {
            return a.to_the_end != b.to_the_end ? b.to_the_end : a.reached_s < b.reached_s;
        });
    std::rotate(best, best + 1, plan.trials.end());
    const Trial& chosen = plan.trials.back();
    plan.solver = chosen.solver;
    plan.error_bound_m = kBoundPerDifference * chosen.largest_difference_m;
    if (!chosen.to_the_end) plan.horizon_s = chosen.reached_s;
    return plan;
}

}  // namespace corda::sim
