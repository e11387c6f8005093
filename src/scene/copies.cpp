// Ropes with `copies` as ropes of their own.
#include <fmt/format.h>

#include <algorithm>

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
    const std::size_t pin = def.pinned.empty() ? 0 : *std::min_element(def.pinned.begin(), def.pinned.end());
    const Direction by = direction_of(angle_deg);
    if (def.velocity_m_s != std::vector<Vec2>(def.velocity_m_s.size())) {
        toml::array velocities;
        for (const Vec2 v : def.velocity_m_s) velocities.push_back(pair_of(turned(v, by)));
        table.insert_or_assign("velocity", std::move(velocities));
    }
    if (toml::table* const hang = table["hang"].as_table(); hang != nullptr && pin == 0) {
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

/// Adds the copies of a rope after it.
void add_copies(const toml::table& rope, const std::string& path, Problems& problems, toml::array& ropes) {
    const TableReader reader(problems, rope, "rope", path);
    const TableReader copies = reader.table("copies");
    CopiesDef wanted;
    read_fields(copies, wanted);
    const auto size = read_rope_size(reader, 1);
    if (!size) return;
    if (wanted.count * size->particles > Limits::kParticles) {
        copies.add_problem(
            fmt::format("{} copies of {} particles are over the limit of {} particles; make fewer",
                        wanted.count, size->particles, Limits::kParticles));
        return;
    }
    ShapeDef shape;
    const RopeDef def = read_rope(reader, size, 1, shape);
    if (!problems.empty()) return;
    for (int k = 1; k < wanted.count; ++k) ropes.push_back(turned_table(rope, def, k * wanted.angle_deg));
}

}  // namespace

void expand_copies(toml::table& document, Problems& problems) {
    toml::array* const given = document["rope"].as_array();
    if (given == nullptr || !problems.empty()) return;
    toml::array ropes;
    std::vector<std::size_t> file_index;
    for (std::size_t i = 0; i < given->size(); ++i) {
        toml::table& rope = *given->get(i)->as_table();
        ropes.push_back(std::move(rope));
        toml::table& kept = *ropes.back().as_table();
        if (kept.contains("copies")) {
            add_copies(kept, fmt::format("rope[{}]", i), problems, ropes);
        }
        file_index.resize(ropes.size(), i);
    }
    given->clear();  // it keeps its place in the file
    for (toml::node& rope : ropes) given->push_back(std::move(*rope.as_table()));
    problems.set_ropes(std::move(file_index));
}

}  // namespace corda::scene
