// Positions, velocities, energy and loads of the states of a ChainDynamics.

#include <algorithm>
#include <cmath>

#include "corda/sim/defs.hpp"
#include "corda/sim/exact/chain_dynamics.hpp"

namespace corda::sim {

template <class Visit>
void ChainDynamics::walk(const Chain& chain, const double* y, const Visit& visit) const {
    const std::size_t links = link_count();
    Vec2 moved;
    Vec2 velocity;
    if (!chain.starts_pinned) {
        const double* const extra = y + chain.first_extra;
        moved = {extra[0], extra[1]};
        velocity = {extra[2], extra[3]};
        visit(chain.first_particle, moved, velocity);
    }
    const std::size_t moving = chain.ends_pinned ? chain.link_count - 1 : chain.link_count;
    for (std::size_t i = 0; i < moving; ++i) {
        const std::size_t link = chain.first_link + i;
        const Vec2 direction{y[link], y[links + link]};
        moved = moved + length_m_[link] * direction;
        velocity = velocity + (length_m_[link] * y[2 * links + link]) * left_of(direction);
        visit(chain.particle(i), moved, velocity);
    }
}

void ChainDynamics::positions(const double* y, State& state) const {
    for (const Pin& pin : pins_) {
        state.x_m[pin.particle] = pin.position_m.x;
        state.y_m[pin.particle] = pin.position_m.y;
    }
    for (const Chain& chain : chains_) {
        walk(chain, y, [&](std::size_t particle, Vec2 moved, Vec2 /*velocity*/) {
            state.x_m[particle] = chain.start_m.x + moved.x;
            state.y_m[particle] = chain.start_m.y + moved.y;
        });
    }
}

void ChainDynamics::velocities(const double* y, std::vector<double>& vx_m_s,
                               std::vector<double>& vy_m_s) const {
    for (const Chain& chain : chains_) {
        walk(chain, y, [&](std::size_t particle, Vec2 /*moved*/, Vec2 velocity) {
            vx_m_s[particle] = velocity.x;
            vy_m_s[particle] = velocity.y;
        });
    }
}

double ChainDynamics::energy_j(const double* y) const {
    double energy_j = 0.0;
    for (const Chain& chain : chains_) {
        walk(chain, y, [&](std::size_t particle, Vec2 moved, Vec2 velocity) {
            energy_j += mass_kg_[particle] * (0.5 * dot(velocity, velocity) + forces_.potential_j_kg(moved));
        });
    }
    if (bends()) energy_j += bending_.energy_j(y);
    return energy_offset_j_ + energy_j;
}

void ChainDynamics::tensions(const double* y, std::vector<double>& tension_n) {
    find_all_tensions(y);
    tension_n.assign(links_.size() - 1, 0.0);
    for (std::size_t i = 0; i < tension_n.size(); ++i) {
        if (links_[i].moves) tension_n[i] = tension_n_[links_[i].index];
    }
}

Loads ChainDynamics::loads(const double* y) {
    const std::size_t links = link_count();
    Loads loads;
    for (Pin& pin : pins_) pin.force_n = {};
    // The force of a link on the particle at its near end, or with `end` = -1 on that at its far end.
    const auto add_pull = [&](std::size_t pin, double end, std::size_t link) {
        const Vec2 direction{y[link], y[links + link]};
        Vec2 pull_n = tension_n_[link] * direction;
        if (bends()) pull_n = pull_n - bending_.couple_n()[link] * left_of(direction);
        pins_[pin].force_n = pins_[pin].force_n + end * pull_n;
    };
    find_all_tensions(y);
    for (const Chain& chain : chains_) {
        const std::size_t first = chain.first_link;
        const std::size_t last = first + chain.link_count - 1;
        for (std::size_t i = first; i <= last; ++i) {
            loads.largest_tension_n = std::max(loads.largest_tension_n, std::abs(tension_n_[i]));
        }
        if (chain.starts_pinned) add_pull(chain.start_pin, 1.0, first);
        if (chain.ends_pinned) add_pull(chain.end_pin, -1.0, last);
    }
    if (bends()) add_clamp_forces();
    for (const Pin& pin : pins_) {
        loads.pin_force_n = std::max(loads.pin_force_n, length(pin.force_n.x, pin.force_n.y));
    }
    return loads;
}

void ChainDynamics::add_clamp_forces() {
    for (const ChainBending::Clamp& clamp : bending_.clamps()) {
        for (Pin& pin : pins_) {
            if (pin.particle == clamp.near) pin.force_n = pin.force_n - clamp.force_n;
            if (pin.particle == clamp.far) pin.force_n = pin.force_n + clamp.force_n;
        }
    }
}

}  // namespace corda::sim
