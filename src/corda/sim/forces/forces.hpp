#pragma once

#include <span>
#include <string>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// Acceleration of every free particle of velocity v by one force: uniform_m_s2 - drag_1_s v. Every solver
/// integrates forces of this form.
struct ForceTerm {
    Vec2 uniform_m_s2;
    double drag_1_s = 0.0;  ///< >= 0
};

/// One kind of force: a row of the table in forces.cpp.
struct ForceKind {
    ForceTerm (*term)(const WorldDef&);
    /// The field of the world that is out of its range, as "drag_1_s is not >= 0"; nullptr: none is.
    const char* (*problem)(const WorldDef&);
    /// The force in words, such as "linear drag of 0.3 1/s, exact"; empty to omit it.
    std::string (*text)(const WorldDef&);
};

/// All kinds of forces.
[[nodiscard]] std::span<const ForceKind> force_kinds();

/// The forces that act on every free particle: the sum of the terms of all kinds.
/// Together they accelerate a particle of velocity v by uniform_m_s2() - drag_1_s() v. Forces of bars and
/// bends are separate (see ElasticForces and the solvers).
class Forces {
  public:
    /// The forces of a world. Not explicit: a WorldDef may be passed for Forces.
    Forces(const WorldDef& world);
    explicit Forces(const ForceTerm& sum) : sum_(sum) {}

    /// Acceleration of a free particle without velocity.
    [[nodiscard]] Vec2 uniform_m_s2() const { return sum_.uniform_m_s2; }
    /// Absolute value of uniform_m_s2().
    [[nodiscard]] double strength_m_s2() const;
    [[nodiscard]] double drag_1_s() const { return sum_.drag_1_s; }
    [[nodiscard]] bool conserve_energy() const { return sum_.drag_1_s == 0.0; }

    /// Decay factor exp(-drag t) of a velocity after `time_s`; greater than 1 for a negative time. Uses only
    /// +, -, * and /, because the last bit of std::exp differs between C libraries.
    [[nodiscard]] double decay(double time_s) const;

    /// Inverse of the time in which a body of this length and speed moves by about its own length, in 1/s; 0
    /// if it does not move.
    [[nodiscard]] double inverse_timescale_1_s(double length_m, double speed_m_s) const;

    /// Potential energy per mass in J/kg; 0 at the origin.
    [[nodiscard]] double potential_j_kg(Vec2 position_m) const { return -dot(sum_.uniform_m_s2, position_m); }

    /// The force in newtons on each particle of a system without velocity; 0 for a pinned one.
    [[nodiscard]] std::vector<Vec2> on_particles(const System& system) const;

  private:
    ForceTerm sum_;
};

/// Denominator of the energy error: the sum over all bodies of the forces on their particles (see
/// Forces::on_particles) times the length along their links; 0 without a force.
[[nodiscard]] double energy_scale_j(const System& system, const std::vector<Vec2>& force_n);

}  // namespace corda::sim
