#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "corda/sim/exact_part.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

/// Every body moves by itself, at its own pace. Ropes of rigid links in the directions of these
/// (ChainDynamics), so that they keep their lengths whatever the error: by Taylor series in time (ChainPart)
/// or, where they are very long or resist bending, by an adaptive Runge-Kutta method of order 8 with
/// interpolation (Dop853). Bodies whose bars stretch move in the positions of their particles
/// (ElasticDynamics), by steps about as long as their fastest vibration is slow; strings of rigid links from
/// event to event (StringPart). The error of the positions, relative to the rope's length, is about
/// `SolverDef::tolerance` after some seconds; it goes on growing, in proportion to the time squared where a
/// rope swings and exponentially where its motion is chaotic.
///
/// A rope that stands exactly upright stays: nothing pushes it off.
class Exact final : public Solver {
  public:
    /// Throws corda::Error where rigid bars join particles that are not neighbours or are no chain, and for a
    /// rigid rope that is taut between two pins. `frame_interval_s` has
    /// no effect: steps follow the motion alone.
    Exact(const System& system, const WorldDef& world, const SolverDef& def, double frame_interval_s);

    Status advance_to(double time_s, State& state) override;
    [[nodiscard]] double energy_j() const override;
    [[nodiscard]] double energy_scale_j() const override;
    [[nodiscard]] bool conserves_energy() const override;
    [[nodiscard]] std::optional<Loads> loads() const override;
    /// Of all parts together: bodies that do not move as one take their own steps.
    [[nodiscard]] std::uint64_t steps() const override;

    /// Steps that were tried and found too long.
    [[nodiscard]] std::uint64_t rejected_steps() const;

  private:
    std::vector<std::unique_ptr<ExactPart>> parts_;
};

}  // namespace corda::sim
