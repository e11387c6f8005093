#pragma once

#include <memory>
#include <vector>

#include "corda/sim/exact/dop853.hpp"
#include "corda/sim/rattle/constraint_solver.hpp"

namespace corda::sim {

/// The motion of one body of rigid bars in any graph, in Cartesian coordinates: the tensions keep the second
/// derivatives of the bars' lengths 0, and each step ends with a projection onto the lengths (section 3.5 of
/// src/corda/sim/README.md).
///
/// A state has one array each of x, y, vx and vy over all particles of the body; those of held particles
/// never change.
class BarDynamics final : public Dynamics {
  public:
    /// Requires one body. Throws corda::Refusal for what make_constraint_solver() refuses, and (kRigidGraph)
    /// if the body resists bending.
    BarDynamics(const System& system, const Forces& forces);

    [[nodiscard]] const std::vector<double>& initial_state() const override { return initial_state_; }
    /// Positions are measured by the body's size, velocities by its size over its time scale and by
    /// themselves.
    [[nodiscard]] std::vector<ErrorScale> error_scales() const override;
    [[nodiscard]] double inverse_timescale_1_s() const override { return inverse_timescale_1_s_; }
    void set_time(double time_s) override { forces_.set_time(time_s); }
    [[nodiscard]] double next_key_s(double time_s) const override { return forces_.next_key_s(time_s); }
    /// NaN where bars depend on each other.
    void derivative(const double* y, double* slope) override;
    /// Gives the bars their lengths, and no velocities along them, by the least change weighted with the
    /// masses.
    void project(double* y) override;
    void positions(const double* y, State& state) const override;
    [[nodiscard]] double energy_j(const double* y) const override;
    void velocities(const double* y, State& state) const override;
    /// NaN if the bars do not determine them.
    void tensions(const double* y, std::vector<double>& tension_n) override;

  private:
    /// Finds the tension over length, N / m, of each link in a state. False if bars depend on each other.
    [[nodiscard]] bool find_multipliers(const double* y);
    void read(const double* y);
    /// Adds what impulses along the links of motion_ change to x and y.
    void apply(double* x, double* y) const;

    std::size_t count_;
    Forces forces_;
    std::unique_ptr<ConstraintSolver> constraints_;
    std::vector<double> mass_kg_;
    std::vector<std::size_t> bar_of_link_;  ///< empty if the bars do not determine the tensions
    std::vector<double> initial_state_;
    double size_m_ = 0.0;
    double inverse_timescale_1_s_ = 1.0;
    Motion motion_;                   ///< of the last state, where the matrix was factorised
    std::vector<double> multiplier_;  ///< one per link
};

}  // namespace corda::sim
