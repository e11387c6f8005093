#include <fmt/format.h>

#include <algorithm>

#include "corda/scene/readers.hpp"
#include "corda/sim/distance.hpp"
#include "corda/sim/system.hpp"

namespace corda::scene {
namespace {

/// A string's link may be shorter than the distance that it spans by this share of it: lengths are written
/// with fewer digits than distances have.
constexpr double kLengthSlack = 1e-9;

void refuse_contradictions(const TableReader& rope, const RopeDef& def) {
    if (!def.material.is_string) return;
    if (def.bending_n_m2 > 0.0) {
        rope.find("bending")->add_problem(
            "a string hangs slack, and so has no bending stiffness; remove bending or string");
    }
    if (def.closed && def.material.compliance_1_n == 0.0 && rope.is_sound("compliance")) {
        rope.find("string")->add_problem(
            "a closed rope can only hang slack if it stretches; give a compliance, or remove string or "
            "closed");
    }
}

/// The rest length of link `k`. One that is too short is pulled in before the start, unless pins hold it.
double read_link_length(const Value& entry, const RopeDef& def, bool is_between_pins, std::size_t k) {
    const auto rest_m = entry.as<double>();
    if (def.material.compliance_1_n > 0.0) return rest_m;
    const Vec2 along = def.points_m[(k + 1) % def.points_m.size()] - def.points_m[k];
    const double distance_m = sim::length(along.x, along.y);
    if (rest_m >= (1.0 - kLengthSlack) * distance_m) return std::max(rest_m, distance_m);
    if (is_between_pins) {
        entry.add_problem(
            fmt::format("{} m are less than the {} m between particles {} and {}, which lie between pins, "
                        "and which a string that does not stretch cannot span; give at least that, or a "
                        "compliance",
                        rest_m, distance_m, k, k + 1));
    }
    return rest_m;
}

void read_link_lengths(const TableReader& rope, RopeDef& def) {
    const auto value = rope.find("link_length");
    if (!value || !rope.is_sound("compliance") || !rope.is_sound("string")) return;
    if (def.material.compliance_1_n == 0.0 && !def.material.is_string) {
        value->add_problem(
            "links that neither stretch nor hang slack are as long as their particles are apart at the "
            "start; give compliance or string = true, or remove it");
        return;
    }
    const std::size_t links = def.closed ? def.points_m.size() : def.points_m.size() - 1;
    if (value->is_list() && value->size() != links) {
        value->add_problem(fmt::format("{} values for {} links; give one per link", value->size(), links));
        return;
    }
    def.rest_m.reserve(links);
    const LinkRange between = links_between_pins(def);
    for (std::size_t k = 0; k < links; ++k) {
        const Value entry = value->is_list() ? value->at(k) : *value;
        def.rest_m.push_back(read_link_length(entry, def, between.contains(k), k));
    }
}

}  // namespace

RopeDef read_rope(const TableReader& rope, const std::optional<BodySize>& size, int reach) {
    RopeDef def;
    def.reach = reach;
    if (rope.is_sound("closed")) rope.read("closed", def.closed);
    rope.read("payload", def.payload_kg);
    rope.read("bending", def.bending_n_m2);
    def.material = read_material(rope);
    refuse_contradictions(rope, def);
    if (!size) return def;
    def.mass_kg = read_mass(rope, size->particles);
    def.velocity_m_s = read_velocity(rope, size->particles);
    if (const auto pinned = rope.find("pinned")) {
        def.pinned = read_pinned(*pinned, size->particles, [&](const Value& entry) {
            return read_index(entry, size->particles, "the rope has particles");
        });
    }
    if (read_rope_shape(rope, size->particles, def)) read_link_lengths(rope, def);
    return def;
}

}  // namespace corda::scene
