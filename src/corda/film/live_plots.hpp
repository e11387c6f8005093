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

/// Times between frames at which to record states, so that the curves do not depend on the frame rate. Empty
/// without plots.
[[nodiscard]] std::vector<double> plot_times_s(const Scene& scene, const System& system);

/// The curves of each plot of a scene, read at those times and at frame times, whatever else is recorded.
/// With relaxation there is no total energy: bars that it stretches store none.
[[nodiscard]] std::vector<view::PlotData> plots_of(const Scene& scene, const Motion& motion);

/// See Film::left_out(). `shown`: the panels of the first plots.
[[nodiscard]] std::vector<std::string> left_out_of(const Scene& scene,
                                                   std::span<const view::PlotPanel> shown);

}  // namespace corda::film
