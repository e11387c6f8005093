#pragma once

#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/forces/term.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// The forces that act on every free particle: the sum of the terms listed in forces.cpp, one file per term.
/// Together they accelerate a particle of velocity v by uniform_m_s2() - drag_1_s() v. What bars and bends do
/// is not among them (see ElasticForces and the solvers).
class Forces {
  public:
    /// The forces of a world. Not explicit: whoever takes Forces takes a WorldDef.
    Forces(const WorldDef& world);
    explicit Forces(const ForceTerm& sum) : sum_(sum) {}

    /// Acceleration of a free particle without velocity.
    [[nodiscard]] Vec2 uniform_m_s2() const { return sum_.uniform_m_s2; }
    /// Its size.
    [[nodiscard]] double strength_m_s2() const;
    [[nodiscard]] double drag_1_s() const { return sum_.drag_1_s; }
    [[nodiscard]] bool conserve_energy() const { return sum_.drag_1_s == 0.0; }

    /// The share of a velocity that drag leaves of it after `time_s`, exp(-drag t); more than 1 for a
    /// negative time. Only from +, -, * and /: the last bit of std::exp differs between C libraries.
    [[nodiscard]] double decay(double time_s) const;

    /// The inverse of the time in which something of this length and speed moves by about its own length, in
    /// 1/s; 0 if it does not move.
    [[nodiscard]] double inverse_timescale_1_s(double length_m, double speed_m_s) const;

    /// Potential energy per mass in J/kg; 0 at the origin.
    [[nodiscard]] double potential_j_kg(Vec2 position_m) const { return -dot(sum_.uniform_m_s2, position_m); }

    /// The force in newtons on each particle of a system without velocity; 0 for a pinned one.
    [[nodiscard]] std::vector<Vec2> on_particles(const System& system) const;

  private:
    ForceTerm sum_;
};

/// What an energy error is compared with: the sum over all bodies of the forces on their particles (see
/// Forces::on_particles) times the length along their links; 0 without a force.
[[nodiscard]] double energy_scale_j(const System& system, const std::vector<Vec2>& force_n);

}  // namespace corda::sim
