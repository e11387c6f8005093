#include "corda/sim/auto/planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "corda/core/cancel.hpp"
#include "corda/sim/auto/tolerances.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/exact/dop853.hpp"
#include "corda/sim/exact/string/part.hpp"
#include "corda/sim/rattle/constraint_solver.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {
namespace {

/// Ratio of the error estimate of a run to its difference from a check. The error may exceed the difference
/// by the check's own error, a sixth of it near rounding. Where strings come taut, errors of `rattle` follow
/// its order only on average: the largest of 200 cloths of strings was 2.7 differences.
double estimate_per_difference(const System& system, const MethodDef& run) {
    constexpr double kUsual = 3.0;
    constexpr double kOfKinks = 6.0;
    return std::holds_alternative<RattleDef>(run) && has_kinks(system) ? kOfKinks : kUsual;
}

/// The difference of two runs over time. The tolerance follows from the bounds of the whole motion and is
/// known only at the end; until then that of the motion so far, which is no larger, is used.
class Comparison {
  public:
    /// `per_difference`: of estimate_per_difference().
    Comparison(const ToleranceOf& tolerance_m, double per_difference)
        : tolerance_m_(&tolerance_m), per_difference_(per_difference) {}

    /// Adds the difference at a time, which is or is not a frame's.
    void add(double time_s, bool is_frame, double difference_m, const MotionBounds& bounds_so_far) {
        if (records_.empty() || difference_m > records_.back().largest_m)
            records_.push_back({difference_m, time_s, records_.empty() ? 0.0 : records_.back().until_s});
        if (is_frame) records_.back().until_s = time_s;
        const auto has_parted = [&] {
            return !(per_difference_ * records_.back().largest_m <= kHopeless * least_tolerance_m_);
        };
        if (!has_parted()) return;
        least_tolerance_m_ = (*tolerance_m_)(bounds_so_far);
        has_parted_ = has_parted();
    }

    /// Estimate of the error so far, without rounding.
    [[nodiscard]] double estimate_m() const {
        return records_.empty() ? 0.0 : per_difference_ * records_.back().largest_m;
    }

    /// True if the difference is more than the tolerance will ever allow.
    [[nodiscard]] bool has_parted() const { return has_parted_; }

    void conclude(const MotionBounds& bounds, double hidden_m, Trial& trial) const {
        const double tolerance_m = (*tolerance_m_)(bounds);
        const double allowed_m = (tolerance_m - hidden_m) / per_difference_;
        trial.to_the_end = !has_parted_ && !records_.empty() && records_.back().largest_m <= allowed_m;
        for (const Record& record : records_) {
            if (!(record.largest_m <= allowed_m)) break;
            if (!trial.to_the_end && record.until_s < record.since_s) continue;  // after the horizon
            trial.reached_s = record.until_s;
            if (record.largest_m <= kHundredth * allowed_m) trial.hundredth_s = record.until_s;
            trial.largest_difference_m = record.largest_m;
        }
        trial.error_estimate_m = per_difference_ * trial.largest_difference_m + hidden_m;
    }

  private:
    static constexpr double kHundredth = 0.01;
    /// A motion may still grow by about this factor, and the tolerance with it.
    static constexpr double kHopeless = 16.0;

    const ToleranceOf* tolerance_m_;
    double per_difference_;
    /// The largest difference so far.
    struct Record {
        double largest_m;
        double since_s;
        double until_s;  ///< the last frame time by which it was the largest
    };
    std::vector<Record> records_;  ///< increasing
    double least_tolerance_m_ = 0.0;
    bool has_parted_ = false;
};

/// Chooses the times between frames at which a run is compared with its checks, by the steps of the run,
/// which follow its motion. At first there are several in a step of `exact`, whose error has its largest
/// values within, and one in a step of `rattle`, which is short; they become rarer with their number, because
/// the longer a motion is, the less it matters when it is looked at. They do not depend on other times that
/// are recorded, so that a still or an exposure does not change a plan.
class Between {
  public:
    /// `first_s`: the first of them to try, > 0.
    Between(const MethodDef& run, double first_s)
        : at_first_steps_(std::holds_alternative<RattleDef>(run) ? 1.0 : 0.125), gap_s_(first_s) {}

