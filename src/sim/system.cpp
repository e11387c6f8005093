#include "corda/sim/system.hpp"

#include <algorithm>
#include <cassert>

#include "corda/sim/distance.hpp"

namespace corda::sim {
namespace {

void append_particles(const RopeDef& rope, System& system) {
    const Vec2 offset = rope.origin_m - system.origin_m;
    const std::size_t first = system.particle_count();
    const std::size_t count = rope.points_m.size();
    for (std::size_t i = 0; i < count; ++i) {
        system.x_m.push_back(offset.x + rope.points_m[i].x);
        system.y_m.push_back(offset.y + rope.points_m[i].y);
        system.vx_m_s.push_back(rope.velocity_m_s[i].x);
        system.vy_m_s.push_back(rope.velocity_m_s[i].y);
        system.mass_kg.push_back(rope.mass_kg[i]);
    }
    system.mass_kg.back() += rope.payload_kg;
    for (std::size_t i = first; i < first + count; ++i)
        system.inverse_mass_1_kg.push_back(1.0 / system.mass_kg[i]);
    for (const std::uint32_t index : rope.pinned) {
        assert(index < count);
        system.inverse_mass_1_kg[first + index] = 0.0;
        system.vx_m_s[first + index] = 0.0;
        system.vy_m_s[first + index] = 0.0;
    }
}

void append_bars(const RopeDef& rope, std::size_t first_particle, std::size_t reach, System& system) {
    const std::size_t count = rope.points_m.size();
    for (std::size_t stride = 1; stride <= std::min(reach, count - 1); ++stride) {
        for (std::size_t i = 0; i + stride < count; ++i) {
            // Lengths from the rope's own coordinates: where the rope stands must not change them.
            const Vec2 along = rope.points_m[i + stride] - rope.points_m[i];
            system.bars.push_back({static_cast<std::uint32_t>(first_particle + i),
                                   static_cast<std::uint32_t>(first_particle + i + stride),
                                   static_cast<std::uint32_t>(stride), length(along.x, along.y)});
        }
    }
}

}  // namespace

std::size_t System::link_count() const {
    std::size_t count = 0;
    for (const RopeRange& rope : ropes) count += rope.link_count;
    return count;
}

std::uint64_t bar_count(std::uint64_t particles, std::uint64_t reach) {
    if (particles == 0) return 0;
    const std::uint64_t longest = std::min(reach, particles - 1);
    return longest * particles - longest * (longest + 1) / 2;
}

System build_system(std::span<const RopeDef> ropes, int reach) {
    assert(!ropes.empty() && reach >= 1);
    System system;
    system.origin_m = ropes.front().origin_m;
    for (const RopeDef& rope : ropes) {
        RopeRange range;
        range.first_particle = system.particle_count();
        range.first_bar = system.bars.size();
        range.particle_count = rope.points_m.size();
        range.link_count = range.particle_count - 1;
        append_particles(rope, system);
        append_bars(rope, range.first_particle, static_cast<std::size_t>(reach), system);
        range.bar_count = system.bars.size() - range.first_bar;
        system.ropes.push_back(range);
    }
    return system;
}

}  // namespace corda::sim
