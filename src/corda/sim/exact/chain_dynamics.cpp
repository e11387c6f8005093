#include "corda/sim/exact/chain_dynamics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "corda/sim/chain_tensions.hpp"
#include "corda/sim/exact/chain_closing.hpp"
#include "corda/sim/moving_pins.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

double length_of(Vec2 a) {
    return length(a.x, a.y);
}

Vec2 at(const std::vector<double>& x, const std::vector<double>& y, std::size_t i) {
    return {x[i], y[i]};
}

// Numbers in parentheses are equations of src/corda/sim/exact/README.md.

/// Writes W C and W S of the joints of a chain.
void measure_joints(const Chains& chains, const Chain& chain, const double* y, ChainTensions& of) {
    const double* const c = y + chain.first_link;
    const double* const s = c + chains.link_count();
    const double* const inverse_mass = chains.inverse_mass_1_kg.data() + chain.first_link;
    double* __restrict const cosine = of.cosine.data() + chain.first_link;
    double* __restrict const sine = of.sine.data() + chain.first_link;
    for (std::size_t i = 0; i + 1 < chain.link_count; ++i) {
        cosine[i] = inverse_mass[i] * (c[i] * c[i + 1] + s[i] * s[i + 1]);
        sine[i] = inverse_mass[i] * (c[i] * s[i + 1] - s[i] * c[i + 1]);
    }
}

/// Solves (3) for the tensions of a chain.
void solve_tensions(const Chains& chains, const Chain& chain, ChainTensions& of) {
    const std::size_t first = chain.first_link;
    sim::solve_tensions({chain.link_count, chain.inverse_mass_1_kg, &chains.inverse_mass_1_kg[first],
                         &of.cosine[first], &of.sine[first]},
                        &of.along[first], &of.pivot[first], &of.weight[first], &of.tension_n[first]);
}

/// The terms of (4) with the tensions of a link's neighbours; the link is counted from the chain's first one.
double pull_across(const Chain& chain, const ChainTensions& of, std::size_t link) {
    const std::size_t i = chain.first_link + link;
    const double after = link + 1 < chain.link_count ? of.sine[i] * of.tension_n[i + 1] : 0.0;
    const double before = link > 0 ? of.sine[i - 1] * of.tension_n[i - 1] : 0.0;
    return after - before;
}

/// Finds the tensions of a chain with links by (3). kBends: with the couples of bending, which have been
/// found; a parameter, so that loops have no branch.
template <bool kBends>
void find_tensions(const Chains& chains, const Chain& chain, const double* y, ChainTensions& of) {
    const std::size_t first = chain.first_link;
    const std::size_t last = first + chain.link_count - 1;
    measure_joints(chains, chain, y, of);
    const double* const s = y + chains.link_count();
    const double* const omega = s + chains.link_count();
    const double* const length = chains.length_m.data();
    double* __restrict const along = of.along.data();
    for (std::size_t i = first; i <= last; ++i) along[i] = length[i] * (omega[i] * omega[i]);
    if (chain.starts_pinned)
        along[first] += dot(chains.forces_at_start(chain).uniform_m_s2(), {y[first], s[first]});
    if (chain.ends_pinned) along[last] -= dot(chains.forces_at_end(chain).uniform_m_s2(), {y[last], s[last]});
    if constexpr (kBends) {
        const std::vector<double>& couple = chains.bending.couple_n();
        for (std::size_t i = first; i < last; ++i) {
            along[i] += of.sine[i] * couple[i + 1];
            along[i + 1] -= of.sine[i] * couple[i];
        }
    }
    solve_tensions(chains, chain, of);
}

