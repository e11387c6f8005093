#pragma once

#include <cstddef>
#include <vector>

#include "corda/sim/dynamics.hpp"
#include "corda/sim/elastic_forces.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// The motion of one body whose bars stretch, any graph of them, as a system of ordinary differential
/// equations in Cartesian coordinates: for a free particle of inverse mass w with the forces F
/// (ElasticForces) and the drag c
///
///   x' = v,   v' = g + w F(x) - c v.
///
/// A state has one array each of x, y, vx and vy over all particles of the body, relative to where its first
/// one starts; those of pinned particles never change.
///
/// The force of a string has a kink where it comes taut. Steps get short there until their estimated errors
/// meet the tolerance; the estimate of a step with a kink in it is less sure than that of others.
class ElasticDynamics final : public Dynamics {
  public:
    /// Requires a compliance of the body's material.
    ElasticDynamics(const System& system, const Body& body, const WorldDef& world);

    [[nodiscard]] const std::vector<double>& initial_state() const override { return initial_state_; }

    /// Positions by the body's size, velocities by its own rate times that and by themselves.
    [[nodiscard]] std::vector<ErrorScale> error_scales() const override;

    /// At least such that no step is so long that the fastest vibration grows.
    [[nodiscard]] double largest_rate_1_s() const override;

    void derivative(const double* y, double* slope) override;

    /// Sets what is too small to matter to zero.
    void settle(double* y) override;

    void positions(const double* y, State& state) const override;
    [[nodiscard]] double energy_j(const double* y) const override;
    [[nodiscard]] double energy_scale_j() const override { return energy_scale_j_; }
    [[nodiscard]] Loads loads(const double* y) override;

  private:
    struct Pin {
        std::size_t particle = 0;  ///< of the body
        Vec2 position_m;           ///< relative to the system's origin, to the last bit
    };
    void measure(const System& system, const Body& body);

    std::size_t first_particle_;
    std::size_t count_;
    Vec2 origin_m_;  ///< of a state, relative to the system's
    Vec2 gravity_m_s2_;
    double drag_1_s_;
    ElasticForces forces_;
    std::vector<double> mass_kg_;  ///< 0 where pinned
    std::vector<double> inverse_mass_1_kg_;
    std::vector<double> falls_;  ///< 1, or 0 where pinned
    std::vector<Pin> pins_;
    std::vector<double> initial_state_;
    double size_m_ = 0.0;
    double rate_1_s_ = 0.0;       ///< how fast it moves by about its own size
    double frequency_1_s_ = 0.0;  ///< bound on the largest one at the start
    double energy_scale_j_ = 0.0;
    double energy_offset_j_ = 0.0;  ///< potential energy of all masses at the state's origin
    std::vector<double> force_n_;   ///< scratch of loads(): x, then y
};

}  // namespace corda::sim
