#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/sim/exact/chain_series.hpp"
#include "corda/sim/exact/exact_part.hpp"

namespace corda::sim {

/// A rope of rigid links, integrated by Taylor series in time. Pins cut it into chains, each of which takes
/// steps of its own.
///
/// The length of a step follows from the last terms of its series, and the series is the motion at all times
/// within the step. Steps depend on the start alone, never on the times that are asked for, so the same bits
/// come out whatever these are.
class ChainPart final : public ExactPart {
  public:
    /// `body`: a chain of the system. Throws what ChainDynamics throws.
    ChainPart(const System& system, const Body& body, const Forces& forces, double tolerance);

    Status advance_to(double time_s, State& state, StopCheck& stop) override;
    [[nodiscard]] double energy_j() const override { return dynamics_.energy_j(output_.data()); }
    [[nodiscard]] Loads loads() override { return dynamics_.loads(output_.data()); }
    void velocities(std::vector<double>& vx_m_s, std::vector<double>& vy_m_s) override {
        dynamics_.velocities(output_.data(), vx_m_s, vy_m_s);
    }
    void tensions(std::vector<double>& tension_n) override { dynamics_.tensions(output_.data(), tension_n); }
    [[nodiscard]] std::uint64_t steps() const override;
    [[nodiscard]] std::uint64_t rejected_steps() const override { return 0; }

  private:
    struct Mover {
        const ChainDynamics::Chain& chain;
        ChainSeries series;
        StepControl control;
        double start_s = 0.0;  ///< of the step that the series is for
        double end_s = 0.0;
        std::uint64_t steps = 0;
    };

    Status step(Mover& mover, StopCheck& stop);

    ChainDynamics dynamics_;
    std::vector<double> state_;   ///< each chain at the end of its last step
    std::vector<double> output_;  ///< at the last time asked for
    std::vector<Mover> movers_;
};

}  // namespace corda::sim