/// Writes the angular accelerations of a chain with links, whose tensions have been found, by (4).
template <bool kBends>
void accelerate(const Chains& chains, const Chain& chain, const double* y, const ChainTensions& of,
                double* __restrict slope_omega) {
    const double* const c = y;
    const double* const s = c + chains.link_count();
    const double* const omega = s + chains.link_count();
    const double* const inverse_length = chains.inverse_length_1_m.data();
    const double* const sine = of.sine.data();
    const double* const tension = of.tension_n.data();
    const double drag_1_s = chains.forces.drag_1_s();
    const std::size_t first = chain.first_link;
    const std::size_t last = first + chain.link_count - 1;
    const auto turn_link = [&](std::size_t i, double across) {
        slope_omega[i] = across * inverse_length[i] - drag_1_s * omega[i];
    };
    for (std::size_t i = first + 1; i < last; ++i) {
        turn_link(i, sine[i] * tension[i + 1] - sine[i - 1] * tension[i - 1]);
    }
    turn_link(first, pull_across(chain, of, 0));
    turn_link(last, pull_across(chain, of, chain.link_count - 1));
    if (chain.starts_pinned)
        slope_omega[first] +=
            dot(chains.forces_at_start(chain).uniform_m_s2(), left_of({c[first], s[first]})) *
            inverse_length[first];
    if (chain.ends_pinned)
        slope_omega[last] -= dot(chains.forces_at_end(chain).uniform_m_s2(), left_of({c[last], s[last]})) *
                             inverse_length[last];
    if constexpr (kBends) {
        const std::vector<double>& couple = chains.bending.couple_n();
        const std::vector<double>& inverse_mass = chains.inverse_mass_1_kg;
        for (std::size_t i = first; i <= last; ++i) {
            const double near_1_kg = i == first ? chain.inverse_mass_1_kg : inverse_mass[i - 1];
            const double before = i == first ? 0.0 : of.cosine[i - 1] * couple[i - 1];
            const double after = i == last ? 0.0 : of.cosine[i] * couple[i + 1];
            slope_omega[i] +=
                ((near_1_kg + inverse_mass[i]) * couple[i] - after - before) * inverse_length[i];
        }
    }
}

/// The derivative of a state: (4) to (6).
template <bool kBends>
void evaluate(const Chains& chains, const double* y, ChainTensions& of, double* slope) {
    const std::size_t links = chains.link_count();
    const Vec2 uniform_m_s2 = chains.forces.uniform_m_s2();
    const double drag_1_s = chains.forces.drag_1_s();
    const double* const c = y;
    const double* const s = y + links;
    const double* const omega = y + 2 * links;
    double* __restrict const slope_c = slope;
    double* __restrict const slope_s = slope + links;
    for (std::size_t i = 0; i < links; ++i) {
        slope_c[i] = -(omega[i] * s[i]);
        slope_s[i] = omega[i] * c[i];
    }
    for (const Chain& chain : chains.list) {
        if (chain.link_count > 0) {
            find_tensions<kBends>(chains, chain, y, of);
            accelerate<kBends>(chains, chain, y, of, slope + 2 * links);
        }
        if (chain.starts_pinned) continue;
        const double* const extra = y + chain.first_extra;
        double* const slope_extra = slope + chain.first_extra;
        std::copy_n(extra + 2, 2, slope_extra);
        slope_extra[2] = uniform_m_s2.x - drag_1_s * extra[2];
        slope_extra[3] = uniform_m_s2.y - drag_1_s * extra[3];
    }
}

