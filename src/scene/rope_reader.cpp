#include <fmt/format.h>

#include <algorithm>

#include "corda/scene/readers.hpp"
#include "corda/sim/distance.hpp"

namespace corda::scene {
namespace {

constexpr Range kStiffness{.low = 0.0, .high = 1e12};
constexpr Range kLinkLength{.low = kShortestBar, .high = 4 * Limits::kCoordinateMetres};

/// A string's link may be shorter than the distance that it spans by this share of it: lengths are written
/// with fewer digits than distances have.
constexpr double kLengthSlack = 1e-9;

void read_pins(const TableReader& rope, std::int64_t particles, std::vector<std::uint32_t>& pinned) {
    constexpr std::string_view kRemedy = "give a list of particle indices, -1 is the last";
    const auto value = rope.find("pinned");
    if (!value) return;
    pinned = read_pinned(*value, particles, kRemedy, [&](const Value& entry) {
        return read_index(entry, particles, "the rope has particles", kRemedy);
    });
}

void refuse_contradictions(const TableReader& rope, const sim::RopeDef& def) {
    const bool stretches = def.material.compliance_1_n > 0.0;
    if (!def.material.is_string) return;
    if (def.bending_n_m2 > 0.0) {
        rope.find("bending")->fail(
            "a string hangs slack, and so has no bending stiffness; remove bending or string");
    }
    if (def.closed && !stretches) {
        rope.find("string")->fail(
            "a closed rope can only hang slack where it stretches; give a compliance, or remove string or "
            "closed");
    }
}

/// The rest length of the link between particles `a` and `b`.
double read_link_length(const Value& entry, const sim::RopeDef& def, std::size_t a, std::size_t b) {
    const double rest_m = entry.number(kLinkLength, "give a length of a link in m");
    if (def.material.compliance_1_n > 0.0) return rest_m;
    const sim::Vec2 along = def.points_m[b] - def.points_m[a];
    const double distance_m = sim::length(along.x, along.y);
    if (rest_m < (1.0 - kLengthSlack) * distance_m) {
        entry.fail(
            fmt::format("{} m are less than the {} m between particles {} and {}, which a string that "
                        "does not stretch cannot span; give at least that, or a compliance",
                        rest_m, distance_m, a, b));
    }
    return std::max(rest_m, distance_m);
}

void read_link_lengths(const TableReader& rope, sim::RopeDef& def) {
    constexpr std::string_view kRemedy = "give a length in m, or a list with one a link";
    const auto value = rope.find("link_length");
    if (!value) return;
    if (def.material.compliance_1_n == 0.0 && !def.material.is_string) {
        value->fail(
            "links that neither stretch nor hang slack are as long as their particles are apart at the "
            "start; give compliance or string = true, or remove it");
    }
    const std::size_t particles = def.points_m.size();
    const std::size_t links = def.closed ? particles : particles - 1;
    if (value->is_list() && value->size(kRemedy) != links) {
        value->fail(fmt::format("{} values for {} links; {}", value->size(kRemedy), links, kRemedy));
    }
    def.rest_m.reserve(links);
    for (std::size_t k = 0; k < links; ++k) {
        const Value entry = value->is_list() ? value->at(k) : *value;
        def.rest_m.push_back(read_link_length(entry, def, k, (k + 1) % particles));
    }
}

}  // namespace

sim::RopeDef read_rope(const TableReader& rope, std::int64_t particles, int reach) {
    sim::RopeDef def;
    if (const auto closed = rope.find("closed")) def.closed = closed->boolean("give true or false");
    read_shape(rope, particles, reach, def);
    def.mass_kg = read_mass(rope, particles);
    def.velocity_m_s = read_velocity(rope, particles);
    read_pins(rope, particles, def.pinned);
    rope.read_number("payload", def.payload_kg, {.low = 0.0, .high = kMass.high}, "give a payload in kg");
    def.material = read_material(rope);
    rope.read_number("bending", def.bending_n_m2, kStiffness, "give a bending stiffness in N m2");
    refuse_contradictions(rope, def);
    read_link_lengths(rope, def);
    return def;
}

}  // namespace corda::scene
