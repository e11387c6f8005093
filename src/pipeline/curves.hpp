#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "corda/scene/scene.hpp"
#include "corda/sim/energy.hpp"
#include "corda/view/plot_panel.hpp"

namespace corda::pipeline {

/// What the live plot of a scene shows of its motion.
class Curves {
  public:
    /// The scene and its system must outlive it.
    Curves(const Scene& scene, const System& system);

    /// What states must have.
    [[nodiscard]] Readings readings() const;
    /// Reads the whole motion of bodies with these methods: `state_of` gives each of so many states. The
    /// potential energy is 0 where it is least.
    [[nodiscard]] view::PlotData read(std::span<const MethodDef> methods, std::int64_t states,
                                      const std::function<const State&(std::int64_t)>& state_of);
    /// Where the curves are at a state, after read(). Empty without a plot.
    [[nodiscard]] std::vector<view::CurvePoint> at(const State& state) const;

  private:
    const Scene* scene_;
    const System* system_;
    LivePlot plot_;
    std::size_t tip_;  ///< the particle that is followed
    std::optional<sim::EnergyMeter> meter_;
    double least_potential_j_ = 0.0;
};

}  // namespace corda::pipeline