/// Calls visit(particle, displacement from where the chain starts at t = 0, velocity) for each free particle
/// of a chain.
template <class Visit>
void walk(const Chains& chains, const Chain& chain, double time_s, const double* y, const Visit& visit) {
    const std::size_t links = chains.link_count();
    const auto along = [&](std::size_t link) {
        return chains.length_m[link] * Vec2{y[link], y[links + link]};
    };
    const auto turning = [&](std::size_t link) {
        return (chains.length_m[link] * y[2 * links + link]) * left_of({y[link], y[links + link]});
    };
    Vec2 moved;
    Vec2 velocity;
    if (chain.starts_pinned) {
        moved = chains.pins[chain.start_pin].displacement(time_s);
        velocity = chains.pins[chain.start_pin].velocity(time_s);
    } else {
        moved = {y[chain.first_extra], y[chain.first_extra + 1]};
        velocity = {y[chain.first_extra + 2], y[chain.first_extra + 3]};
        for (std::size_t i = chain.first_link; i < chain.first_link + chain.link_count; ++i) {
            moved = moved - chains.beyond[i] * along(i);
            velocity = velocity - chains.beyond[i] * turning(i);
        }
        visit(chain.first_particle, moved, velocity);
    }
    const std::size_t moving = chain.ends_pinned ? chain.link_count - 1 : chain.link_count;
    for (std::size_t i = 0; i < moving; ++i) {
        moved = moved + along(chain.first_link + i);
        velocity = velocity + turning(chain.first_link + i);
        visit(chain.particle(i), moved, velocity);
    }
}

std::size_t pin_at(const Chains& chains, std::size_t particle) {
    std::size_t k = chains.pins.size();
    while (chains.pins[--k].particle != particle) continue;
    return k;
}

void add_chain(Chains& chains, const System& system, const Body& body, std::size_t from, std::size_t to) {
    Chain chain;
    chain.first_link = chains.length_m.size();
    chain.runs_backwards = to < from;
    chain.link_count = chain.runs_backwards ? from - to : to - from;
    chain.first_particle = from;
    chain.ring = body.is_chain ? 0 : body.particle_count;
    if (chain.ring > 0) to %= chain.ring;
    chain.starts_pinned = system.is_pinned(from);
    chain.ends_pinned = system.is_pinned(to);
    if (chain.starts_pinned && chain.ends_pinned && chain.link_count == 1) return;  // it never moves
    if (chain.starts_pinned) chain.start_pin = pin_at(chains, from);
    if (chain.ends_pinned) chain.end_pin = pin_at(chains, to);
    chain.start_m = at(system.x_m, system.y_m, from);
    chain.span_m = at(system.x_m, system.y_m, to) - chain.start_m;
    chain.inverse_mass_1_kg = system.inverse_mass_1_kg[from];
    if (!chain.starts_pinned)
        chains.energy_offset_j += chains.mass_kg[from] * chains.forces.potential_j_kg(chain.start_m);
    double fastest_m_s = length_of(at(system.vx_m_s, system.vy_m_s, from));
    for (std::size_t i = 0; i < chain.link_count; ++i) {
        const std::size_t particle = chain.particle(i);
        const std::size_t before = chain.lower_particle(i);
        chains.links[before] = {chains.length_m.size(), chain.runs_backwards, true};
        chains.length_m.push_back(system.bars[body.first_bar + before - body.first_particle].rest_m);
        chains.inverse_length_1_m.push_back(1.0 / chains.length_m.back());
        chains.inverse_mass_1_kg.push_back(system.inverse_mass_1_kg[particle]);
        chain.length_m += chains.length_m.back();
        fastest_m_s = std::max(fastest_m_s, length_of(at(system.vx_m_s, system.vy_m_s, particle)));
        chains.energy_offset_j += chains.mass_kg[particle] * chains.forces.potential_j_kg(chain.start_m);
    }
    for (const Forces* const forces : {&chains.forces_at_start(chain), &chains.forces_at_end(chain)})
        chain.inverse_timescale_1_s =
            std::max(chain.inverse_timescale_1_s, forces->inverse_timescale_1_s(chain.length_m, fastest_m_s));
    if (chain.starts_pinned && chain.ends_pinned && body.material.compliance_1_n == 0.0)
        refuse_taut_between_pins(chain.length_m, chain.span_m, from, to);
    chains.list.push_back(chain);
}

