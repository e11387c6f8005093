#include "corda/sim/auto/trial.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "corda/sim/distance.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

/// The vector turned by the angle whose cosine is 0.8 and whose sine is 0.6.
Vec2 turned(Vec2 v) {
    return {0.8 * v.x - 0.6 * v.y, 0.6 * v.x + 0.8 * v.y};
}

/// The same system in turned coordinates: a start that differs by rounding alone, and different rounding from
/// then on.
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

/// Largest distance of a particle of `state` from its position in the turned state `checked`; infinite for a
/// NaN.
double largest_distance_m(const State& state, const State& checked) {
    double largest_m = 0.0;
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        const Vec2 position = turned(Vec2{state.x_m[i], state.y_m[i]});
        const double distance_m = length(position.x - checked.x_m[i], position.y - checked.y_m[i]);
        if (!(distance_m <= largest_m)) largest_m = std::isnan(distance_m) ? HUGE_VAL : distance_m;
    }
    return largest_m;
}

/// The difference of two runs over time. The tolerance follows from the bounds of the whole motion and is
/// known only at the end; until then that of the motion so far, which is no larger, is used.
class Comparison {
  public:
    Comparison(double factor, const ToleranceOf& tolerance_m) : factor_(factor), tolerance_m_(&tolerance_m) {}

    void add(double time_s, double difference_m, const MotionBounds& bounds_so_far) {
        if (records_.empty() || difference_m > records_.back().largest_m)
            records_.push_back({difference_m, time_s});
        records_.back().until_s = time_s;
        has_parted_ = !(factor_ * records_.back().largest_m <= kHopeless * (*tolerance_m_)(bounds_so_far));
    }

    /// Whether the difference is more than the tolerance will ever allow.
    [[nodiscard]] bool has_parted() const { return has_parted_; }

    void conclude(const MotionBounds& bounds, Trial& trial) const {
        const double allowed_m = (*tolerance_m_)(bounds) / factor_;
        trial.to_the_end = !has_parted_ && !records_.empty() && records_.back().largest_m <= allowed_m;
        for (const Record& record : records_) {
            if (!(record.largest_m <= allowed_m)) break;
            trial.reached_s = record.until_s;
            trial.largest_difference_m = record.largest_m;
        }
    }

  private:
    /// A motion may still grow by about this factor, and the tolerance with it.
    static constexpr double kHopeless = 16.0;

    double factor_;
    const ToleranceOf* tolerance_m_;
    /// The largest difference so far, and the last time at which it was the largest.
    struct Record {
        double largest_m;
        double until_s;
    };
    std::vector<Record> records_;  ///< increasing
    bool has_parted_ = false;
};

}  // namespace

double bound_per_difference(const System& system) {
    constexpr double kSmooth = 3.0;
    constexpr double kWithKinks = 30.0;
    const bool has_kinks = std::any_of(system.bodies.begin(), system.bodies.end(), [](const Body& body) {
        return body.material.is_string && body.material.compliance_1_n > 0.0;
    });
    return has_kinks ? kWithKinks : kSmooth;
}

void run_trial(const System& system, const WorldDef& world, const PlanDef& def, bool keeps_going,
               Trial& trial, Recording& recording, int& passes) {
    const double interval_s = def.timeline.fps().interval_s();
    const System turned_system = turned(system);
    const Forces forces(world);
    const Forces turned_forces(ForceTerm{turned(forces.uniform_m_s2()), forces.drag_1_s()});
    Simulation run(system, world, trial.method, interval_s);
    const auto check = make_solver(turned_system, turned_forces, trial.check, interval_s);
    Comparison comparison(bound_per_difference(system), def.tolerance_m);
    State checked{0.0, turned_system.x_m, turned_system.y_m};
    recording.clear();
    const auto total = static_cast<std::int64_t>(def.timeline.size());
    bool is_checked = true;
    for (std::int64_t i = 0; i < total && (is_checked || keeps_going); ++i) {
        report_progress(def.on_progress, i, total);
        const double time_s = def.timeline.time_s(static_cast<std::size_t>(i));
        if (i == 0) ++passes;
        if (recording.advance(run, time_s, def.clock_s) == Status::kDiverged) {
            trial.diverged = is_checked;
            break;
        }
        if (!is_checked || !def.timeline.is_frame(static_cast<std::size_t>(i))) continue;
        if (i == 0) ++passes;
        trial.diverged = check->advance_to(time_s, checked) == Status::kDiverged;
        if (!trial.diverged)
            comparison.add(time_s, largest_distance_m(run.state(), checked), recording.bounds());
        is_checked = !trial.diverged && !comparison.has_parted();
    }
    trial.steps = run.diagnostics().steps;
    trial.check_steps = check->steps();
    comparison.conclude(recording.bounds(), trial);
    trial.to_the_end = trial.to_the_end && !trial.diverged;
}

std::optional<Refusal> refusal(const System& system, const WorldDef& world, const MethodDef& method,
                               double frame_interval_s) {
    try {
        static_cast<void>(make_solver(system, world, method, frame_interval_s));
    } catch (const Refusal& refused) {
        return refused;
    }
    return std::nullopt;
}

}  // namespace corda::sim
