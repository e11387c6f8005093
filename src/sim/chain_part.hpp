#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/sim/chain_series.hpp"
#include "corda/sim/exact_part.hpp"

namespace corda::sim {

/// A rope of rigid links, by Taylor series in time of as many terms as its tolerance calls for, and by the
/// velocity Verlet method where that is loose and the motion gentle. Each of the chains that its pins cut it
/// into takes steps of its own.
///
/// Steps follow from the last terms, and the series is the motion at all times within a step. They depend on
/// the start alone, never on the times that are asked for, so the same bits come out whatever these are.
class ChainPart final : public ExactPart {
  public:
    /// Of `body`, a chain of the system. Throws as ChainDynamics.
    ChainPart(const System& system, const Body& body, const WorldDef& world, double tolerance);

    Status advance_to(double time_s, State& state) override;
    [[nodiscard]] double energy_j() const override { return dynamics_.energy_j(output()); }
    [[nodiscard]] double energy_scale_j() const override { return dynamics_.energy_scale_j(); }
    [[nodiscard]] bool conserves_energy() const override { return conserves_energy_; }
    [[nodiscard]] Loads loads() const override { return dynamics_.loads(output()); }
    [[nodiscard]] std::uint64_t steps() const override;
    [[nodiscard]] std::uint64_t rejected_steps() const override { return 0; }

  private:
    struct Mover {
        const ChainDynamics::Chain& chain;
        ChainSeries series;
        StepControl control;
        double start_s = 0.0;  ///< of the step that series holds for
        double end_s = 0.0;
        std::uint64_t steps = 0;
        // Of velocity Verlet steps, series of order 1.
        double gentle_rad = 0.0;   ///< more than this, and a series of higher order takes over for good
        double hanging_1_s = 0.0;  ///< bound on the largest frequency of the chain at rest under its weight
    };

    Status step(Mover& mover);
    /// Expands the motion from the end of the last step, of `last_s`, on. Returns the time up to which the
    /// series may be followed, in s; 0 where it is not finite.
    double expand(Mover& mover, double last_s, double unit_s);
    /// The whole state at the last time asked for.
    [[nodiscard]] const double* output() const;

    mutable ChainDynamics dynamics_;  ///< its work space changes with every question
    bool conserves_energy_;
    std::vector<double> state_;               ///< of each chain at the end of its last step
    mutable std::vector<double> output_;      ///< at the last time asked for
    mutable bool output_is_complete_ = true;  ///< else rates and velocities are of an earlier time
    double output_s_ = 0.0;
    mutable std::vector<Mover> movers_;
};

}  // namespace corda::sim
