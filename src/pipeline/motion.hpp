#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/timeline.hpp"
#include "corda/sim/recording.hpp"
#include "corda/sim/simulation.hpp"

namespace corda::pipeline {

/// The states of one run of a system at the times of a timeline, readable in any order. They are simulated
/// once, when first asked for, and recorded; those beyond the memory budget are simulated again, with the
/// same bits.
class Motion {
  public:
    /// A motion that has not begun, by a method per body or, if there are none, by those that record() will
    /// find. `quantity` and `readings`: see sim::Recording. `system` must outlive it. Throws corda::Refusal
    /// if a method cannot run its body, and corda::Error (kInterrupted) if asked to stop.
    Motion(const System& system, const WorldDef& world, std::vector<MethodDef> methods, Timeline timeline,
           std::size_t budget_bytes, const OnProgress& on_progress = {},
           std::optional<Quantity> quantity = {}, const StateFields& readings = {});
    Motion(const Motion&) = delete;
    Motion& operator=(const Motion&) = delete;

    /// Lets a planner record the run that it proves: `plan` is called with the recording, which then is this
    /// motion.
    Plan record(const std::function<Plan(const Timeline&, sim::Recording&)>& plan);

    /// Simulates what has not been yet. A run that diverges ends the motion early and is no error. Throws as
    /// at() does, except kDiverged.
    void run_to_end(const OnProgress& on_progress);

    /// The state at a time of the timeline, or at any other time between 0 and its end. The reference holds
    /// until the next call. Calls `on_progress` during steps that take long; it must not use the motion.
    /// Throws corda::Error: kDiverged if the motion ends before, kInterrupted if asked to stop.
    const State& at(double time_s, const OnProgress& on_progress = {});
    /// Keeps the states at these times, increasing, beside the recording, whatever its budget is. Throws as
    /// at().
    void keep(std::span<const double> times_s, const OnProgress& on_progress);
    /// Figures of the last state that at() returned.
    [[nodiscard]] const Figures& figures() const { return figures_; }

    [[nodiscard]] const Timeline& timeline() const { return timeline_; }
    [[nodiscard]] const sim::Recording& recording() const { return recording_; }
    /// One per body, with every default filled in.
    [[nodiscard]] const std::vector<MethodDef>& methods() const { return methods_; }
    /// How many simulations this object has begun to step.
    [[nodiscard]] int passes() const { return passes_; }
    /// Whether the run is known to end before the timeline does.
    [[nodiscard]] bool diverges() const { return diverges_; }

  private:
    struct Kept {
        State state;
        Figures figures;
    };

    void start(const OnProgress& on_progress);
    /// Tells `on_progress`, which must outlive it, the time that run_ goes to.
    [[nodiscard]] GoesOn asking(const OnProgress& on_progress) const;
    /// Goes on to the next time of the timeline; false if the run diverges there.
    [[nodiscard]] bool step(const OnProgress& on_progress);
    /// Advances run_, and records the state if it is new.
    Status advance_to(double time_s, bool is_new, const OnProgress& on_progress);
    [[noreturn]] void fail_diverged(double time_s) const;

    const System* system_;
    WorldDef world_;
    std::vector<MethodDef> methods_;
    Timeline timeline_;
    sim::Recording recording_;
    std::optional<Simulation> run_;  ///< started as soon as something has to be simulated
    std::size_t next_ = 0;           ///< the time that it goes to next
    int passes_ = 0;
    bool diverges_ = false;
    std::map<double, Kept> kept_;  ///< by time
    State state_;
    Figures figures_;
};

}  // namespace corda::pipeline
