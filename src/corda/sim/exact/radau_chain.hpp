#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/exact.hpp"
#include "corda/sim/exact/radau_terms.hpp"

namespace corda::sim {

/// A chain from a pin to a free end or to another pin, integrated by implicit steps: section 12 of
/// src/corda/sim/exact/README.md.
///
/// Angles, angular velocities and tensions of the links obey local equations (a differential-algebraic system
/// of index 1), and a step solves them for all links together in O(n). Its length follows from the visible
/// motion alone: vibrations that are too fast for it and smaller than the tolerance are damped.
///
/// Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer 1996, IV.8
/// (Radau IIA of order 5, error estimate, step control) and VI.1 (algebraic equations).
struct RadauChain {
    static constexpr std::size_t kStages = 3;
    /// One entry per link from index 1 on, and zeros at both ends: link 0 is the pin.
    using Array = std::vector<double>;
    using Stages = std::array<Array, kStages>;

    std::size_t links = 0;
    std::size_t first_link = 0;
    std::size_t link_stride = 0;
    bool ends_pinned = false;
    std::array<Vec2, kStages> start_pull_m_s2 = {};  ///< the uniform acceleration at the stages, seen
    std::array<Vec2, kStages> end_pull_m_s2 = {};    ///< from the first pin and from the last
    double drag_1_s = 0.0;
    StepControl control = {};
    double tolerance_m = 0.0;  ///< of a step
    double chain_length_m = 0.0;

    double start_s = 0.0;  ///< of the last step
    double end_s = 0.0;
    double step_s = 0.0;       ///< to try next
    double last_step_s = 0.0;  ///< accepted; 0 before the first
    double last_error = 0.0;   ///< of the accepted step, in parts of the tolerance
    int iterations = 0;
    std::uint64_t steps = 0;
    std::uint64_t rejected_steps = 0;

    Array length_m;
    Array inverse_mass_1_kg;                           ///< of the particle at a link's far end
    Array c, s, omega, slope;                          ///< at the end of the last step: direction, w and w'
    Array old_c, old_s, old_omega, old_slope, turned;  ///< at its start, and the angles turned in it
    Array joint_c, joint_s;                            ///< cosine and sine from a link to the next one
    Stages turn, tension;                              ///< angles turned since the step's start, and tensions
    Stages old_turn, old_tension;                      ///< those of the last step
    Stages wc, ws;                                     ///< W C and W S of joints
    Array matrix_wc, matrix_ws, matrix_tension, matrix_omega;  ///< where the matrix was factorised
    Array across, along;                                       ///< right-hand sides, then solutions
    std::vector<radau::Complex> complex_across, complex_along;
    std::vector<radau::Pivot<double>> pivots;
    std::vector<radau::Pivot<radau::Complex>> complex_pivots;
};

/// A rope whose chains take implicit steps.
class ImplicitPart final : public Exact {
  public:
    /// True for a rope of rigid links with a pin that does not resist bending.
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