/// Cuts a rope from each pin to the next, and from an end to its pin; a closed one round to its first pin.
void add_body(Chains& chains, const System& system, const Body& body, std::span<const MovingPin> moving) {
    const std::size_t first = body.first_particle;
    const std::size_t end = first + body.particle_count;
    std::optional<std::size_t> last;
    for (std::size_t i = first; i < end; ++i) {
        if (!system.is_pinned(i)) continue;
        chains.mass_kg[i] = 0.0;
        chains.pins.push_back({i, at(system.x_m, system.y_m, i), {}, {}, chains.forces});
        if (const auto pin = std::ranges::find(moving, i, &MovingPin::particle); pin != moving.end()) {
            chains.pins.back().displacement = pin->displacement;
            chains.pins.back().velocity = pin->velocity;
            chains.pins.back().forces = chains.forces.seen_from(pin->displacement);
        }
        if (last || (i > first && body.is_chain))
            add_chain(chains, system, body, last ? *last : i, last ? i : first);
        last = i;
    }
    if (!body.is_chain)
        add_chain(chains, system, body, *last, body.particle_count + chains.pins.front().particle);
    else if (!last || *last < end - 1)
        add_chain(chains, system, body, last.value_or(first), end - 1);
}

void set_timescales(Chains& chains) {
    double fastest_1_s = 0.0;
    for (Chain& chain : chains.list) {
        if (!chains.bending.empty()) {
            double rigidity_n_m2 = 0.0;
            double mass_kg = chain.starts_pinned ? 0.0 : chains.mass_kg[chain.first_particle];
            for (std::size_t i = 0; i < chain.link_count; ++i) {
                rigidity_n_m2 = std::max(rigidity_n_m2, chains.bending.rigidity_n_m2(chain.first_link + i));
                mass_kg += chains.mass_kg[chain.particle(i)];
            }
            // The slowest vibration of an elastic bar is faster by a factor of 3.5 (clamped) to 22 (free).
            const double volume_m3 = chain.length_m * chain.length_m * chain.length_m;
            chain.inverse_timescale_1_s =
                std::max(chain.inverse_timescale_1_s, std::sqrt(rigidity_n_m2 / (mass_kg * volume_m3)));
        }
        if (chain.inverse_timescale_1_s == 0.0) chain.inverse_timescale_1_s = 1.0;
        fastest_1_s = std::max(fastest_1_s, chain.inverse_timescale_1_s);
    }
    if (fastest_1_s > 0.0) chains.inverse_timescale_1_s = fastest_1_s;
}

/// Finds the masses beyond the links of a chain without a pin, and the start of its centre of mass. Requires
/// the directions and the angular velocities.
void start_center_of_mass(Chains& chains, const System& system, const Chain& chain) {
    double mass_kg = 0.0;
    Vec2 momentum_n_s;
    for (std::size_t i = chain.link_count + 1; i-- > 0;) {
        const std::size_t particle = i == 0 ? chain.first_particle : chain.particle(i - 1);
        mass_kg += chains.mass_kg[particle];
        momentum_n_s = momentum_n_s + chains.mass_kg[particle] * at(system.vx_m_s, system.vy_m_s, particle);
        if (i > 0) chains.beyond[chain.first_link + i - 1] = mass_kg;
    }
    for (std::size_t i = 0; i < chain.link_count; ++i) chains.beyond[chain.first_link + i] /= mass_kg;
    double* const extra = chains.start.data() + chain.first_extra;
    walk(chains, chain, 0.0, chains.start.data(), [&](std::size_t particle, Vec2 moved, Vec2 /*velocity*/) {
        if (particle == chain.first_particle) extra[0] = -moved.x, extra[1] = -moved.y;
    });
    extra[2] = momentum_n_s.x / mass_kg;
    extra[3] = momentum_n_s.y / mass_kg;
}

/// Makes directions unit vectors and closes chains between two pins.
void project_chains(const Chains& chains, double time_s, double* y) {
    make_unit_vectors(chains.link_count(), y);
    for (const Chain& chain : chains.list) {
        if (chain.starts_pinned && chain.ends_pinned) close_between_pins(chains, chain, time_s, y);
    }
}