    /// Notes a comparison: its time, and the steps that the run had taken by then.
    void add(double time_s, std::uint64_t steps) {
        constexpr double kGolden = 0.6180339887498949;
        constexpr double kUntilSparser = 128.0;
        constexpr double kCounted = 3.0;  // steps from which their length follows
        time_s_ = time_s;
        points_ += 1.0;
        turns_ += kGolden;
        turns_ -= std::floor(turns_);
        const double every_s =
            at_first_steps_ * std::max(1.0, points_ / kUntilSparser) * (time_s - counted_s_);
        const auto taken = static_cast<double>(steps - counted_);
        if (taken < kCounted) {
            gap_s_ = std::max(gap_s_, every_s / (taken + 1.0));
            return;
        }
        gap_s_ = every_s / taken;
        counted_s_ = time_s;
        counted_ = steps;
    }

    /// The next time before `end_s`; std::nullopt if there is none. Times are not evenly spaced, because a
    /// motion may be in step with them.
    [[nodiscard]] std::optional<double> next_s(double end_s) const {
        const double time_s = time_s_ + gap_s_ * (0.5 + turns_);
        if (!(time_s > time_s_ && time_s < end_s)) return std::nullopt;
        return time_s;
    }

  private:
    double at_first_steps_;  ///< from one to the next
    double gap_s_;
    double time_s_ = 0.0;     ///< of the last comparison
    double counted_s_ = 0.0;  ///< since when steps are counted
    std::uint64_t counted_ = 0;
    double points_ = 0.0;
    double turns_ = 0.0;  ///< 0 .. 1
};

/// Error in metres that vibrations can hide from a trial. Implicit steps damp those that displace particles
/// by less than a share of a step of 0.002 of the tolerance, in a run and its check; many steps damp larger
/// ones along links that stretch, which then displace a swing by up to 0.8 of the tolerance, and with 1000
/// links by five times of it. What is not hidden of that parts the run from its check (332 random ropes err
/// by 0.79 of the estimate at most). If vibrations of bodies that stretch or bend limit explicit steps, a run
/// and its check damp quick ones alike. Their amplitude is then below the check's tolerance; otherwise its
/// error estimates would have shortened the steps.
double hidden_m(const System& system, const Trial& trial) {
    constexpr double kResolved = 0.9;
    constexpr double kOfImplicit = 0.05;
    constexpr double kOfStretching = 0.5;
    const auto* run = std::get_if<ExactDef>(&trial.method);
    const auto* check = std::get_if<ExactDef>(&trial.check);
    const bool vibrates = !system.bends.empty() || std::ranges::any_of(system.bodies, [](const Body& body) {
        return body.material.compliance_1_n > 0.0;
    });
    if (run != nullptr && run->implicit)
        return (vibrates ? kOfStretching : kOfImplicit) * run->tolerance * largest_length_m(system);
    if (run == nullptr || check == nullptr || !vibrates) return 0.0;
    // As many as it takes if the tolerance limits the steps, of order 8.
    const double ratio = run->tolerance / check->tolerance;
    const double steps = eighth_root(ratio) * static_cast<double>(trial.steps);
    return static_cast<double>(trial.check_steps) >= kResolved * steps
               ? 0.0
               : check->tolerance * largest_length_m(system);
}

/// True if rounding is small compared with a run's error. It moves a chain of equal masses about as much as a
/// tolerance of 1e-12, and a light particle more: the rounding of a tension that carries heavy ones grows
/// with the ratio of masses. Where a net passes a line of bars, rounding moves it by its root, about as much
/// as `rattle` of order 4 errs.
bool is_far_from_rounding(const System& system, const MethodDef& run) {
    constexpr double kNear = 2e-9;
    if (const auto* rattle = std::get_if<RattleDef>(&run)) return rattle->order == 2;
    const auto* exact = std::get_if<ExactDef>(&run);
    return exact != nullptr && exact->tolerance > kNear * mass_ratio(system, system.bodies.front());
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

/// Follows the other outcomes of snaps of a rigid string on which the errors of its run and checks decide: in
/// another order, or not at all.
class OtherSnaps {
  public:
    OtherSnaps(const System& system, const Forces& forces, const PlanDef& def, const Trial& trial)
        : system_(system),
          forces_(forces),
          check_(std::get_if<ExactDef>(&trial.check)),
          alone_(def.tolerance_m, estimate_per_difference(system, trial.method)) {}

    /// The largest difference of `state`, that of a run of this work, from the checks and from other
    /// outcomes.
    double difference_m(bool is_frame, const Checks& checks, const State& state, const MotionBounds& bounds,
                        double run_updates, double most_updates, int& passes) {
        const double error_m = alone_.estimate_m() + rounding_m(system_, bounds);
        const double difference_m = checks.difference_m(state);
        alone_.add(state.time_s, is_frame, difference_m, bounds);
        const double margin_m = checks.margin_m();
        if (margin_m <= kSure * error_m && longer_m_ < std::max(kCovers * margin_m, error_m)) {
            // Others start again from the beginning.
            if (updates() > std::max(kSmallUpdates, kMaxRuns * run_updates)) return HUGE_VAL;
            longer_m_ = kCovers * std::max(margin_m, error_m);
            updates_before_ = updates();
            runs_.emplace(system_, forces_, *check_, longer_m_);
            passes += static_cast<int>(runs_->size());
        }
        if (!runs_) return difference_m;
        runs_->start(state.time_s, most_updates);
        if (runs_->finish() == Status::kDiverged) return HUGE_VAL;
        return std::max(difference_m, runs_->difference_m(state));
    }

    /// Work of the runs.
    [[nodiscard]] double updates() const { return updates_before_ + (runs_ ? runs_->updates() : 0.0); }

    /// The last time at which the checks alone differ by less than a hundredth of the tolerance; 0 if no
    /// other outcomes are followed.
    [[nodiscard]] double reached_s(const MotionBounds& bounds) const {
        Trial alone;
        if (runs_) alone_.conclude(bounds, 0.0, alone);
        return alone.hundredth_s;
    }

  private:
    /// A decision whose margin exceeds this multiple of the error estimate is the true one.
    static constexpr double kSure = 4.0;
    /// Displacement of snaps in parts of the margins that it covers.
    static constexpr double kCovers = 2.0;
    /// Work of other outcomes after which no further ones are followed: some 0.1 s, and this many runs.
    static constexpr double kSmallUpdates = 2e6;
    static constexpr double kMaxRuns = 4.0;

    const System& system_;
    const Forces& forces_;
    const ExactDef* check_;
    Comparison alone_;  ///< without other outcomes
    double longer_m_ = 0.0;
    double updates_before_ = 0.0;  ///< work of those that others have replaced
    std::optional<Checks> runs_;
};

/// A run beside its checks, with which it is compared at frames and between.
class CheckedRun : NonCopyable {
  public:
    /// Each run that begins to move adds one to `passes`.
    CheckedRun(const System& system, const WorldDef& world, const PlanDef& def, const Trial& trial,
               const TrialKind& kind, int& passes)
        : system_(system),
          def_(def),
          most_updates_(kind.most_updates),
          most_updates_1_s_(def.most_updates_of_run() / def.last_s()),
          passes_(passes),
          forces_(world),
          run_(system, world, trial.method, def.timeline.step_s()),
          checks_(system, forces_, trial, def.timeline.step_s()),
          comparison_(def.tolerance_m, estimate_per_difference(system, trial.method)),
          other_snaps_(system, forces_, def, trial),
          between_(trial.method, kFirstPoint * def.timeline.step_s()),
          point_(run_.state()) {}

    [[nodiscard]] double time_s() const { return run_.state().time_s; }
    [[nodiscard]] std::uint64_t steps() const { return run_.steps(); }
    /// Work of the run, and of all.
    [[nodiscard]] double run_updates() const { return work_.updates(); }
    [[nodiscard]] double updates() const {
        return work_.updates() + checks_.updates() + other_snaps_.updates();
    }
    /// False once one has diverged, they differ for good or the checks have ended: then they are compared no
    /// more.
    [[nodiscard]] bool agrees() const {
        return !has_diverged_ && !is_unchecked_ && !comparison_.has_parted();
    }
    /// The run will be drawn, whatever work it takes.
    void draw() { is_drawn_ = true; }

    /// Advances to a time of the timeline and records it. False if the run diverges before. Throws
    /// TooMuchWork if the run takes more than its share of PlanDef::most_updates_of_run().
    bool record(std::size_t index, Recording& recording) {
        const Timeline& timeline = def_.timeline;
        const double time_s = timeline.time_s(index);
        if (index == 0) ++passes_;
        if (!compare_before(time_s)) return false;
        const bool compares = agrees() && timeline.is_frame(index);
        if (compares) checks_.start(time_s, left());
        const Status status = work_.run(most_updates_by(time_s),
                                        [&] { return recording.advance(run_, timeline, def_.clock_s); });
        const bool is_lost = status == Status::kDiverged || run_.diagnostics().branched_s.has_value();
        has_diverged_ = has_diverged_ || (is_lost && agrees());
        if (status == Status::kDiverged) return false;
        if (!compares) return true;
        if (index == 0) passes_ += static_cast<int>(checks_.size());
        compare(run_.state(), true);
        return true;
    }

    /// Compares between the last frame and the end of the plan.
    void compare_until_end() {
        try {
            if (compare_before(def_.end_s) && agrees() && time_s() < def_.end_s) compare_at(def_.end_s);
        } catch (const TooMuchWork&) {
            is_unchecked_ = true;
        }
    }

    /// Writes how far they agree.
    void conclude(const MotionBounds& bounds, Trial& trial) const {
        trial.steps = steps();
        trial.check_steps = checks_.steps();
        trial.updates = updates();
        trial.unchecked = is_unchecked_;
        trial.diverged = has_diverged_;
        comparison_.conclude(bounds, hidden_m(system_, trial) + play_of_taut_rows_m(system_), trial);
        trial.error_estimate_m += rounding_m(system_, bounds);
        trial.to_the_end = trial.to_the_end && !has_diverged_ && !is_unchecked_;
        trial.undecided = !trial.to_the_end && other_snaps_.reached_s(bounds) > trial.reached_s;
    }

  private:
    static constexpr double kFirstPoint = 0.0625;  ///< of a frame

    /// Work that the checks may still take, and the run until a time.
    [[nodiscard]] double left() const { return std::max(0.0, most_updates_ - updates()); }
    [[nodiscard]] double most_updates_by(double time_s) const {
        constexpr double kAtFirst = 1e8;
        return is_drawn_ ? HUGE_VAL : kAtFirst + most_updates_1_s_ * time_s;
    }

    /// Compares at times before `time_s` that are not recorded. False if the run diverges.
    bool compare_before(double time_s) {
        while (agrees()) {
            const std::optional<double> next_s = between_.next_s(time_s);
            if (!next_s) return true;
            if (!compare_at(*next_s)) return false;
        }
        return true;
    }

    bool compare_at(double time_s) {
        check_cancelled();
        checks_.start(time_s, left());
        const Status status = work_.run(most_updates_by(time_s), [&] { return run_.pass(time_s, point_); });
        if (status == Status::kDiverged) {
            has_diverged_ = true;
            return false;
        }
        compare(point_, false);
        return true;
    }

    /// Compares a state of the run with the checks, which are on their way to its time.
    void compare(const State& state, bool is_frame) {
        const Status status = checks_.finish();
        is_unchecked_ = checks_.have_ended();
        if (status == Status::kDiverged && !is_unchecked_) has_diverged_ = true;
        passed_.include(state);
        if (agrees()) {
            const double difference_m = other_snaps_.difference_m(is_frame, checks_, state, passed_,
                                                                  work_.updates(), left(), passes_);
            comparison_.add(state.time_s, is_frame, difference_m, passed_);
        }
        between_.add(state.time_s, steps());
    }

    const System& system_;
    const PlanDef& def_;
    double most_updates_;
    double most_updates_1_s_;  ///< of the run
    int& passes_;
    Forces forces_;
    Simulation run_;
    Meter work_;  ///< of run_
    Checks checks_;
    Comparison comparison_;
    OtherSnaps other_snaps_;
    Between between_;
    State point_;
    MotionBounds passed_;
    bool has_diverged_ = false;
    bool is_unchecked_ = false;  ///< the checks have ended
    bool is_drawn_ = false;
};

}  // namespace

CancelScope report_frames(const PlanDef& def, const std::int64_t& frames_done) {
    return CancelScope([&def, &frames_done] {
        report_progress(def.on_progress, frames_done, static_cast<std::int64_t>(def.timeline.size()));
    });
}

bool may_buckle_unseen(const System& system, const MethodDef& method) {
    const Body& body = system.bodies.front();
    return is_implicit(method) && body.material.compliance_1_n > 0.0 && pin_count(system, body) > 1;
}

std::vector<MethodDef> checks_of(const System& system, const Trial& trial) {
    if (may_buckle_unseen(system, trial.method)) return {trial.check, trial.check};
    if (is_far_from_rounding(system, trial.method)) return {trial.check};
    const bool has_fixed_steps = std::holds_alternative<RattleDef>(trial.method);
    const MethodDef& others = has_fixed_steps ? trial.method : trial.check;
    return {trial.check, others, others};
}

Trial run_trial(const System& system, const WorldDef& world, const PlanDef& def, TrialKind kind, Trial trial,
                Recording& recording) {
    const auto total = static_cast<std::int64_t>(def.timeline.size());
    std::int64_t i = 0;
    const CancelScope progress = report_frames(def, i);
    CheckedRun run(system, world, def, trial, kind, trial.passes);
    bool is_last = false;
    const auto count_steps = [&] {
        const double most = kind.first_steps + kind.most_steps_1_s * run.time_s();
        if (!is_last && static_cast<double>(run.steps()) > most) throw TooMuchWork();
        return true;
    };
    bool is_known = false;  // whether the trial holds
    const auto conclude = [&] {
        is_known = true;
        run.conclude(recording.bounds(), trial);
        if (!trial.to_the_end && !is_last) is_last = kind.is_last(trial, run.time_s(), run.run_updates());
        if (is_last) run.draw();
    };
    recording.clear();
    try {
        const CancelScope limit(count_steps);
        for (; i < total; ++i) {
            check_cancelled();
            if (!run.agrees() && !is_known) conclude();
            if (!run.agrees() && !is_last) return trial;
            if (!run.record(static_cast<std::size_t>(i), recording)) break;
            count_steps();
        }
    } catch (const TooMuchWork&) {
        trial.steps = run.steps();
        trial.updates = run.updates();
        trial.too_long = true;
        return trial;
    }
    if (i == total) run.compare_until_end();
    conclude();
    return trial;
}

std::optional<Refusal> refusal(const System& system, const WorldDef& world, const MethodDef& method,
                               double frame_interval_s) {
    try {
        static_cast<void>(make_solver(system, world, {&method, 1}, frame_interval_s));
    } catch (const Refusal& refused) {
        return refused;
    }
    return std::nullopt;
}

}  // namespace corda::sim
