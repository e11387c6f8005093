#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "corda/sim/exact/dop853.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

/// Bounds of the steps for a motion of this inverse time scale (Dynamics::inverse_timescale_1_s) and
/// ExactDef::tolerance.
[[nodiscard]] StepControl step_control(double inverse_timescale_1_s, double tolerance);

/// Method `exact`: a body is integrated in the coordinates that suit it (section 3.5 of
/// src/corda/sim/README.md).
///
/// - Ropes of rigid links in the directions of the links (ChainDynamics), by Taylor series in time (ChainPart),
///   or by Dop853 if they are very long or resist bending.
/// - Closed ropes and nets of rigid bars in the rotations of the groups of bars that turn together
///   (NetDynamics), by Dop853.
/// - Bodies whose bars stretch in the positions of their particles (ElasticDynamics), by Dop853.
/// - Ropes, if ExactDef::implicit, in the angles and tensions of their links, by Radau IIA (ImplicitPart).
/// - Strings of rigid links from event to event (StringPart), by Dop853.
class Exact : public Solver {
  public:
    /// Requires one body. Throws corda::Refusal for imaginary bars of a rigid rope, for a rigid rope that
    /// is taut between two pins, and for what NetDynamics and StringPart refuse.
    [[nodiscard]] static std::unique_ptr<Exact> make(const System& system, const Forces& forces,
                                                     const ExactDef& def);

    // Facts about the method: see solver.cpp.
    static constexpr bool kKnowsTensions = true;
    [[nodiscard]] static const char* problem_of(const ExactDef& def);
    [[nodiscard]] static std::string text_of(const ExactDef& def);

    Status advance_to(double time_s, State& state) final;
    [[nodiscard]] double energy_j() const override { return dynamics().energy_j(output_.data()); }
    void velocities(State& state) override { dynamics().velocities(output_.data(), state); }
    [[nodiscard]] bool tensions(std::vector<double>& tension_n) override {
        dynamics().tensions(output_.data(), tension_n);
        return std::ranges::none_of(tension_n, [](double n) { return std::isnan(n); });
    }
    [[nodiscard]] std::vector<MethodDef> methods() const override { return {def_}; }

    /// Steps that were tried and were too long.
    [[nodiscard]] virtual std::uint64_t rejected_steps() const { return 0; }

  protected:
    Exact(const System& system, const Forces& forces, const ExactDef& def, std::vector<double> output = {});
    /// The equations of motion at the last requested time.
    [[nodiscard]] virtual Dynamics& dynamics() const = 0;
    /// Writes the positions at a time, sets that of dynamics(), and writes its state to output_.
    virtual Status reach(double time_s, State& state) = 0;

    std::vector<double> output_;  ///< state of dynamics() at the last requested time

  private:
    ExactDef def_;
};

/// A body whose equations of motion never change, integrated by Dop853.
class OdePart final : public Exact {
  public:
    OdePart(const System& system, const Forces& forces, std::unique_ptr<Dynamics> dynamics, double tolerance);

    [[nodiscard]] std::uint64_t steps() const override { return integrator_.accepted_steps(); }
    [[nodiscard]] std::uint64_t rejected_steps() const override { return integrator_.rejected_steps(); }

  private:
    [[nodiscard]] Dynamics& dynamics() const override { return *dynamics_; }
    Status reach(double time_s, State& state) override;

    std::unique_ptr<Dynamics> dynamics_;
    Dop853 integrator_;
};

}  // namespace corda::sim
