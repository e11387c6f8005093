#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/timeline.hpp"
#include "corda/sim/forces/forces.hpp"
#include "corda/sim/recording.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// The tolerance of positions in metres, > 0, for a motion with these bounds. It must not fall when the
/// bounds grow.
using ToleranceOf = std::function<double(const MotionBounds&)>;

/// Requirements of a plan: positions within a tolerance of the truth from the start to the last frame of the
/// timeline, or to `end_s` if that is later.
struct PlanDef {
    ToleranceOf tolerance_m;
    Timeline timeline;
    OnProgress on_progress = {};      ///< called for every frame of every trial, and during long ones
    std::function<double()> clock_s;  ///< measures the stepping of each run; empty: not measured
    double end_s = 0.0;
    double share = 1.0;  ///< of the work that planning may take, which is left for this body

    /// Its last time.
    [[nodiscard]] double last_s() const { return std::max(end_s, timeline.time_s(timeline.size() - 1)); }
    /// Work that planning may take, in updates of a particle (see count_work()): 10 s, and 1 s per second of
    /// motion, if an update takes 50 ns.
    [[nodiscard]] double most_updates() const { return 2e8 + 2e7 * last_s(); }
    /// Work that a run may take: 15 s, and 120 ms per frame of 1/60 s.
    [[nodiscard]] double most_updates_of_run() const { return 3e8 + 1.5e8 * last_s(); }
};

/// Thrown by a Meter.
struct TooMuchWork {};

/// Measures the work of a run, in updates of a particle.
class Meter {
  public:
    [[nodiscard]] double updates() const { return updates_; }

    /// Adds the work of `part()` in this thread, and returns its result. Throws TooMuchWork once all is more
    /// than `most_updates`, which is then what updates() returns.
    template <class Part>
    auto run(double most_updates, const Part& part) {
        const double before = updates_ - static_cast<double>(work_done());
        const auto count = [&] {
            updates_ = std::min(before + static_cast<double>(work_done()), most_updates);
            if (updates_ == most_updates) throw TooMuchWork();
        };
        const CancelScope limit(std::ref(count));
        const auto result = part();
        count();
        return result;
    }

  private:
    double updates_ = 0.0;
};

/// While it lives, check_cancelled() reports `frames_done` of the timeline to on_progress. Both must outlive
/// it.
[[nodiscard]] CancelScope report_frames(const PlanDef& def, const std::int64_t& frames_done);

/// The place of a trial among those of a plan.
struct TrialKind {
    double first_steps = 0.0;  ///< that the run may take, and then per second of motion
    double most_steps_1_s = HUGE_VAL;
    double most_updates = HUGE_VAL;  ///< work of the run and its checks, after which the checks end
    /// Asked once the trial, whose figures up to then it gets, has failed, at the time that its run has
    /// reached with this work. If true, the run will be drawn: it continues to the end without its checks.
    std::function<bool(const Trial&, double, double)> is_last = [](const Trial&, double, double) {
        return true;
    };
};

/// True if a run and its check may miss alike what becomes of a start: implicit steps damp vibrations along
/// links that stretch, which between two pins compress and buckle them. A second check then starts from
/// particles that are moved to either side, and shows how small movements grow.
[[nodiscard]] bool may_buckle_unseen(const System& system, const MethodDef& method);

/// The methods of a trial's checks. The first is its `check`, and so is the second if may_buckle_unseen(). A
/// run whose error is not far above rounding has two more, which show how rounding changes the motion. They
/// repeat a run of fixed steps, whose other errors hardly depend on the directions of coordinates.
[[nodiscard]] std::vector<MethodDef> checks_of(const System& system, const Trial& trial);

/// Runs the trial's method and its checks side by side, the checks in turned coordinates, so that their
/// rounding differs from the start on, and returns the trial with how far they agree. What runs of the same
/// method differ by counts twice. `recording` is cleared and receives the run's states. Once the difference
/// is too large for good, or the work too large, the checks end. Throws corda::Refusal.
[[nodiscard]] Trial run_trial(const System& system, const WorldDef& world, const PlanDef& def, TrialKind kind,
                              Trial trial, Recording& recording);

