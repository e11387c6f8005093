// Ropes with `copies` as ropes of their own.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/direction.hpp"
#include "corda/scene/document.hpp"
#include "corda/scene/field.hpp"
#include "corda/scene/readers.hpp"

namespace corda::scene {
namespace {

toml::array pair_of(Vec2 v) {
    return toml::array{v.x, v.y};
}

/// `v` turned by that direction from straight down, positive to +x.
Vec2 turned(Vec2 v, const Direction& by) {
    return {by.cosine * v.x - by.sine * v.y, by.sine * v.x + by.cosine * v.y};
}

/// The table of a rope turned about its first pin, or its first particle.
toml::table turned_table(const toml::table& rope, const RopeDef& def, double angle_deg) {
    toml::table table = rope;
    table.erase("copies");
    table.erase("label");
    table.insert_or_assign("merged", true);
    const std::size_t pin = def.pinned.empty() ? 0 : *std::ranges::min_element(def.pinned);
    const Direction by = direction_of(angle_deg);
    toml::table* const hang = pin == 0 ? table["hang"].as_table() : nullptr;
    const bool has_rates = hang != nullptr && hang->contains("rates_deg_s");  // they turn with the angles
    if (!has_rates && def.velocity_m_s != std::vector<Vec2>(def.velocity_m_s.size())) {
        toml::array velocities;
        for (const Vec2 v : def.velocity_m_s) velocities.push_back(pair_of(turned(v, by)));
        table.insert_or_assign("velocity", std::move(velocities));
    }
    if (hang != nullptr && hang->contains("angles_deg")) {
        toml::array angles;
        for (const toml::node& given : *hang->get_as<toml::array>("angles_deg"))
            angles.push_back(number_of(given) + angle_deg);
        hang->insert_or_assign("angles_deg", std::move(angles));
        return table;
    }
    if (hang != nullptr) {
        const toml::node* const given = hang->get("angle_deg");
        hang->insert_or_assign("angle_deg", (given == nullptr ? 0.0 : number_of(*given)) + angle_deg);
        return table;
    }
    toml::array points;
    for (const Vec2 p : def.points_m)
        points.push_back(pair_of(def.points_m[pin] + turned(p - def.points_m[pin], by)));
    for (const char* const shape : {"hang", "line"}) table.erase(shape);
    table.insert_or_assign("points", std::move(points));
    table.insert_or_assign("origin", pair_of(def.origin_m));
    return table;
}

CopiesDef copies_of(const TableReader& rope) {
    CopiesDef copies;
    read_fields(rope.table("copies"), copies);
    return copies;
}

/// Adds a problem if there are too many particles in all ropes with copies, of which none is made yet.
void check_sum(const std::vector<TableReader>& ropes) {
    std::int64_t sum = 0;
    for (const TableReader& rope : ropes) {
        const auto size = rope.has("copies") ? read_rope_size(rope, 1) : std::nullopt;
        if (!size) continue;
        const int count = copies_of(rope).count;
        const std::int64_t before = std::exchange(sum, sum + count * size->particles);
        if (sum <= Limits::kParticles) continue;
        const std::string with = before == 0 ? "" : fmt::format(", with {} of ropes before it,", before);
        return rope.table("copies").add_problem(
            fmt::format("{} copies of {} particles{} are over the limit of {} particles", count,
                        size->particles, with, Limits::kParticles),
            "make fewer");
    }
}

void add_copies(const toml::table& table, const TableReader& rope, Problems& problems, toml::array& ropes) {
    const CopiesDef copies = copies_of(rope);
    ShapeDef shape;
    const RopeDef def = read_rope(rope, read_rope_size(rope, 1), 1, shape);
    for (int k = 1; k < copies.count && problems.empty(); ++k) {
        check_cancelled();
        ropes.push_back(turned_table(table, def, k * copies.angle_deg));
    }
}

}  // namespace

void expand_copies(toml::table& document, Problems& problems) {
    toml::array* const given = document["rope"].as_array();
    if (given == nullptr || !problems.empty()) return;
    check_sum(TableReader(problems, document, "", "").tables("rope"));
    if (!problems.empty()) return;
    toml::array ropes;
    std::vector<std::size_t> file_index;
    for (std::size_t i = 0; i < given->size(); ++i) {
        toml::table& rope = *given->get(i)->as_table();
        ropes.push_back(std::move(rope));
        toml::table& kept = *ropes.back().as_table();
        if (kept.contains("copies"))
            add_copies(kept, TableReader(problems, kept, "rope", fmt::format("rope[{}]", i)), problems,
                       ropes);
        file_index.resize(ropes.size(), i);
    }
    given->clear();  // it keeps its place in the file
    for (toml::node& rope : ropes) given->push_back(std::move(*rope.as_table()));
    problems.set_ropes(std::move(file_index));
}

}  // namespace corda::scene
