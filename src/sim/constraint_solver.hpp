#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "corda/sim/system.hpp"
#include "corda/sim/vec2.hpp"

namespace corda::sim {

/// Positions and velocities, one entry a particle. A pinned particle's velocity is 0.
///
/// Each number is kept as an unrounded sum: the double nearest to it and the small rest that rounding took
/// off (Kahan's summation). A million short steps then lose no more than one: without the rests, order 8
/// drifts by 2.5e-17 of the energy a step, and R5's last row is off by 1e-8 in place of 1e-10.
struct Motion {
    std::vector<double> x_m;
    std::vector<double> y_m;
    std::vector<double> vx_m_s;
    std::vector<double> vy_m_s;
    std::vector<double> x_rest_m;
    std::vector<double> y_rest_m;
    std::vector<double> vx_rest_m_s;
    std::vector<double> vy_rest_m_s;

    /// The start of a system, with rests of 0.
    [[nodiscard]] static Motion start_of(const System& system);
};

/// sum + rest += change, with the rounding kept in `rest`.
inline void add_unrounded(double& sum, double& rest, double change) {
    const double wanted = change + rest;
    const double next = sum + wanted;
    rest = wanted - (next - sum);
    sum = next;
}

/// A rigid bar with at least one free end.
struct Link {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    double rest_m = 0.0;
};

/// One stage of a step: v <- decay v + push, then bar impulses along the bars as they lie, then x <- x + span
/// v, such that all bars end with their lengths.
struct Stage {
    double span_s = 0.0;  ///< not 0; negative where a composition goes backwards
    double decay = 1.0;
    Vec2 push_m_s;  ///< of every free particle
    /// Newton's method gives up where a bar turns by more than about 60 degrees in a stage: beyond that its
    /// linear equations say little, and beyond 90 degrees another solution is nearer.
    static constexpr double kSmallestTurnCosine = 0.5;
};

/// What keeps rigid bars at their lengths: the linear algebra of the `rope` method. An impulse of a bar is
/// given per length, N s / m: bar k, from a to b with the vector d, changes the velocity of a by impulse w_a
/// d and that of b by -impulse w_b d; positive pulls. One implementation for chains, one for any graph.
class ConstraintSolver {
  public:
    ConstraintSolver(const ConstraintSolver&) = delete;
    ConstraintSolver& operator=(const ConstraintSolver&) = delete;
    virtual ~ConstraintSolver() = default;

    /// Takes one stage. `impulse` has one entry a link: on entry a guess, on return the impulses. False where
    /// Newton's method does not converge; `motion` and `impulse` are then undefined.
    [[nodiscard]] virtual bool move(const Stage& stage, Motion& motion, std::span<double> impulse) = 0;

    /// Solves (G W G') z = right in place, G having the rows d_k . (v_b - v_a) at these positions and W the
    /// inverse masses. False where the matrix is singular.
    [[nodiscard]] virtual bool solve(const Motion& motion, std::span<double> right) = 0;

    /// A bound on the square of the largest frequency, 1 / s^2, of small motions about a state whose links
    /// carry `rate` (tension over length, N / m): Gershgorin's, the largest over all particles of 2 w sum
    /// |rate|.
    [[nodiscard]] virtual double square_frequency(std::span<const double> rate) const = 0;

    /// Mass in kg that hangs on each link where the system hangs down, at most: the one beyond it as seen
    /// from the pin; all of it between two pins or where that is not known; 0 without a pin.
    [[nodiscard]] virtual std::vector<double> carried_mass(std::span<const double> mass_kg) const = 0;

    /// Bars whose lengths are kept, in the order of `impulse`.
    [[nodiscard]] std::span<const Link> links() const { return links_; }

  protected:
    /// Keeps the rigid bars of a system that have a free end.
    explicit ConstraintSolver(const System& system);

    /// The first and the last part of a stage: the kick of all free particles, and the way.
    void kick(const Stage& stage, Motion& motion) const;
    static void drift(double span_s, Motion& motion);

    std::vector<Link> links_;
    std::vector<double> inverse_mass_1_kg_;
    std::vector<std::uint32_t> pinned_;
};

/// The solver that suits the rigid bars of a system: along chains where every bar joins a particle to the
/// next one, or there is none; else for a graph. Throws corda::Error where the lengths do not determine the
/// motion.
[[nodiscard]] std::unique_ptr<ConstraintSolver> make_constraint_solver(const System& system);

}  // namespace corda::sim
