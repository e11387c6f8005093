#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/radau_matrix.hpp"

namespace corda::sim {

/// A chain from a pin to a free end or to another pin, integrated by implicit steps: section 12 of
/// src/corda/sim/exact/README.md.
///
/// Angles, angular velocities and tensions of the links obey local equations (a differential-algebraic system
/// of index 1; for links that stretch, stiff differential equations), and a step solves them for all links
/// together in O(n). Its length follows from the visible motion alone: vibrations that are too fast for it
/// and smaller than the tolerance are damped.
///
/// Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer 1996, IV.8
/// (Radau IIA of order 5, error estimate, step control) and VI.1 (algebraic equations).
struct RadauChain {
    static constexpr std::size_t kStages = 3;
    /// One entry per link from index 1 on, and zeros at both ends: link 0 is the pin.
    using Array = std::vector<double>;
    using Stages = std::array<Array, kStages>;

    std::size_t links = 0;
    bool ends_pinned = false;
    bool stretches = false;
    std::array<Vec2, kStages> start_pull_m_s2 = {};  ///< the uniform acceleration at the stages, seen
    std::array<Vec2, kStages> end_pull_m_s2 = {};    ///< from the first pin and from the last
    double drag_1_s = 0.0;
    double tolerance_m = 0.0;  ///< of a step
    double chain_length_m = 0.0;

    double start_s = 0.0;  ///< of the last step
    double end_s = 0.0;
    double step_s = 0.0;          ///< to try next
    double longest_s = HUGE_VAL;  ///< to try, after a longer one that was not solved
    double last_step_s = 0.0;     ///< accepted; 0 before the first
    double last_error = 0.0;      ///< of the accepted step, in parts of the tolerance
    int iterations = 0;
    std::uint64_t steps = 0;
    std::uint64_t rejected_steps = 0;

    Array length_m;                                    ///< at rest
    Array inverse_mass_1_kg;                           ///< of the particle at a link's far end
    Array c, s, omega, slope;                          ///< at the end of the last step: direction, w and w'
    Array old_c, old_s, old_omega, old_slope, turned;  ///< at its start, and the angles turned in it
    Array joint_c, joint_s;                            ///< cosine and sine from a link to the next one
    Stages turn, tension;                              ///< angles turned since the step's start, and tensions
    Stages old_turn, old_tension;                      ///< those of the last step
    Stages wc, ws;                                     ///< W C and W S of joints
    Array matrix_wc, matrix_ws, matrix_tension, matrix_omega;  ///< where the matrix was factorised
    /// Right-hand sides, then solutions, of the real eigenvalue; real and imaginary parts of the complex one.
    Stages across, along;
    radau::Elimination<double, radau::Two> real_part;
    radau::Elimination<radau::Complex, radau::ComplexOf<radau::Two>> complex_part;

    // Of links that stretch; otherwise empty.
    Array stretch_m_n;                              ///< longer by this per newton
    Array pull, pull_rate, pull_slope;              ///< the tension at the end of the last step, T' and T''
    Array old_pull, old_pull_rate, old_pull_slope;  ///< at its start
    Array matrix_length, matrix_growth, matrix_turning;

    /// Gives each array of the chain's links its length.
    void resize(std::size_t link_count);
};

/// Finds the cosines and sines of the joints from the directions of the links.
void measure_joints(RadauChain& chain);

/// Solves a step of step_s. Returns the next step in parts of it; minus that, if it must be repeated.
[[nodiscard]] double try_step(RadauChain& chain);

/// Makes the step that was solved the last one. Joints are not measured.
void accept_step(RadauChain& chain);

/// Where the motion of links is written: one entry per link, the last two for links that stretch.
struct LinkMotion {
    double *c, *s, *omega;
    double *length_m, *growth_m_s;
};

/// Writes the motion of the links at `time_s`, within the last step.
void interpolate(RadauChain& chain, double time_s, const LinkMotion& to);

}  // namespace corda::sim
