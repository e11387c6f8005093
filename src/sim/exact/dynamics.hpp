#pragma once

#include <vector>

#include "corda/sim/exact/dop853.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

/// The motion of bodies as a system of ordinary differential equations, and what its states mean.
class Dynamics : public Ode {
  public:
    /// The state at t = 0.
    [[nodiscard]] virtual const std::vector<double>& initial_state() const = 0;

    /// How errors in a state are measured, so that one tolerance fits all components.
    [[nodiscard]] virtual std::vector<ErrorScale> error_scales() const = 0;

    /// The inverse of the shortest time in which a body moves by about its own length, in 1/s; > 0.
    [[nodiscard]] virtual double inverse_timescale_1_s() const = 0;

    /// Writes the positions of the bodies' particles, relative to the system's origin; leaves the others
    /// alone.
    virtual void positions(const double* y, State& state) const = 0;

    /// Kinetic plus potential energy, the latter relative to the system's origin.
    [[nodiscard]] virtual double energy_j(const double* y) const = 0;

    /// Writes the velocities of the particles whose positions positions() writes, in m/s.
    virtual void velocities(const double* y, std::vector<double>& vx_m_s,
                            std::vector<double>& vy_m_s) const = 0;

    /// Writes the tensions of the bars that move, in N, a positive one pulls, to an array of all bars. Not
    /// const: it may use the scratch memory of derivative().
    virtual void tensions(const double* y, std::vector<double>& tension_n) = 0;

    /// What the bars carry. Not const: it may use the scratch memory of derivative().
    [[nodiscard]] virtual Loads loads(const double* y) = 0;
};

}  // namespace corda::sim
