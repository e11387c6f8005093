#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// Positions and velocities, one entry per particle.
///
/// Each number is an unrounded sum: a double, and the small part that rounding has removed from it (Kahan's
/// summation). A million short steps then lose no more than one. Without the lost parts, order 8 drifts
/// by 2.5e-17 of the energy per step, and R5's last row is off by 1e-8 instead of 1e-10.
struct Motion {
    std::vector<double> x_m;
    std::vector<double> y_m;
    std::vector<double> vx_m_s;
    std::vector<double> vy_m_s;
    std::vector<double> x_lost_m;
    std::vector<double> y_lost_m;
    std::vector<double> vx_lost_m_s;
    std::vector<double> vy_lost_m_s;

    [[nodiscard]] static Motion start_of(const System& system);
};

/// sum + lost += change, with the rounding kept in `lost`.
inline void add_unrounded(double& sum, double& lost, double change) {
    const double wanted = change + lost;
    const double next = sum + wanted;
    lost = wanted - (next - sum);
    sum = next;
}

/// A rigid bar with at least one free end.
struct Link {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    double rest_m = 0.0;
};

/// The rigid bars of a system with a free end, and the particles that they join. Inverse masses of 0 hold
/// particles.
struct RigidBars {
    RigidBars(const System& system, std::vector<double> inverse_mass_1_kg);

    std::vector<Link> links;
    std::vector<double> inverse_mass_1_kg;  ///< one per particle
    std::vector<std::uint32_t> held;        ///< the particles of inverse mass 0
};

/// The bars of a system whose tensions are those of the links, in their order. Requires that none is left
/// out.
[[nodiscard]] std::vector<std::size_t> bars_of_links(const System& system, const RigidBars& bars);

/// From the first particle of a link to the second: the vector d, and the relative velocity.
[[nodiscard]] inline Vec2 along(const Link& link, const Motion& motion) {
    return {motion.x_m[link.b] - motion.x_m[link.a], motion.y_m[link.b] - motion.y_m[link.a]};
}
[[nodiscard]] inline Vec2 apart(const Link& link, const Motion& motion) {
    return {motion.vx_m_s[link.b] - motion.vx_m_s[link.a], motion.vy_m_s[link.b] - motion.vy_m_s[link.a]};
}

/// One stage of a step: v <- decay v + push, then impulses along the current directions of the bars, then
/// x <- x + span v, such that all bars end with their rest lengths.
struct Stage {
    double span_s = 0.0;  ///< not 0; negative if a composition goes backwards
    double decay = 1.0;
    Vec2 push_m_s;                        ///< of every free particle
    std::span<const Vec2> held_m_s = {};  ///< velocities of RigidBars::held; none: 0
    /// Newton's method gives up if a bar turns by more than about 60 degrees in a stage: beyond that its
    /// linear equations are poor, and beyond 90 degrees another solution is nearer.
    static constexpr double kMinTurnCosine = 0.5;
};

/// Keeps rigid bars at their rest lengths: the linear algebra of method `rattle`. Impulses are per length, in
/// N s / m: bar k with the vector d from a to b changes the velocity of a by impulse w_a d and that of b by
/// -impulse w_b d; a positive impulse pulls. There is an implementation for chains and one for any graph.
class ConstraintSolver : NonCopyable {
  public:
    virtual ~ConstraintSolver() = default;

    /// Takes one stage. `impulse` has one entry per link: on entry a guess, on return the impulses. False if
    /// Newton's method does not converge; `motion` and `impulse` are then undefined.
    [[nodiscard]] virtual bool move(const Stage& stage, Motion& motion, std::span<double> impulse) = 0;

    /// True if the impulses of the last move() determine the tensions. For bars close to a line in which they
    /// depend on each other, the impulses are differences of second order over the angle to it.
    [[nodiscard]] virtual bool tells_tensions() const { return true; }

