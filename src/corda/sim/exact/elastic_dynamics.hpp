#pragma once

#include <cstddef>
#include <vector>

#include "corda/sim/exact/dop853.hpp"
#include "corda/sim/forces/elastic_forces.hpp"
#include "corda/sim/moving_pins.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// The motion of one body whose bars stretch, in any graph, as a system of ordinary differential equations in
/// Cartesian coordinates (section 3.5 of src/corda/sim/README.md).
///
/// A state has one array each of x, y, vx and vy over all particles of the body, relative to the initial
/// position of the first one; those of pinned particles never change, even if they move.
///
/// The force of a string has a kink where it comes taut. Steps shrink there until their estimated errors meet
/// the tolerance, but the estimate for a step with a kink is less reliable.
class ElasticDynamics final : public Dynamics {
  public:
    /// Requires one body, whose material has a compliance.
    ElasticDynamics(const System& system, const Forces& forces);

    [[nodiscard]] const std::vector<double>& initial_state() const override { return initial_state_; }

    /// Positions are measured by the body's size, velocities by its size over its time scale and by
    /// themselves.
    [[nodiscard]] std::vector<ErrorScale> error_scales() const override;

    [[nodiscard]] double inverse_timescale_1_s() const override { return inverse_timescale_1_s_; }
    /// Bound on the largest angular frequency at the start, in 1/s.
    [[nodiscard]] double frequency_1_s() const { return frequency_1_s_; }
    /// Large enough that no step lets the fastest vibration grow.
    [[nodiscard]] double inverse_stable_step_1_s() const override;

    void set_time(double time_s) override;
    [[nodiscard]] double next_key_s(double time_s) const override;
    void derivative(const double* y, double* slope) override;

    void positions(const double* y, State& state) const override;
    [[nodiscard]] double energy_j(const double* y) const override;
    void velocities(const double* y, State& state) const override;
    void tensions(const double* y, std::vector<double>& tension_n) override {
        const double* const at = with_pins(y);
        elastic_.tensions(at, at + count_, tension_n);
    }

  private:
    struct Pin {
        std::size_t particle = 0;
        Vec2 position_m;  ///< relative to the system's origin, to the last bit
    };
    void measure();
    /// The positions, with pins where they are at the time set.
    [[nodiscard]] const double* with_pins(const double* y) const;

    std::size_t count_;
    Vec2 origin_m_;  ///< of a state, relative to the system's origin
    Forces forces_;
    ElasticForces elastic_;
    std::vector<double> mass_kg_;  ///< 0 if pinned
    std::vector<double> inverse_mass_1_kg_;
    std::vector<double> falls_;  ///< 1, or 0 if pinned
    std::vector<Pin> pins_;
    std::vector<MovingPin> moving_;
    std::vector<Vec2> moved_m_;  ///< one per moving_, at time_s_
    double time_s_ = 0.0;
    mutable std::vector<double> place_m_;  ///< scratch of with_pins()
    std::vector<double> initial_state_;
    double size_m_ = 0.0;
    double inverse_timescale_1_s_ = 0.0;  ///< see Forces::inverse_timescale_1_s; of its size
    double frequency_1_s_ = 0.0;          ///< bound on the largest at the start
    double energy_offset_j_ = 0.0;        ///< potential energy of all masses at origin_m_
};

}  // namespace corda::sim
