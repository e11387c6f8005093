#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "corda/sim/exact/exact_part.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

/// Method `exact`: a body is integrated in the coordinates that suit it.
///
/// - Ropes of rigid links in the directions of the links (ChainDynamics), so that lengths are kept whatever
///   the error is: by Taylor series in time (ChainPart), or by an adaptive Runge-Kutta method of order 8
///   (Dop853) if they are very long or resist bending.
/// - Bodies whose bars stretch in the positions of their particles (ElasticDynamics), by Dop853. Their
///   fastest vibration limits the steps.
/// - Strings of rigid links from event to event (StringPart), by Dop853.
///
/// The error of the positions, relative to the rope's length, is about `ExactDef::tolerance` after some
/// seconds. It grows with the square of the time while a rope swings, and exponentially while its motion is
/// chaotic.
///
/// A rope that stands exactly upright stays so: nothing pushes it off.
class Exact final : public Solver {
  public:
    /// Requires one body. Throws corda::Refusal for rigid bars that are imaginary or do not form an open
    /// chain, for a rigid rope that is taut between two pins, and for what StringPart refuses; and as a
    /// StopCheck if `goes_on` ends it.
    Exact(const System& system, const Forces& forces, const ExactDef& def, const GoesOn& goes_on = {});

    Status advance_to(double time_s, State& state, StopCheck& stop) override;
    [[nodiscard]] double energy_j() const override { return part_->energy_j(); }
    [[nodiscard]] std::optional<Loads> loads() const override { return part_->loads(); }
    void velocities(std::vector<double>& vx_m_s, std::vector<double>& vy_m_s) override {
        part_->velocities(vx_m_s, vy_m_s);
    }
    [[nodiscard]] bool tensions(std::vector<double>& tension_n) override {
        part_->tensions(tension_n);
        return true;
    }
    [[nodiscard]] std::uint64_t steps() const override { return part_->steps(); }
    [[nodiscard]] std::vector<MethodDef> methods() const override { return {def_}; }

    /// Steps that were tried and were too long.
    [[nodiscard]] std::uint64_t rejected_steps() const { return part_->rejected_steps(); }

  private:
    ExactDef def_;
    std::unique_ptr<ExactPart> part_;
};

}  // namespace corda::sim
