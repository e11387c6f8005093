#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/sim/exact/chain_dynamics.hpp"

namespace corda::sim {

/// The motion of a string of rigid links while the same links stay taut: each run of taut links moves as a
/// rigid chain (ChainDynamics), each particle between two slack links by itself.
///
/// A state is one of the runs' ChainDynamics, followed by the displacement from the start and the velocity
/// (x, y, vx, vy) of every particle that no taut link holds.
class StringDynamics final : public Dynamics {
  public:
    /// Starts from the positions and velocities of `string`, in which link k joins particles k and k + 1 and
    /// there are no other bars. `is_taut`: one entry per link; a taut link is at its rest length and not
    /// between two pins.
    StringDynamics(const System& string, const std::vector<std::uint8_t>& is_taut, const Forces& forces);

    [[nodiscard]] const std::vector<double>& initial_state() const override { return initial_state_; }
    [[nodiscard]] std::vector<ErrorScale> error_scales() const override;
    [[nodiscard]] double inverse_timescale_1_s() const override { return inverse_timescale_1_s_; }
    void derivative(const double* y, double* slope) override;
    void project(double* y) override { runs_.project(y); }
    void positions(const double* y, State& state) const override;
    [[nodiscard]] double energy_j(const double* y) const override;
    [[nodiscard]] Loads loads(const double* y) override { return runs_.loads(y); }

    void velocities(const double* y, std::vector<double>& vx_m_s, std::vector<double>& vy_m_s) const override;

    /// That of a slack link is 0.
    void tensions(const double* y, std::vector<double>& tension_n) override { runs_.tensions(y, tension_n); }

  private:
    struct Loose {
        std::size_t particle = 0;
        Vec2 start_m;
        double mass_kg = 0.0;
    };

    void add_loose(const System& string, std::size_t particle);
    [[nodiscard]] double inverse_timescale_of(const System& string,
                                              const std::vector<std::uint8_t>& is_taut) const;

    Forces forces_;
    double length_m_;
    ChainDynamics runs_;
    std::vector<Loose> loose_;
    std::size_t first_loose_;  ///< index in a state
    std::vector<double> initial_state_;
    double inverse_timescale_1_s_ = 1.0;
};

}  // namespace corda::sim