/// Sets the state at t = 0.
void set_start(Chains& chains, const System& system) {
    const std::size_t links = chains.link_count();
    chains.beyond.assign(links, 0.0);
    chains.start.assign(3 * links, 0.0);
    for (Chain& chain : chains.list) {
        if (chain.starts_pinned) continue;
        chain.first_extra = chains.start.size();
        chains.start.resize(chain.first_extra + 4);
    }
    double* const y = chains.start.data();
    double* const omega = y + 2 * links;
    ChainTensions impulses(links);  // they obey (3), with velocities in place of accelerations
    for (const Chain& chain : chains.list) {
        std::size_t before = chain.first_particle;
        for (std::size_t i = 0; i < chain.link_count; ++i) {
            const std::size_t link = chain.first_link + i;
            const std::size_t after = chain.particle(i);
            const Vec2 along = at(system.x_m, system.y_m, after) - at(system.x_m, system.y_m, before);
            const double distance_m = length_of(along);
            assert(distance_m > 0.0);
            const Vec2 direction{along.x / distance_m, along.y / distance_m};
            y[link] = direction.x;
            y[links + link] = direction.y;
            const Vec2 apart =
                at(system.vx_m_s, system.vy_m_s, after) - at(system.vx_m_s, system.vy_m_s, before);
            impulses.along[link] = dot(direction, apart);
            omega[link] = dot(left_of(direction), apart);
            before = after;
        }
        measure_joints(chains, chain, y, impulses);
        solve_tensions(chains, chain, impulses);
        for (std::size_t i = 0; i < chain.link_count; ++i) {
            const std::size_t link = chain.first_link + i;
            omega[link] = (omega[link] + pull_across(chain, impulses, i)) * chains.inverse_length_1_m[link];
        }
        if (!chain.starts_pinned) start_center_of_mass(chains, system, chain);
    }
    project_chains(chains, 0.0, y);
}

}  // namespace

Chains cut_at_pins(const System& system, std::span<const Body> bodies, const Forces& forces) {
    Chains chains{.forces = forces, .mass_kg = system.mass_kg};
    chains.links.resize(system.particle_count());
    chains.are_of_ring = !bodies.empty() && !bodies.front().is_chain;
    const std::vector<MovingPin> moving = moving_pins(system);
    for (const Body& body : bodies) {
        assert(moves_as_chains(system, body));
        add_body(chains, system, body, moving);
    }
    chains.bending = ChainBending(system, chains.links, chains.length_m);
    set_timescales(chains);
    return chains;
}

Chains make_chains(const System& system, std::span<const Body> bodies, const Forces& forces) {
    Chains chains = cut_at_pins(system, bodies, forces);
    set_start(chains, system);
    return chains;
}

void add_particle(Chains& chains, const System& system, std::size_t particle, double length_m) {
    Chain chain;
    chain.first_link = chains.link_count();
    chain.first_particle = particle;
    chain.starts_pinned = false;
    chain.first_extra = chains.start.size();
    chain.start_m = at(system.x_m, system.y_m, particle);
    chain.inverse_mass_1_kg = system.inverse_mass_1_kg[particle];
    chain.length_m = length_m;
    chain.inverse_timescale_1_s = chains.inverse_timescale_1_s;
    chains.list.push_back(chain);
    chains.start.insert(chains.start.end(), {0.0, 0.0, system.vx_m_s[particle], system.vy_m_s[particle]});
    chains.energy_offset_j += chains.mass_kg[particle] * chains.forces.potential_j_kg(chain.start_m);
}

ChainDynamics::ChainDynamics(Chains chains) : chains_(std::move(chains)), scratch_(chains_.link_count()) {}

void ChainDynamics::set_time(double time_s) {
    time_s_ = time_s;
    chains_.forces.set_time(time_s);
    for (Chains::Pin& pin : chains_.pins) pin.forces.set_time(time_s);
}

