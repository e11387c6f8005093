#include "corda/sim/auto/trial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "corda/sim/auto/checks.hpp"
#include "corda/sim/distance.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

/// Between the bound on an error and the difference from a check. The error may exceed the difference by the
/// check's own error, little as a rule and a sixth near rounding: 3 leaves room.
constexpr double kBoundPerDifference = 3.0;

/// The difference of two runs over time. The tolerance follows from the bounds of the whole motion and is
/// known only at the end; until then that of the motion so far, which is no larger, is used.
class Comparison {
  public:
    explicit Comparison(const ToleranceOf& tolerance_m) : tolerance_m_(&tolerance_m) {}

    void add(double time_s, double difference_m, const MotionBounds& bounds_so_far) {
        if (records_.empty() || difference_m > records_.back().largest_m)
            records_.push_back({difference_m, time_s});
        records_.back().until_s = time_s;
        has_parted_ =
            !(kBoundPerDifference * records_.back().largest_m <= kHopeless * (*tolerance_m_)(bounds_so_far));
    }

    /// Whether the difference is more than the tolerance will ever allow.
    [[nodiscard]] bool has_parted() const { return has_parted_; }

    void conclude(const MotionBounds& bounds, double hidden_m, Trial& trial) const {
        const double tolerance_m = (*tolerance_m_)(bounds);
        const double allowed_m = (tolerance_m - hidden_m) / kBoundPerDifference;
        trial.to_the_end = !has_parted_ && !records_.empty() && records_.back().largest_m <= allowed_m;
        for (const Record& record : records_) {
            if (!(record.largest_m <= allowed_m)) break;
            trial.reached_s = record.until_s;
            if (record.largest_m <= kHundredth * allowed_m) trial.hundredth_s = record.until_s;
            trial.largest_difference_m = record.largest_m;
        }
        trial.error_bound_m = kBoundPerDifference * trial.largest_difference_m + hidden_m;
    }

  private:
    static constexpr double kHundredth = 0.01;
    /// A motion may still grow by about this factor, and the tolerance with it.
    static constexpr double kHopeless = 16.0;

    const ToleranceOf* tolerance_m_;
    /// The largest difference so far, and the last time at which it was the largest.
    struct Record {
        double largest_m;
        double until_s;
    };
    std::vector<Record> records_;  ///< increasing
    bool has_parted_ = false;
};

/// What vibrations can hide from a trial. If those of bodies that stretch or bend limit the steps of `exact`,
/// a run and its check damp quick ones alike. Their amplitude is then less than the check's tolerance, or its
/// error estimates would have shortened the steps.
double hidden_m(const System& system, const Trial& trial) {
    constexpr double kResolved = 0.9;
    const auto* run = std::get_if<ExactDef>(&trial.method);
    const auto* check = std::get_if<ExactDef>(&trial.check);
    const bool vibrates = !system.bends.empty() ||
                          std::any_of(system.bodies.begin(), system.bodies.end(),
                                      [](const Body& body) { return body.material.compliance_1_n > 0.0; });
    if (run == nullptr || check == nullptr || !vibrates) return 0.0;
    // As many as it takes if the tolerance limits the steps, of order 8. Square roots are the same
    // everywhere.
    const double ratio = run->tolerance / check->tolerance;
    const double steps = std::sqrt(std::sqrt(std::sqrt(ratio))) * static_cast<double>(trial.steps);
    return static_cast<double>(trial.check_steps) >= kResolved * steps
               ? 0.0
               : check->tolerance * largest_length_m(system);
}

/// Whether rounding, which moves a chain about as much as a tolerance of 1e-12, is small beside a run's
/// error.
bool is_far_from_rounding(const MethodDef& run) {
    constexpr double kNear = 2e-9;
    const auto* exact = std::get_if<ExactDef>(&run);
    return exact != nullptr && exact->tolerance > kNear;
}

/// Of positions in the scene's coordinates, as files give them; and of the start and the lengths of bars,
/// which run and checks share and the motion magnifies (a braced net of random scenes: 830 roundings in 1 s).
double rounding_m(const System& system, const MotionBounds& bounds) {
    const auto largest = [](Vec2 v) { return std::max(std::abs(v.x), std::abs(v.y)); };
    const double farthest_m =
        largest(system.origin_m) + std::max(largest(bounds.min_m()), largest(bounds.max_m()));
    constexpr double kMagnified = 4096.0;
    return std::numeric_limits<double>::epsilon() *
           (2.0 * farthest_m + kMagnified * largest_length_m(system));
}

}  // namespace

GoesOn reporting(const PlanDef& def, const std::int64_t& frames_done) {
    return [&def, &frames_done] {
        report_progress(def.on_progress, frames_done, static_cast<std::int64_t>(def.timeline.size()));
        return true;
    };
}

void run_trial(const System& system, const WorldDef& world, const PlanDef& def, TrialKind kind, Trial& trial,
               Recording& recording, int& passes) {
    const double interval_s = def.timeline.fps().interval_s();
    const auto total = static_cast<std::int64_t>(def.timeline.size());
    std::int64_t i = 0;
    const GoesOn goes_on = reporting(def, i);
    Simulation run(system, world, trial.method, interval_s, goes_on);
    const bool has_one = is_far_from_rounding(trial.method) ||
                         (kind.is_first && std::holds_alternative<RattleDef>(trial.method));
    Checks checks(system, world, trial.check, interval_s, has_one ? 1 : Checks::kMost, goes_on);
    Comparison comparison(def.tolerance_m);
    recording.clear();
    bool is_checked = true;
    for (; i < total && (is_checked || kind.is_last); ++i) {
        goes_on();
        const bool compares = is_checked && def.timeline.is_frame(static_cast<std::size_t>(i));
        if (i == 0) ++passes;
        if (compares) checks.start(def.timeline.time_s(static_cast<std::size_t>(i)));
        if (recording.advance(run, def.timeline, def.clock_s, goes_on) == Status::kDiverged) {
            trial.diverged = trial.diverged || is_checked;
            break;
        }
        if (is_checked && run.diagnostics().branched_s) trial.diverged = true;
        if (!compares) continue;
        if (i == 0) passes += static_cast<int>(checks.size());
        if (checks.finish() == Status::kDiverged) trial.diverged = true;
        if (!trial.diverged)
            comparison.add(def.timeline.time_s(static_cast<std::size_t>(i)), checks.difference_m(run.state()),
                           recording.bounds());
        is_checked = !trial.diverged && !comparison.has_parted();
    }
    trial.steps = run.diagnostics().steps;
    trial.check_steps = checks.steps();
    comparison.conclude(recording.bounds(), hidden_m(system, trial), trial);
    trial.error_bound_m += rounding_m(system, recording.bounds());
    trial.to_the_end = trial.to_the_end && !trial.diverged;
}

std::optional<Refusal> refusal(const System& system, const WorldDef& world, const MethodDef& method,
                               double frame_interval_s, const GoesOn& goes_on) {
    try {
        static_cast<void>(make_solver(system, world, {&method, 1}, frame_interval_s, goes_on));
    } catch (const Refusal& refused) {
        return refused;
    }
    return std::nullopt;
}

}  // namespace corda::sim
