#include "corda/scene/readers.hpp"

namespace corda::scene {

sim::WorldDef read_world(const TableReader& world) {
    constexpr std::string_view kGravity = "give a gravity in m/s2 downwards, or [gx, gy]";
    sim::WorldDef def;
    if (const auto gravity = world.find("gravity")) {
        // 0 - g and not -g: no gravity is +0.
        def.gravity_m_s2 = gravity->is_list() ? gravity->pair(kAnyNumber, kGravity)
                                              : sim::Vec2{0.0, 0.0 - gravity->number(kAnyNumber, kGravity)};
    }
    world.read_number("duration", def.duration_s, kPositive, "give a duration in s");
    world.read_number("drag", def.drag_1_s, kNotNegative, "give a drag in 1/s");
    return def;
}

}  // namespace corda::scene
