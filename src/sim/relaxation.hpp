#pragma once

#include <cstdint>
#include <vector>

#include "corda/sim/relaxation_kernels.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

/// The source report's method (PHYSICS section 1): Verlet's update of every free particle, then passes over
/// all bars, each pushing its two particles along its new direction until it has its rest length.
///
///   next = current + (1 - delta) (current - previous) + (h^2 / m) f
///   adjust = distance - rest, direction = (p2 - p1) / distance; each of two free particles moves by adjust /
///   2 towards the other, a free one beside a pinned one by the whole of it.
///
/// The update is kept in its summed form: a particle carries its last move d = current - previous, and
/// d <- (1 - delta) d + (h^2 / m) f, current <- current + d, then d takes up what the bars moved. The same
/// numbers but for rounding, which grows with the number of steps in place of its square (Hairer, Lubich,
/// Wanner, Geometric Numerical Integration, VIII.5).
///
/// Its first position is an Euler step, x(h) = x(0) + h v(0), so that the state at n h is Verlet's after n -
/// 1 updates and free fall is late by -g h t / 2: a property of the method, kept. Bars go one after the other
/// in the order of System::bars. Drag is damping too: with a rate c, 1 - delta is multiplied by exp(-c h).
///
/// Times that are no multiple of the step are read off the parabola through the three nearest states.
class Relaxation final : public Solver {
  public:
    /// `kernel` has to be one of relaxation_kernels(); which one it is changes the time taken and no bit.
    Relaxation(const System& system, const WorldDef& world, const SolverDef& def, double default_step_s,
               RelaxationKernel kernel = relaxation_kernels().back());

    Status advance_to(double time_s, State& state) override;
    [[nodiscard]] double energy_j() const override;
    [[nodiscard]] double energy_scale_j() const override;
    [[nodiscard]] bool conserves_energy() const override { return motion_.keep == 1.0; }
    [[nodiscard]] std::uint64_t steps() const override { return step_; }

  private:
    void advance(std::uint64_t steps);
    void interpolate(double fraction, State& state) const;

    double step_s_;
    std::uint64_t sweeps_;
    RelaxationKernel kernel_;
    std::uint64_t step_ = 0;
    /// The positions at step_ * step_s_, and the last move, which is x there less x a step before; before the
    /// first step, h v(0).
    RelaxationMotion motion_;
    std::vector<double> mass_kg_;
    std::vector<double> force_n_;                ///< x and y of each particle in turn; 0 for a pinned one
    std::vector<RelaxationBar> bars_;            ///< what kScalar goes by
    std::vector<RelaxationSchedule> schedules_;  ///< what the others go by: some bodies each
    double energy_scale_j_ = 0.0;
};

}  // namespace corda::sim
