#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/exact.hpp"
#include "corda/sim/exact/radau_terms.hpp"

namespace corda::sim {

/// A chain that hangs from a pin, integrated by implicit steps: section 12 of src/corda/sim/exact/README.md.
///
/// Angles, angular velocities and tensions of the links obey local equations (a differential-algebraic system
/// of index 1), and a step solves them for all links together in O(n). Its length follows from the visible
/// motion alone: vibrations that are too fast for it and smaller than the tolerance are damped.
///
/// Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer 1996, IV.8
/// (Radau IIA of order 5, error estimate, step control) and VI.1 (algebraic equations).
class RadauChain {
  public:
    /// `chain`: one of `dynamics` that starts pinned and ends free. The start is the chain's part of the
    /// initial state.
    RadauChain(ChainDynamics& dynamics, const System& system, const Chain& chain, double tolerance);

    /// Takes one step.
    Status step();

    /// Writes the chain's part of the state at `time_s`, within the last step, to `y`.
    void interpolate(double time_s, double* y) const;

    [[nodiscard]] double end_s() const { return end_s_; }
    [[nodiscard]] std::uint64_t steps() const { return steps_; }
    [[nodiscard]] std::uint64_t rejected_steps() const { return rejected_; }

  private:
    static constexpr std::size_t kStages = 3;
    /// One entry per link from index 1 on, and zeros at both ends: link 0 is the pin.
    using Array = std::vector<double>;
    using Stages = std::array<Array, kStages>;

    void predict();
    [[nodiscard]] bool solve_stages();
    void find_residuals();
    void factorise();
    void solve();
    /// Returns the largest displacement in m of a particle by the correction at the end of the step; infinite
    /// if the stages cannot be used.
    [[nodiscard]] double correct();
    /// Estimated error of the step in m.
    [[nodiscard]] double error_m();
    /// Bound on the rate in 1/s at which compressed links buckle; 0 without compression. Steps resolve it,
    /// because an implicit method would damp it.
    [[nodiscard]] double buckling_1_s() const;
    /// Solves a step of step_s_. Returns the next step in parts of it; minus that, if it must be repeated.
    [[nodiscard]] double next_factor();
    void accept();
    /// Largest displacement of a particle if the links turn by these small angles.
    [[nodiscard]] double displacement_m(const Array& angle) const;
    [[nodiscard]] radau::Matrix matrix() const;

    std::size_t links_;
    std::size_t first_link_;
    std::size_t link_stride_;
    Vec2 pull_m_s2_;
    double drag_1_s_;
    StepControl control_;
    double tolerance_m_;  ///< of a step
    double chain_length_m_;

    double start_s_ = 0.0;  ///< of the last step
    double end_s_ = 0.0;
    double step_s_;             ///< to try next
    double last_step_s_ = 0.0;  ///< accepted; 0 before the first
    double last_error_ = 0.0;   ///< of the accepted step, in parts of the tolerance
    int iterations_ = 0;
    std::uint64_t steps_ = 0;
    std::uint64_t rejected_ = 0;

    Array length_m_;
    Array inverse_mass_1_kg_;      ///< of the particle at a link's far end
    Array c_, s_, omega_, slope_;  ///< at the end of the last step: direction, w and w'
    Array old_c_, old_s_, old_omega_, old_slope_, turned_;  ///< at its start, and the angles turned in it
    Array joint_c_, joint_s_;                               ///< cosine and sine from a link to the next one
    Stages turn_, tension_;          ///< angles turned since the step's start, and tensions
    Stages old_turn_, old_tension_;  ///< those of the last step
    Stages wc_, ws_;                 ///< W C and W S of joints
    Array matrix_wc_, matrix_ws_, matrix_tension_, matrix_omega_;  ///< where the matrix was factorised
    Array across_, along_;                                         ///< right-hand sides, then solutions
    std::vector<radau::Complex> complex_across_, complex_along_;
    std::vector<radau::Pivot<double>> pivots_;
    std::vector<radau::Pivot<radau::Complex>> complex_pivots_;
};

/// A rope whose chains take implicit steps.
class ImplicitPart final : public Exact {
  public:
    /// True for an open rope of rigid links with one pin that does not resist bending.
    [[nodiscard]] static bool can_move(const System& system, const Body& body);
    /// Requires one body. Throws corda::Refusal for a system that it cannot move.
    ImplicitPart(const System& system, const Forces& forces, const ExactDef& def);

    [[nodiscard]] std::uint64_t steps() const override;
    [[nodiscard]] std::uint64_t rejected_steps() const override;

  private:
    [[nodiscard]] Dynamics& dynamics() const override { return dynamics_; }
    Status reach(double time_s, State& state) override;

    mutable ChainDynamics dynamics_;  ///< only its scratch memory changes
    std::vector<RadauChain> chains_;
};

}  // namespace corda::sim
