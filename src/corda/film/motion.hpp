#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/timeline.hpp"
#include "corda/scene/scene.hpp"
#include "corda/sim/forces/elastic_forces.hpp"
#include "corda/sim/recording.hpp"
#include "corda/sim/simulation.hpp"

namespace corda::film {

/// Times and fields that simulate() records in addition to those that the pictures of the scene need.
struct RecordDef {
    std::vector<double> times_s;  ///< between frames, of stills
    double shutter = 0.0;         ///< exposure of these stills
    StateFields fields;
    OnProgress on_progress;  ///< called with the number of times reached, in every pass, and in long ones
    std::function<double()> clock_s;  ///< measures the stepping; empty: not measured
};

/// A scene's motion: the plan, and the states at all times that are drawn. Made by simulate(), and never
/// changed afterwards.
struct Motion : NonCopyable {
    Motion(System of, const WorldDef& in) : system(std::move(of)), world(in) {}

    /// True if the run ended before the scene does.
    [[nodiscard]] bool diverges() const { return recording->size() < timeline->size(); }
    /// The end: that of the scene, or the last recorded time if the run diverges.
    [[nodiscard]] double end_s() const;
    /// Every `stride`-th time of a timeline up to the end.
    [[nodiscard]] std::vector<double> times_of(const Timeline& times, std::size_t stride = 1) const;
    /// One per body, with every default filled in.
    [[nodiscard]] std::vector<MethodDef> methods() const;

    /// Calls `visit` with the states at increasing times within the scene. Those that are not recorded take
    /// one more simulation in all, with the same bits, unless the motion is given. Throws corda::Error:
    /// kDiverged if the motion ends before, kInterrupted if cancelled.
    void for_each(std::span<const double> times_s,
                  const std::function<void(const State&, const Figures&)>& visit) const;
    /// The state at a time. Throws as for_each().
    [[nodiscard]] State at(double time_s) const;

    /// The energy of a state of this motion with velocities; that of the weight is 0 at the start. Throws
    /// corda::Error (kUsage) without velocities.
    [[nodiscard]] Energy energy_of(const State& state) const;

    System system;
    WorldDef world;
    Plan plan;
    double duration_s = 0.0;
    std::optional<Timeline> timeline;
    std::optional<sim::Recording> recording;
    std::optional<sim::EnergyMeter> meter;
    std::shared_ptr<const GivenMotion> given;  ///< null: the motion is simulated
    double weight_at_start_j = 0.0;
};

/// Plans and simulates a scene that validate() accepts, or takes its given motion, and records it at the
/// times of frames, stills, exposures, plots and arrows. A run that diverges ends early. Throws corda::Error:
/// kInvalidScene if no method can run the scene or provide its tensions, kInterrupted if cancelled or if
/// on_progress returns false, kIo without room on the disk for a motion that exceeds the memory.
[[nodiscard]] std::shared_ptr<const Motion> simulate(const Scene& scene, const RecordDef& def);

/// Why a motion diverges, and what may keep it from that, in words.
struct Divergence {
    std::string cause;   ///< "; pins 0 and 2 of rope 0 are then ..."; empty if it is unknown
    std::string remedy;  ///< "less speed or force"
};
[[nodiscard]] Divergence divergence_of(const Motion& motion);

}  // namespace corda::film
