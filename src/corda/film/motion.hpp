#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/rational.hpp"
#include "corda/core/timeline.hpp"
#include "corda/scene/scene.hpp"
#include "corda/sim/auto/planner.hpp"
#include "corda/sim/forces/elastic_forces.hpp"
#include "corda/sim/recording.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::film {

/// Changes of a system that may keep it from diverging, in words.
[[nodiscard]] std::string divergence_advice(const System& system);

/// The states of one run of a system at the times of a timeline, readable in any order. They are simulated on
/// first use and recorded; states beyond the memory budget are simulated again, with the same bits.
class Motion : NonCopyable {
  public:
    /// A motion that has not started, with one method per body or, if `methods` is empty, those that record()
    /// will find. `quantity` and `readings`: see sim::Recording. `system` must outlive it. Throws
    /// corda::Refusal if a method cannot run its body.
    Motion(const System& system, const WorldDef& world, std::vector<MethodDef> methods, Timeline timeline,
           std::size_t budget_bytes, std::optional<Quantity> quantity = {}, const StateFields& readings = {});

    /// Calls a planner with the recording, in which it records the run that it chooses.
    Plan record(const std::function<Plan(const Timeline&, sim::Recording&)>& plan);

    /// Simulates the motion to its end. A run that diverges ends it early, which is no error. Throws as at(),
    /// except kDiverged.
    void run_to_end();

    /// The state at a time of the timeline, or at any other time between 0 and its end. The reference holds
    /// until the next call. Throws corda::Error: kDiverged if the motion ends before, kInterrupted if
    /// cancelled.
    const State& at(double time_s);
    /// Keeps the states at these increasing times in addition to the recording, whatever the budget is.
    /// Throws as at().
    void keep(std::span<const double> times_s);
    /// Figures of the last state that at() returned.
    [[nodiscard]] const Figures& figures() const { return figures_; }

    /// The energy of a state of this motion with velocities; that of the weight is 0 at the start. Throws
    /// corda::Error (kUsage) without velocities.
    [[nodiscard]] Energy energy_of(const State& state);

    [[nodiscard]] const Timeline& timeline() const { return timeline_; }
    [[nodiscard]] const sim::Recording& recording() const { return recording_; }
    /// One per body, with every default filled in.
    [[nodiscard]] const std::vector<MethodDef>& methods() const { return methods_; }
    /// Index of the time that the run advances to next.
    [[nodiscard]] std::size_t next() const { return next_; }
    /// Number of simulations that this object has started to step.
    [[nodiscard]] int passes() const { return passes_; }
    /// True if the run is known to end before the timeline.
    [[nodiscard]] bool diverges() const { return diverges_; }

  private:
    struct Kept {
        State state;
        Figures figures;
    };

    void start();
    /// Advances to the next time of the timeline; false if the run diverges there.
    [[nodiscard]] bool step();
    /// Advances run_, and records the state if it is new.
    Status advance_to(double time_s, bool is_new);
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
    std::optional<sim::EnergyMeter> meter_;
    double weight_at_start_j_ = 0.0;
};

/// A motion and its plan, which several films may show in different looks, and several renderers may read in
/// different threads.
class SharedMotion {
  public:
    explicit SharedMotion(const Scene& scene);

    /// A call, on this thread, that uses the motion or draws it.
    class Activity : NonCopyable {
      public:
        /// Throws corda::Error (kUsage) inside of a callback of another activity with this motion.
        explicit Activity(const SharedMotion& motion);
        ~Activity();

      private:
        const SharedMotion* motion_;
        int callback_depth_;
        const Activity* outer_;
    };

    /// Exclusive use of the motion, required to read it. Progress of the simulation is reported meanwhile.
    class Use {
      public:
        /// Throws as Activity. `on_progress` must outlive it.
        Use(SharedMotion& motion, const OnProgress& on_progress);

      private:
        Activity activity_;
        std::unique_lock<std::mutex> lock_;
        CancelScope progress_;
    };

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
    void read(Motion& motion, double time_s);
    /// The trails that end at a state, one per particle. Requires read() up to its time.
    [[nodiscard]] const std::vector<view::Trail>& to(const State& state);

  private:
    [[nodiscard]] double time_s(std::size_t point) const {
        return fps_.time_s(static_cast<std::int64_t>(point) * stride_);
    }

    std::vector<std::size_t> particles_;
    double trail_s_;
    FrameRate fps_;
    std::int64_t stride_;                     ///< frames per point
    std::vector<view::TrailPoint> recorded_;  ///< per point: all particles, without ages
    std::size_t points_ = 0;
    std::vector<view::Trail> trails_;
};

}  // namespace corda::film
