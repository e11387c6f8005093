#include "corda/sim/validate.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "corda/sim/forces/forces.hpp"

namespace corda::sim {
namespace {

[[noreturn]] void fail(const std::string& what, const std::string& problem) {
    throw Refusal(Refusal::Reason::kDefinition, what + ": " + problem);
}

void require(bool holds, const std::string& what, const char* problem) {
    if (!holds) fail(what, problem);
}

bool is_finite(Vec2 v) {
    return std::isfinite(v.x) && std::isfinite(v.y);
}

bool is_positive(double value) {
    return value > 0.0 && std::isfinite(value);
}

/// Checks the fields common to ropes and nets.
template <class BodyDef>
void validate_body(const BodyDef& def, const std::string& what) {
    const std::size_t count = def.points_m.size();
    require(count >= 2, what, "points_m has fewer than 2 points");
    require(is_finite(def.origin_m), what, "origin_m is not finite");
    require(std::all_of(def.points_m.begin(), def.points_m.end(), is_finite), what,
            "points_m has a point that is not finite");
    require(def.mass_kg.empty() || def.mass_kg.size() == count, what,
            "mass_kg needs one value per particle, or none");
    require(std::all_of(def.mass_kg.begin(), def.mass_kg.end(), is_positive), what,
            "mass_kg has a value that is not > 0");
    require(def.velocity_m_s.empty() || def.velocity_m_s.size() == count, what,
            "velocity_m_s needs one value per particle, or none");
    require(std::all_of(def.velocity_m_s.begin(), def.velocity_m_s.end(), is_finite), what,
            "velocity_m_s has a value that is not finite");
    for (const std::uint32_t index : def.pinned)
        if (index >= count)
            fail(what, "pinned names particle " + std::to_string(index) + " of " + std::to_string(count));
    const double compliance = def.material.compliance_1_n;
    require(compliance >= 0.0 && std::isfinite(compliance), what, "material.compliance_1_n is not >= 0");
}

void validate_rope(const RopeDef& rope, const std::string& what) {
    validate_body(rope, what);
    const std::size_t count = rope.points_m.size();
    require(rope.reach >= 1, what, "reach is not >= 1");
    require(!rope.closed || count >= 3, what, "closed needs at least 3 points");
    require(rope.payload_kg >= 0.0 && std::isfinite(rope.payload_kg), what, "payload_kg is not >= 0");
    require(rope.bending_n_m2 >= 0.0 && std::isfinite(rope.bending_n_m2), what, "bending_n_m2 is not >= 0");
    const std::size_t links = rope.closed ? count : count - 1;
    require(rope.rest_m.empty() || rope.rest_m.size() == links, what,
            "rest_m needs one value per link, or none");
    require(std::all_of(rope.rest_m.begin(), rope.rest_m.end(), is_positive), what,
            "rest_m has a value that is not > 0");
}

void validate_net(const NetDef& net, const std::string& what) {
    validate_body(net, what);
    const std::size_t count = net.points_m.size();
    bool imaginary_ones_follow = false;
    for (const NetBar& bar : net.bars) {
        if (bar.a >= count || bar.b >= count || bar.a == bar.b)
            fail(what, "the bar (" + std::to_string(bar.a) + ", " + std::to_string(bar.b) +
                           ") does not join two particles");
        require(!(bar.is_real && imaginary_ones_follow), what, "bars has a real bar behind an imaginary one");
        imaginary_ones_follow = imaginary_ones_follow || !bar.is_real;
    }
}

}  // namespace

void validate(std::span<const RopeDef> ropes, std::span<const NetDef> nets) {
    if (ropes.empty() && nets.empty()) fail("scene", "there is neither a rope nor a net");
    for (std::size_t i = 0; i < ropes.size(); ++i) validate_rope(ropes[i], "rope " + std::to_string(i));
    for (std::size_t i = 0; i < nets.size(); ++i) validate_net(nets[i], "net " + std::to_string(i));
}

void validate(const WorldDef& world) {
    require(is_positive(world.duration_s), "world", "duration_s is not > 0");
    for (const ForceKind& kind : force_kinds()) {
        if (const char* const problem = kind.problem(world)) fail("world", problem);
    }
}

}  // namespace corda::sim