/// The reason a method cannot run a system; std::nullopt if it can.
[[nodiscard]] std::optional<Refusal> refusal(const System& system, const WorldDef& world,
                                             const MethodDef& method, double frame_interval_s);

/// The checks of a trial: runs in turned coordinates, which round otherwise than the trial's run, and than
/// one another, from the start on. Those of large systems advance in threads of their own; positions are the
/// same either way.
class Checks : NonCopyable {
  public:
    static constexpr std::size_t kMaxCount = 3;

    /// Those of checks_of().
    Checks(const System& system, const Forces& forces, const Trial& trial, double frame_interval_s);
    /// For a string of rigid links: runs in which links come taut `longer_m` later or earlier. Of any two of
    /// eight neighbours, each is the earlier one in some run.
    Checks(const System& string, const Forces& forces, const ExactDef& method, double longer_m);
    /// Ends the work of start().
    ~Checks();

    [[nodiscard]] std::size_t size() const { return checks_.size(); }

    /// Begins to advance all to a time, in threads if that is worth it; the caller may advance the run
    /// meanwhile. They end if one would take more than an equal share of this work in updates of a particle.
    void start(double time_s, double most_updates = HUGE_VAL);
    /// Waits until they are there. kDiverged also if one has branched or ended. Throws what
    /// Solver::advance_to throws.
    [[nodiscard]] Status finish();
    /// True if finish() found that one has ended for too much work.
    [[nodiscard]] bool have_ended() const { return have_ended_; }
    /// Work of all up to the last finish().
    [[nodiscard]] double updates() const { return updates_; }

    /// The largest distance of a particle from its positions in the checks plus twice the differences of runs
    /// of the same method. These are rounding; a run that is no better could be near the checks by chance and
    /// far from the truth. Infinite for a NaN.
    [[nodiscard]] double difference_m(const State& state) const;

    /// For a string of rigid links, StringPart::margin_m() of the first check; otherwise infinite.
    [[nodiscard]] double margin_m() const;

    /// Steps of the first check up to the last finish().
    [[nodiscard]] std::uint64_t steps() const { return steps_; }

  private:
    class Check;

    std::atomic<bool> is_abandoned_ = false;
    std::size_t first_alike_ = 0;  ///< of the checks that differ by rounding alone
    bool repeat_run_ = false;      ///< these do so from the run, too
    bool have_ended_ = false;
    double time_s_ = 0.0;             ///< that they have reached, or are on their way to
    double most_updates_ = HUGE_VAL;  ///< of each until it is there
    double updates_ = 0.0;
    std::uint64_t steps_ = 0;
    std::vector<std::unique_ptr<Check>> checks_;
    std::vector<std::future<Status>> pending_;  ///< declared last: it ends before what it uses does
};

/// Finds a method whose positions stay within the tolerance for the only body of `system`, and estimates its
/// error by tighter runs (section 3.6 of src/corda/sim/README.md). `recording` then holds the states of that
/// run, which are drawn. If no trial stays within the tolerance to the end, the tightest is taken, or one
/// that does so longer by a tenth, with a horizon. Decisions depend on counts and positions, never on a
/// clock. Throws corda::Refusal if no method can run the body.
[[nodiscard]] BodyPlan plan_body(const System& system, const WorldDef& world, const PlanDef& def,
                                 Recording& recording);

/// The method of each body; std::nullopt: plan_body() chooses it.
using NamedMethods = std::vector<std::optional<MethodDef>>;

/// Plans the bodies one after the other; those whose method is named are run by it. The tolerance of each is
/// that for the bounds of its own motion, those of the bodies before it and the start of all. Throws as
/// plan_body().
[[nodiscard]] Plan plan_methods(const System& system, const NamedMethods& named, const WorldDef& world,
                                const PlanDef& def, Recording& recording);

}  // namespace corda::sim
