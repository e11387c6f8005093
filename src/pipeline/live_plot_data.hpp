#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "corda/scene/scene.hpp"
#include "corda/sim/forces/elastic_forces.hpp"
#include "corda/view/plot_panel.hpp"

namespace corda::pipeline {

/// What the live plot of a scene shows of its motion.
class LivePlotData {
  public:
    /// The scene and its system must outlive it.
    LivePlotData(const Scene& scene, const System& system);

    /// What states must have.
    [[nodiscard]] StateFields readings() const;
    /// Times beside those of frames at which states are to be recorded, so that the curves do not depend on
    /// the frame rate. Empty without a plot.
    [[nodiscard]] std::vector<double> times_s() const;
    /// Reads the whole motion of bodies with these methods, at those times and at those of frames, up to
    /// `end_s`: the same whatever else is recorded. The potential energy is 0 where it
    /// is least. With relaxation there is no total: bars that it stretches have no energy.
    [[nodiscard]] view::PlotData read(std::span<const MethodDef> methods, double end_s,
                                      const std::function<const State&(double time_s)>& state_at) const;

  private:
    [[nodiscard]] view::PlotData axes() const;
    /// Adds a point to each curve. `meter`: for energies.
    void add(const State& state, const std::optional<sim::EnergyMeter>& meter, view::PlotData& data) const;

    const Scene* scene_;
    const System* system_;
    LivePlot plot_;
    std::size_t tip_;   ///< the particle that is followed
    std::size_t body_;  ///< that it belongs to
};

}  // namespace corda::pipeline
