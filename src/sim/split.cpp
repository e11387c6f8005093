#include "corda/sim/split.hpp"

#include <cstdint>
#include <vector>

#include "corda/sim/refusal.hpp"

namespace corda::sim {
namespace {

/// Copies `count` entries from `first` on.
template <class T>
std::vector<T> slice(const std::vector<T>& all, std::size_t first, std::size_t count) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
    return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

/// The body without its bends.
System alone(const System& system, const Body& body) {
    const std::size_t first = body.first_particle;
    const std::size_t count = body.particle_count;
    System part;
    part.origin_m = system.origin_m;
    part.x_m = slice(system.x_m, first, count);
    part.y_m = slice(system.y_m, first, count);
    part.vx_m_s = slice(system.vx_m_s, first, count);
    part.vy_m_s = slice(system.vy_m_s, first, count);
    part.mass_kg = slice(system.mass_kg, first, count);
    part.inverse_mass_1_kg = slice(system.inverse_mass_1_kg, first, count);
    part.bars = slice(system.bars, body.first_bar, body.bar_count);
    const auto shift = static_cast<std::uint32_t>(first);
    for (Bar& bar : part.bars) {
        bar.a -= shift;
        bar.b -= shift;
    }
    part.bodies = {body};
    part.bodies.front().first_particle = 0;
    part.bodies.front().first_bar = 0;
    return part;
}

}  // namespace

void for_each_body(const System& system, const std::function<void(const System&, std::size_t)>& use) {
    auto bend = system.bends.begin();  // in the order of bodies, as bars are
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
        const Body& body = system.bodies[i];
        System part = alone(system, body);
        const auto shift = static_cast<std::uint32_t>(body.first_particle);
        for (; bend != system.bends.end() && bend->b < body.first_particle + body.particle_count; ++bend)
            part.bends.push_back({bend->a - shift, bend->b - shift, bend->c - shift, bend->stiffness_n_m});
        try {
            use(part, i);
        } catch (const Refusal& refused) {
            if (system.bodies.size() == 1) throw;
            throw Refusal(refused.reason(), body_name(system, i) + ": " + refused.what());
        }
    }
}

}  // namespace corda::sim
