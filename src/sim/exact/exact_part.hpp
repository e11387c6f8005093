#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "corda/sim/exact/dop853.hpp"
#include "corda/sim/exact/dynamics.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

/// A body that method `exact` integrates with steps of its own.
class ExactPart {
  public:
    ExactPart() = default;
    ExactPart(const ExactPart&) = delete;
    ExactPart& operator=(const ExactPart&) = delete;
    virtual ~ExactPart() = default;

    /// Writes the positions of the body's particles at `time_s` to `state`; leaves the rest of it alone.
    virtual Status advance_to(double time_s, State& state, StopCheck& stop) = 0;

    // See Solver; of this body alone.
    [[nodiscard]] virtual double energy_j() const = 0;
    [[nodiscard]] virtual Loads loads() = 0;
    virtual void velocities(std::vector<double>& vx_m_s, std::vector<double>& vy_m_s) = 0;
    virtual void tensions(std::vector<double>& tension_n) = 0;
    [[nodiscard]] virtual std::uint64_t steps() const = 0;
    [[nodiscard]] virtual std::uint64_t rejected_steps() const = 0;
};

/// Bounds of the steps for a motion of this inverse time scale (Dynamics::inverse_timescale_1_s) and
/// ExactDef::tolerance.
[[nodiscard]] StepControl step_control(double inverse_timescale_1_s, double tolerance);

/// A body whose equations of motion never change, integrated by Dop853.
class OdePart final : public ExactPart {
  public:
    OdePart(std::unique_ptr<Dynamics> dynamics, double tolerance);

    Status advance_to(double time_s, State& state, StopCheck& stop) override;
    [[nodiscard]] double energy_j() const override { return dynamics_->energy_j(output_.data()); }
    [[nodiscard]] Loads loads() override { return dynamics_->loads(output_.data()); }
    void velocities(std::vector<double>& vx_m_s, std::vector<double>& vy_m_s) override {
        dynamics_->velocities(output_.data(), vx_m_s, vy_m_s);
    }
    void tensions(std::vector<double>& tension_n) override { dynamics_->tensions(output_.data(), tension_n); }
    [[nodiscard]] std::uint64_t steps() const override { return integrator_.accepted_steps(); }
    [[nodiscard]] std::uint64_t rejected_steps() const override { return integrator_.rejected_steps(); }

  private:
    std::unique_ptr<Dynamics> dynamics_;
    std::vector<double> output_;  ///< state at the last time asked for
    Dop853 integrator_;
};

}  // namespace corda::sim
