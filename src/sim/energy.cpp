#include "corda/sim/energy.hpp"

#include <variant>

#include "corda/sim/forces/forces.hpp"

namespace corda::sim {

EnergyMeter::EnergyMeter(const System& system, const WorldDef& world, std::span<const MethodDef> methods)
    : system_(&system),
      weight_n_(Forces(world).on_particles(system)),
      elastic_(system, 0, system.particle_count()) {
    for (std::size_t b = 0; b < system.bodies.size(); ++b) {
        const auto* relaxation = std::get_if<RelaxationDef>(&methods[methods.size() == 1 ? 0 : b]);
        if (relaxation == nullptr || !relaxation->force_n) continue;
        const Body& body = system.bodies[b];
        for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i)
            weight_n_[i] = *relaxation->force_n;
    }
}

Energy EnergyMeter::of(const State& state) const {
    Energy energy;
    for (std::size_t i = 0; i < system_->particle_count(); ++i) {
        if (system_->is_pinned(i)) continue;
        const double vx = state.vx_m_s[i];
        const double vy = state.vy_m_s[i];
        energy.kinetic_j += 0.5 * system_->mass_kg[i] * (vx * vx + vy * vy);
        energy.weight_j -= weight_n_[i].x * state.x_m[i] + weight_n_[i].y * state.y_m[i];
    }
    energy.elastic_j = elastic_.energy_j(state.x_m.data(), state.y_m.data());
    return energy;
}

}  // namespace corda::sim