double ChainDynamics::next_key_s(double time_s) const {
    double next_s = chains_.forces.next_key_s(time_s);
    for (const Chains::Pin& pin : chains_.pins) next_s = std::min(next_s, pin.forces.next_key_s(time_s));
    return next_s;
}

void ChainDynamics::derivative(const double* y, double* slope) {
    if (chains_.bending.empty()) {
        evaluate<false>(chains_, y, scratch_, slope);
    } else {
        chains_.bending.find_couples(y);
        evaluate<true>(chains_, y, scratch_, slope);
    }
}

void ChainDynamics::project(double* y) {
    project_chains(chains_, time_s_, y);
}

std::vector<ErrorScale> ChainDynamics::error_scales() const {
    std::vector<ErrorScale> scales;
    const std::size_t links = chains_.link_count();
    scales.push_back({0, 2 * links, 1.0, 0.0});
    for (const Chain& chain : chains_.list) {
        scales.push_back({2 * links + chain.first_link, chain.link_count, chain.inverse_timescale_1_s, 1.0});
        if (chain.starts_pinned) continue;
        scales.push_back({chain.first_extra, 2, chain.length_m, 0.0});
        scales.push_back({chain.first_extra + 2, 2, chain.length_m * chain.inverse_timescale_1_s, 1.0});
    }
    return scales;
}

void ChainDynamics::positions(const double* y, State& state) const {
    for (const Chains::Pin& pin : chains_.pins) {
        const Vec2 place = pin.position_m + pin.displacement(time_s_);
        state.x_m[pin.particle] = place.x;
        state.y_m[pin.particle] = place.y;
    }
    for (const Chain& chain : chains_.list) {
        walk(chains_, chain, time_s_, y, [&](std::size_t particle, Vec2 moved, Vec2 /*velocity*/) {
            state.x_m[particle] = chain.start_m.x + moved.x;
            state.y_m[particle] = chain.start_m.y + moved.y;
        });
    }
}

void ChainDynamics::velocities(const double* y, State& state) const {
    for (const Chains::Pin& pin : chains_.pins) {
        const Vec2 velocity = pin.velocity(time_s_);
        state.vx_m_s[pin.particle] = velocity.x;
        state.vy_m_s[pin.particle] = velocity.y;
    }
    for (const Chain& chain : chains_.list) {
        walk(chains_, chain, time_s_, y, [&](std::size_t particle, Vec2 /*moved*/, Vec2 velocity) {
            state.vx_m_s[particle] = velocity.x;
            state.vy_m_s[particle] = velocity.y;
        });
    }
}

double ChainDynamics::energy_j(const double* y) const {
    double energy_j = 0.0;
    for (const Chain& chain : chains_.list) {
        walk(chains_, chain, time_s_, y, [&](std::size_t particle, Vec2 moved, Vec2 velocity) {
            energy_j += chains_.mass_kg[particle] *
                        (0.5 * dot(velocity, velocity) + chains_.forces.potential_j_kg(moved));
        });
    }
    if (!chains_.bending.empty()) energy_j += chains_.bending.energy_j(y);
    return chains_.energy_offset_j + energy_j;
}

void ChainDynamics::tensions(const double* y, std::vector<double>& tension_n) {
    const bool bends = !chains_.bending.empty();
    if (bends) chains_.bending.find_couples(y);
    for (const Chain& chain : chains_.list) {
        if (chain.link_count == 0) continue;
        (bends ? find_tensions<true> : find_tensions<false>)(chains_, chain, y, scratch_);
    }
    tension_n.assign(chains_.links.size() - (chains_.are_of_ring ? 0 : 1), 0.0);
    for (std::size_t i = 0; i < tension_n.size(); ++i)
        if (chains_.links[i].moves) tension_n[i] = scratch_.tension_n[chains_.links[i].index];
}

}  // namespace corda::sim
