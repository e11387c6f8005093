#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/sim/chain_dynamics.hpp"

namespace corda::sim {

/// The motion of a string of rigid links while the same links stay taut and the others slack: every run of
/// taut links moves as a rigid chain (ChainDynamics), every particle between two slack links by itself.
///
/// A state is one of the runs' ChainDynamics, followed by the displacement from the start and the velocity
/// (x, y, vx, vy) of every particle that no taut link holds.
class StringDynamics final : public Dynamics {
  public:
    /// From the positions and velocities of `string`, in which link k joins particles k and k + 1 and there
    /// are no others. `is_taut`: one a link; those are at their rest length. Links between two pins are not
    /// taut.
    StringDynamics(const System& string, const std::vector<std::uint8_t>& is_taut, const WorldDef& world);

    [[nodiscard]] const std::vector<double>& initial_state() const override { return initial_state_; }
    [[nodiscard]] std::vector<ErrorScale> error_scales() const override;
    [[nodiscard]] double largest_rate_1_s() const override { return largest_rate_1_s_; }
    void derivative(const double* y, double* slope) override;
    void settle(double* y) override { runs_.settle(y); }
    void positions(const double* y, State& state) const override;
    [[nodiscard]] double energy_j(const double* y) const override;
    [[nodiscard]] double energy_scale_j() const override { return energy_scale_j_; }
    [[nodiscard]] Loads loads(const double* y) override { return runs_.loads(y); }

    /// Writes the velocities of the particles that are not pinned, in m/s.
    void velocities(const double* y, std::vector<double>& vx_m_s, std::vector<double>& vy_m_s) const;

    /// Writes the tension of every link of the string in newtons, 0 where slack.
    void tensions(const double* y, std::vector<double>& tension_n);

  private:
    struct Loose {
        std::size_t particle = 0;
        Vec2 start_m;
        double mass_kg = 0.0;
    };

    void add_loose(const System& string, std::size_t particle);
    [[nodiscard]] double rate_1_s(const System& string, const std::vector<std::uint8_t>& is_taut) const;

    Vec2 gravity_m_s2_;
    double drag_1_s_;
    double length_m_ = 0.0;
    ChainDynamics runs_;
    std::size_t link_count_;
    std::vector<Loose> loose_;
    std::size_t first_loose_;  ///< in a state
    std::vector<double> initial_state_;
    double largest_rate_1_s_ = 1.0;
    double energy_scale_j_ = 0.0;
    std::vector<double> run_tension_n_;  ///< scratch
};

}  // namespace corda::sim
