#pragma once

#include <span>
#include <vector>

#include "corda/sim/simulation.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

/// The work that pins do which move: the integral of the force of each on what hangs from it times its
/// velocity, along a run of its own.
class SupportWork {
  public:
    /// As Simulation, which throws the same.
    SupportWork(const System& system, const WorldDef& world, std::span<const MethodDef> methods,
                double frame_interval_s);

    /// The work from the start to `time_s`, in J. Times must not decrease. NaN if a method does not know the
    /// forces, or for a string of rigid links, whose snaps pull in no time; infinite once the run has
    /// diverged. Calls check_cancelled().
    [[nodiscard]] double until_j(double time_s);

  private:
    /// On the masses of pins that will be let go, whose energy counts from the start.
    [[nodiscard]] double on_masses_j(double time_s) const;

    Simulation run_;
    LoadMeter meter_;
    Vec2 weight_m_s2_;
    std::vector<double> event_s_;  ///< where the power jumps
    double work_j_ = 0.0;
    double until_s_ = 0.0;
    double longest_s_;  ///< over which the next part is integrated
    double most_s_;     ///< of that
};

}  // namespace corda::sim
