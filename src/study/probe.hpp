#pragma once

#include "corda/sim/simulation.hpp"

namespace corda::study {

/// A run of one rope that can be looked at at any time, and the time that its steps take.
class Probe {
  public:
    /// Throws corda::Error if the method cannot run the rope. `frame_interval_s`: see Simulation.
    Probe(const RopeDef& rope, const WorldDef& world, const MethodDef& method,
          double frame_interval_s = 1.0 / 60.0);

    /// Goes on to a time. Throws corda::Error (kDiverged) if the run diverges.
    void go(double time_s);
    /// Goes on to a time in frames, so that the largest figures are those of every frame.
    void go_by_frames(double time_s, double frames_per_second = 60.0);

    [[nodiscard]] const State& state() const { return simulation_.state(); }
    [[nodiscard]] const Figures& figures() const { return simulation_.figures(); }
    [[nodiscard]] Diagnostics diagnostics() const { return simulation_.diagnostics(); }
    [[nodiscard]] Vec2 tip_m() const { return {state().x_m.back(), state().y_m.back()}; }
    /// Seconds that go() has taken so far.
    [[nodiscard]] double wall_s() const { return wall_s_; }

  private:
    Simulation simulation_;
    double wall_s_ = 0.0;
};

}  // namespace corda::study
