#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/rational.hpp"
#include "corda/core/timeline.hpp"
#include "corda/scene/scene.hpp"
#include "corda/sim/auto/planner.hpp"
#include "corda/sim/recording.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::pipeline {

/// The states of one run of a system at the times of a timeline, readable in any order. They are simulated on
/// first use and recorded; states beyond the memory budget are simulated again, with the same bits.
class Motion {
  public:
    /// A motion that has not started, with one method per body or, if `methods` is empty, those that record()
    /// will find. `quantity` and `readings`: see sim::Recording. `system` must outlive it. Throws
    /// corda::Refusal if a method cannot run its body, and corda::Error (kInterrupted) if asked to stop.
    Motion(const System& system, const WorldDef& world, std::vector<MethodDef> methods, Timeline timeline,
           std::size_t budget_bytes, const OnProgress& on_progress = {},
           std::optional<Quantity> quantity = {}, const StateFields& readings = {});
    Motion(const Motion&) = delete;
    Motion& operator=(const Motion&) = delete;

    /// Calls a planner with the recording, in which it records the run that it has verified.
    Plan record(const std::function<Plan(const Timeline&, sim::Recording&)>& plan);

    /// Simulates the motion to its end. A run that diverges ends it early, which is no error. Throws as at(),
    /// except kDiverged.
    void run_to_end(const OnProgress& on_progress);

    /// The state at a time of the timeline, or at any other time between 0 and its end. The reference holds
    /// until the next call. Calls `on_progress` during steps that take long; it must not use the motion.
    /// Throws corda::Error: kDiverged if the motion ends before, kInterrupted if asked to stop.
    const State& at(double time_s, const OnProgress& on_progress = {});
    /// Keeps the states at these increasing times in addition to the recording, whatever the budget is.
    /// Throws as at().
    void keep(std::span<const double> times_s, const OnProgress& on_progress);
    /// Figures of the last state that at() returned.
    [[nodiscard]] const Figures& figures() const { return figures_; }

    [[nodiscard]] const Timeline& timeline() const { return timeline_; }
    [[nodiscard]] const sim::Recording& recording() const { return recording_; }
    /// One per body, with every default filled in.
    [[nodiscard]] const std::vector<MethodDef>& methods() const { return methods_; }
    /// Number of simulations that this object has started to step.
    [[nodiscard]] int passes() const { return passes_; }
    /// True if the run is known to end before the timeline.
    [[nodiscard]] bool diverges() const { return diverges_; }

  private:
    struct Kept {
        State state;
        Figures figures;
    };

    void start(const OnProgress& on_progress);
    /// Reports the time that run_ advances to to `on_progress`, which must outlive the result.
    [[nodiscard]] GoesOn asking(const OnProgress& on_progress) const;
    /// Advances to the next time of the timeline; false if the run diverges there.
    [[nodiscard]] bool step(const OnProgress& on_progress);
    /// Advances run_, and records the state if it is new.
    Status advance_to(double time_s, bool is_new, const OnProgress& on_progress);
    [[noreturn]] void fail_diverged(double time_s) const;

    const System* system_;
    WorldDef world_;
    std::vector<MethodDef> methods_;
    Timeline timeline_;
    sim::Recording recording_;
    std::optional<Simulation> run_;  ///< made by the first simulation
    std::size_t next_ = 0;           ///< index of the time that run_ advances to next
    int passes_ = 0;
    bool diverges_ = false;
    std::map<double, Kept> kept_;  ///< by time
    State state_;
    Figures figures_;
};

/// A motion and its plan, which several films may show in different looks, and several renderers may read in
/// different threads.
class SharedMotion {
  public:
    explicit SharedMotion(const Scene& scene);

    /// Required to read the motion. Throws corda::Error (kUsage) inside of a guarded() callback.
    [[nodiscard]] std::unique_lock<std::mutex> lock();
    /// The callback, which must outlive the result, such that lock() refuses calls from inside of it.
    [[nodiscard]] OnProgress guarded(const OnProgress& on_progress) const;

    System system;
    sim::NamedMethods named;
    std::optional<Motion> motion;
    Plan plan;

  private:
    std::mutex mutex_;
};

/// Records the paths of particles at frame times for trails. A trail has the same points whatever was drawn
/// before.
class TrailRecorder {
  public:
    /// `trail_s`: length of a trail. A long trail has a point every few frames only.
    TrailRecorder(std::vector<std::size_t> particles, double trail_s, FrameRate fps);

    /// Reads the motion as far as trails at this time need it. Throws as Motion::at().
    void read(Motion& motion, double time_s, const OnProgress& on_progress);
    /// The trails that end at a state, one per particle. Requires read() up to its time.
    [[nodiscard]] const std::vector<view::Trail>& to(const State& state);

  private:
    [[nodiscard]] double time_s(std::size_t point) const {
        return fps_.time_s(static_cast<std::int64_t>(point) * stride_);
    }

    std::vector<std::size_t> particles_;
    double trail_s_;
    FrameRate fps_;
    std::int64_t stride_;     ///< frames per point
    std::vector<Vec2> at_m_;  ///< per point: all particles
    std::size_t points_ = 0;
    std::vector<view::Trail> trails_;
};

}  // namespace corda::pipeline