    /// How far these positions are from a line in which bars depend on each other: below 1, stages that start
    /// there are inaccurate or fail. The matrix is factorised for the next move() from there.
    [[nodiscard]] virtual double distance_from_line(const Motion& motion) {
        static_cast<void>(motion);
        return HUGE_VAL;
    }

    /// Advances by `span_s` where move() fails, usually because bars have come to depend on each other: to
    /// the positions nearest to x + span v, weighted with the masses, at which the bars have their lengths,
    /// and with the part of v that turns no bar into its length there. Of first order. False if there are
    /// none near.
    [[nodiscard]] virtual bool leap(double span_s, Motion& motion) {
        static_cast<void>(span_s), static_cast<void>(motion);
        return false;
    }

    /// Solves (G W G') z = right in place, where G has the rows d_k . (v_b - v_a) at these positions and W is
    /// the inverse masses. If bars depend on each other there, of least size in the directions left open.
    /// False if it cannot.
    [[nodiscard]] virtual bool solve(const Motion& motion, std::span<double> right) = 0;

    /// True if the bars of the last solve() did not depend on each other, so that it was of full rank.
    [[nodiscard]] virtual bool had_full_rank() const { return true; }

    /// The square of the largest angular frequency, 1 / s^2, of small motions about a state whose bars have
    /// these multipliers (tension over length, N / m), or a bound on it: Gershgorin's, the largest over all
    /// particles of 2 w sum |multiplier|.
    [[nodiscard]] virtual double square_frequency(std::span<const double> multiplier) const = 0;

    /// The same for expected states: those in which each bar carries this acceleration times the mass
    /// that may hang on it, and those with twice these multipliers.
    [[nodiscard]] virtual double expected_square_frequency(const System& system, double acceleration_m_s2,
                                                           std::span<const double> multiplier) const;

    /// The most mass in kg that hangs on each link when the system hangs down: the mass beyond the link as
    /// seen from the pin; all mass between two pins, or if it is not known; 0 without a pin.
    [[nodiscard]] virtual std::vector<double> carried_mass(std::span<const double> mass_kg) const = 0;

    /// True if the forces and the lengths determine every bar's tension. Bars that others imply could share
    /// the load in any way.
    [[nodiscard]] virtual bool determines_tensions() const { return true; }

    [[nodiscard]] virtual const RigidBars& bars() const = 0;

    /// The bars whose lengths are kept by impulses, in the order of `impulse`.
    [[nodiscard]] std::span<const Link> links() const { return bars().links; }
};

// Parts of move(): a stage begins with the change of all velocities and ends with the move.
void kick(const RigidBars& bars, const Stage& stage, Motion& motion);
void drift(double span_s, Motion& motion);

/// The right-hand side for ConstraintSolver::solve() whose solution is the tension over length, N / m, of
/// each link if this acceleration acts on all free particles. Drag does not enter: it is along the
/// velocities, whose differences are across the bars.
[[nodiscard]] std::vector<double> loads(const RigidBars& bars, const Motion& motion, Vec2 uniform_m_s2);

/// The solver that suits the rigid bars of a system: ChainConstraints if every bar joins a particle to the
/// next one, or if there is none; otherwise GraphConstraints. Throws corda::Refusal if the lengths do not
/// determine the motion.
[[nodiscard]] std::unique_ptr<ConstraintSolver> make_constraint_solver(const System& system);

/// The inverse masses of a system, 0 also for particles that can never move because they lie on a row of
/// rigid bars that is straight between two that cannot: the top row of a net between its pinned corners. To
/// first order the bars of such a row say nothing of its sideways motion, so a ConstraintSolver could not
/// keep it.
[[nodiscard]] std::vector<double> inverse_masses_with_taut_rows_held(const System& system);

/// How far such particles may move in truth, in m: an arch of a row by less than the root of rounding is not
/// seen in its length, and the row can fall through.
[[nodiscard]] double play_of_taut_rows_m(const System& system);

}  // namespace corda::sim
