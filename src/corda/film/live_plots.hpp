#pragma once

#include <span>
#include <string>
#include <vector>

#include "corda/scene/scene.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/view/plot_panel.hpp"

namespace corda::film {

struct Motion;

/// Fields that states must have for the live plots of a scene, and for `overlay.energy`.
[[nodiscard]] StateFields plot_fields(const Scene& scene);

/// Times between frames at which to record states, so that the curves and energy_zero_j() do not depend on
/// the frame rate. Empty without them.
[[nodiscard]] std::vector<double> plot_times_s(const Scene& scene, const System& system);

/// The potential energy since the start that plots and texts show as 0: 0, or its lowest value at those times
/// and at frame times (OverlayDef::energy_zero).
[[nodiscard]] double energy_zero_j(const Scene& scene, const Motion& motion);

/// The curves of each plot of a scene, read at those times and at frame times, whatever else is recorded.
/// With relaxation there is no total energy: bars that it stretches store none.
[[nodiscard]] std::vector<view::PlotData> plots_of(const Scene& scene, const Motion& motion);

/// See Film::left_out(). `shown`: the panels of the first plots.
[[nodiscard]] std::vector<std::string> left_out_of(const Scene& scene,
                                                   std::span<const view::PlotPanel> shown);

}  // namespace corda::film
