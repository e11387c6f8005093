#pragma once

#include "corda/sim/simulation.hpp"

namespace corda::study {

/// One rope under one method, looked at where one likes, and the time that its steps take.
class Probe {
  public:
    /// Throws corda::Error where the method cannot run the rope. `frame_interval_s`: see Simulation.
    Probe(const sim::RopeDef& rope, const sim::WorldDef& world, const sim::SolverDef& solver,
          double frame_interval_s = 1.0 / 60.0);

    /// Goes on to a time. Throws corda::Error (kDiverged) where the run diverges.
    void go(double time_s);
    /// Goes on to a time in frames of 1/60 s, so that the largest figures are those of all frames.
    void go_by_frames(double time_s);

    [[nodiscard]] const sim::State& state() const { return simulation_.state(); }
    [[nodiscard]] const sim::System& system() const { return simulation_.system(); }
    [[nodiscard]] const sim::Figures& figures() const { return simulation_.figures(); }
    [[nodiscard]] sim::Diagnostics diagnostics() const { return simulation_.diagnostics(); }
    [[nodiscard]] sim::Vec2 tip_m() const { return {state().x_m.back(), state().y_m.back()}; }
    [[nodiscard]] double wall_s() const { return wall_s_; }

  private:
    sim::Simulation simulation_;
    double wall_s_ = 0.0;
};

}  // namespace corda::study
