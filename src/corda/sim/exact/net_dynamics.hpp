#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "corda/sim/exact/dop853.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

class ConstraintSolver;

/// The rigid bars of a body that turn together: opposite sides of parallelograms, which stay parallel, and
/// sides of triangles. A parallelogram whose sides come into line could turn into another quadrilateral from
/// there; its motion stays smooth only if it remains one.
struct BarGroups {
    /// Inverse masses of 0 hold particles.
    BarGroups(const System& system, const std::vector<double>& inverse_mass_1_kg);

    std::size_t count = 0;
    std::vector<std::uint32_t> of_bar;  ///< group of each bar; `count` if it never turns
    std::vector<bool> is_held;          ///< particles that never move
};

/// One body of rigid bars in which bars turn together: opposite sides of parallelograms, and the sides of
/// triangles (section 3.5 of src/corda/sim/README.md); all that never changes. A grid of r x c particles
/// without diagonals has r + c - 2 such groups instead of 2 r c - r - c bars; a plate has one.
///
/// A state has one array each of c, s and w over the groups: group g has turned since the start by the angle
/// whose cosine and sine are c and s, and turns with the angular velocity w. Without a pin, the displacement
/// of the centre of mass from the start and its velocity (x, y, vx, vy) follow. Positions are sums of turned
/// bars along a tree from the pins, or from the first particle.
struct NetModel {
    /// A bar of the tree. `particle` is its far end; parents come first.
    struct Arm {
        std::uint32_t parent = 0;
        std::uint32_t particle = 0;
        std::size_t group = 0;  ///< `groups`: it never turns
        Vec2 along_m;           ///< at the start
    };

    System system;
    Forces forces;
    std::vector<double> mass_kg = {};  ///< 0 if held
    bool is_free = false;
    bool has_tensions = false;
    std::vector<Arm> arms = {};
    std::size_t groups = 0;
    double free_kg = 0.0;
    Vec2 center_m = {};  ///< of mass at the start, without a pin
    /// The sums over all particles i of m_i conj(b_ig) b_ih, as complex numbers, where b_ig is the sum of the
    /// arms of group g on the way to i; without a pin, b_i less their mean.
    std::vector<double> real_kg_m2 = {};
    std::vector<double> imaginary_kg_m2 = {};
    std::vector<Vec2> moment_kg_m = {};  ///< the sums of m_i b_ig
    std::vector<double> start = {};
    double inverse_timescale_1_s = 0.0;  ///< see Forces::inverse_timescale_1_s
};

/// The equations of the groups' angular accelerations in a state: a full symmetric matrix.
struct NetEquations {
    explicit NetEquations(std::size_t groups)
        : inertia_kg_m2(groups * groups), right(groups + 1), square_1_s2(groups) {}

    std::vector<double> inertia_kg_m2;  ///< the upper triangle
    std::vector<double> right;          ///< torques; after solve() angular accelerations
    std::vector<double> square_1_s2;    ///< of angular velocities
};

/// The motion of such a body.
class NetDynamics final : public Dynamics {
  public:
    /// Requires one body. Throws corda::Refusal (kRigidGraph) if the groups could not turn independently, if
    /// they are too many for a full matrix, if the body is in parts, or if it resists bending.
    NetDynamics(const System& system, const Forces& forces);
    ~NetDynamics() override;

    [[nodiscard]] const std::vector<double>& initial_state() const override { return net_.start; }
    /// As those of ChainDynamics.
    [[nodiscard]] std::vector<ErrorScale> error_scales() const override;
    [[nodiscard]] double inverse_timescale_1_s() const override { return net_.inverse_timescale_1_s; }
    void set_time(double time_s) override { net_.forces.set_time(time_s); }
    [[nodiscard]] double next_key_s(double time_s) const override { return net_.forces.next_key_s(time_s); }
    void derivative(const double* y, double* slope) override;
    /// Makes directions unit vectors.
    void project(double* y) override;
    void positions(const double* y, State& state) const override;
    [[nodiscard]] double energy_j(const double* y) const override;
    void velocities(const double* y, State& state) const override;
    /// NaN if bars depend on each other, because the distribution of the load is then arbitrary.
    void tensions(const double* y, std::vector<double>& tension_n) override;

  private:
    NetModel net_;
    NetEquations equations_;
    mutable State state_;                            ///< scratch
    std::unique_ptr<ConstraintSolver> constraints_;  ///< made by tensions()
};

}  // namespace corda::sim
