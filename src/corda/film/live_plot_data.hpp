#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "corda/scene/scene.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/view/plot_panel.hpp"

namespace corda::film {

class LivePlotData {
  public:
    /// The scene and its system must outlive it.
    LivePlotData(const Scene& scene, const System& system) : scene_(&scene), system_(&system) {}

    /// Fields that states must have, for `overlay.energy` too.
    [[nodiscard]] StateFields readings() const;
    /// Times between frames at which to record states, so that the curves do not depend on the frame rate.
    /// Empty without plots.
    [[nodiscard]] std::vector<double> times_s() const;
    /// Reads the motion of bodies with these methods up to `end_s`, at those times and at frame times,
    /// whatever else is recorded, for each plot in turn. With relaxation there is no total energy: bars that
    /// it stretches store none. `energy_of` is called with the last state of `state_at`.
    [[nodiscard]] std::vector<view::PlotData> read(
        const std::vector<MethodDef>& methods, double end_s,
        const std::function<const State&(double time_s)>& state_at,
        const std::function<Energy(const State&)>& energy_of) const;

  private:
    const Scene* scene_;
    const System* system_;
};

/// See Film::left_out(). `shown`: the panels of the first plots.
[[nodiscard]] std::vector<std::string> left_out_of(const Scene& scene,
                                                   std::span<const view::PlotPanel> shown);

}  // namespace corda::film
