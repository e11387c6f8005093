#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "corda/sim/dop853.hpp"
#include "corda/sim/dynamics.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

/// Bodies that method `exact` moves apart from all others, by steps of their own.
class ExactPart {
  public:
    ExactPart() = default;
    ExactPart(const ExactPart&) = delete;
    ExactPart& operator=(const ExactPart&) = delete;
    virtual ~ExactPart() = default;

    /// Writes the positions of its particles at `time_s` to `state`; leaves the others and the time alone.
    virtual Status advance_to(double time_s, State& state) = 0;

    // As of Solver, of these bodies alone.
    [[nodiscard]] virtual double energy_j() const = 0;
    [[nodiscard]] virtual double energy_scale_j() const = 0;
    [[nodiscard]] virtual bool conserves_energy() const = 0;
    [[nodiscard]] virtual Loads loads() const = 0;
    [[nodiscard]] virtual std::uint64_t steps() const = 0;
    [[nodiscard]] virtual std::uint64_t rejected_steps() const = 0;
};

/// Steps for a motion at this rate (Dynamics::largest_rate_1_s) and SolverDef::tolerance.
[[nodiscard]] StepControl step_control(double rate_1_s, double tolerance);

/// Bodies whose equations of motion are the same from the start to the end.
class OdePart final : public ExactPart {
  public:
    /// `conserves_energy`: no drag.
    OdePart(std::unique_ptr<Dynamics> dynamics, double tolerance, bool conserves_energy);

    Status advance_to(double time_s, State& state) override;
    [[nodiscard]] double energy_j() const override { return dynamics_->energy_j(output_.data()); }
    [[nodiscard]] double energy_scale_j() const override { return dynamics_->energy_scale_j(); }
    [[nodiscard]] bool conserves_energy() const override { return conserves_energy_; }
    [[nodiscard]] Loads loads() const override { return dynamics_->loads(output_.data()); }
    [[nodiscard]] std::uint64_t steps() const override { return integrator_.accepted_steps(); }
    [[nodiscard]] std::uint64_t rejected_steps() const override { return integrator_.rejected_steps(); }

  private:
    std::unique_ptr<Dynamics> dynamics_;
    bool conserves_energy_;
    std::vector<double> output_;  ///< state at the last time asked for
    Dop853 integrator_;
};

}  // namespace corda::sim
