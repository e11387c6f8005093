#pragma once

#include <span>
#include <vector>

#include "corda/sim/elastic_forces.hpp"
#include "corda/sim/simulation.hpp"

namespace corda::sim {

/// The mechanical energy of free particles and of what joins them, in J.
struct Energy {
    double kinetic_j = 0.0;
    double weight_j = 0.0;   ///< of gravity or what is in its place, 0 at the origin of the system
    double elastic_j = 0.0;  ///< of bars that stretch and ropes that resist bending

    [[nodiscard]] double potential_j() const { return weight_j + elastic_j; }
};

/// Tells the energy of states.
class EnergyMeter {
  public:
    /// `methods`: one per body of the system, or one for all. The system must outlive it.
    EnergyMeter(const System& system, const WorldDef& world, std::span<const MethodDef> methods);

    /// Of a state with velocities.
    [[nodiscard]] Energy of(const State& state) const;

  private:
    const System* system_;
    std::vector<Vec2> weight_n_;  ///< on each particle
    ElasticForces elastic_;
};

}  // namespace corda::sim
