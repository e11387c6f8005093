#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "corda/scene/scene.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/view/plot_panel.hpp"

namespace corda::pipeline {

/// The data of a scene's live plot.
class LivePlotData {
  public:
    /// The scene and its system must outlive it.
    LivePlotData(const Scene& scene, const System& system);

    /// Fields that states must have.
    [[nodiscard]] StateFields readings() const;
    /// Times between frames at which to record states, so that the curves do not depend on the frame rate.
    /// Empty without a plot.
    [[nodiscard]] std::vector<double> times_s() const;
    /// Reads the motion of bodies with these methods up to `end_s`, at those times and at frame times,
    /// whatever else is recorded. The minimum of the potential energy is 0. With relaxation there is no total
    /// energy: bars that it stretches store none. `energy_of` is called with the last state of `state_at`.
    [[nodiscard]] view::PlotData read(const std::vector<MethodDef>& methods, double end_s,
                                      const std::function<const State&(double time_s)>& state_at,
                                      const std::function<Energy(const State&)>& energy_of) const;

  private:
    [[nodiscard]] view::PlotData axes() const;
    /// Adds a point to each curve.
    void add(const State& state, const std::function<Energy(const State&)>& energy_of,
             view::PlotData& data) const;

    const Scene* scene_;
    const System* system_;
    LivePlot plot_;
    std::size_t tip_;   ///< the tracked particle
    std::size_t body_;  ///< the body of that particle
};

}  // namespace corda::pipeline
