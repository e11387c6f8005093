// What ropes and nets have in common.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "corda/scene/field.hpp"
#include "corda/scene/readers.hpp"

namespace corda::scene {
namespace {

/// A value of every particle: `one` of them for all, or a list.
template <class T>
std::vector<T> read_all(const Value& value, bool is_list, std::int64_t particles) {
    const auto count = static_cast<std::size_t>(particles);
    if (!is_list) return std::vector<T>(count, value.as<T>());
    if (value.size() != count) {
        value.add_problem(fmt::format("{} values for {} particles", value.size(), particles),
                          "give one per particle");
        return std::vector<T>(count);
    }
    std::vector<T> values;
    values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) values.push_back(value.at(i).as<T>());
    return values;
}

}  // namespace

std::vector<double> read_mass(const TableReader& body, std::int64_t particles) {
    const auto mass = body.find("mass");
    if (!mass) return std::vector<double>(static_cast<std::size_t>(particles), kDefaultMassKg);
    return read_all<double>(*mass, mass->is_list(), particles);
}

std::vector<Vec2> read_velocity(const TableReader& body, std::int64_t particles) {
    const auto velocity = body.find("velocity");
    if (!velocity) return std::vector<Vec2>(static_cast<std::size_t>(particles));
    // [a, b] is one velocity for all; [[a, b], [c, d]] is a list, also for a body of two particles.
    return read_all<Vec2>(*velocity, velocity->at(0).is_list(), particles);
}

namespace {

MoveDef read_move(const TableReader& table) {
    MoveDef move;
    for (const TableReader& wave : table.tables("waves")) read_fields(wave, move.waves.emplace_back());
    for (const TableReader& key : table.tables("path")) {
        read_fields(key, move.path.emplace_back());
        const PathKeyDef& here = move.path.back();
        if (move.path.size() == 1 && here.by_m != Vec2{})
            key.add_problem("a path starts at the place of its pin", "give a first key with by = [0, 0]");
        if (move.path.size() > 1 && here.time_s <= (move.path.end() - 2)->time_s)
            key.add_problem(fmt::format("{} s after {} s", here.time_s, (move.path.end() - 2)->time_s),
                            "give times that increase");
    }
    if (!table.is_given("waves") && !table.is_given("path"))
        table.add_problem("neither waves nor a path", "give one of them or both");
    return move;
}

/// The pinned particle that a table names; std::nullopt without one.
std::optional<std::uint32_t> read_pin(const TableReader& table, const std::vector<std::uint32_t>& pinned,
                                      const IndexOf& index_of) {
    const auto pin = table.find("pin");
    const auto index = pin ? index_of(*pin) : std::nullopt;
    if (index && std::ranges::find(pinned, *index) == pinned.end())
        pin->add_problem(fmt::format("particle {} is not pinned", *index),
                         "add it to pinned, or give the index of a pinned one");
    return index;
}

}  // namespace

std::vector<MoveDef> read_moves(const TableReader& body, const std::vector<std::uint32_t>& pinned,
                                const IndexOf& index_of) {
    std::vector<MoveDef> moves;
    for (const TableReader& table : body.tables("moves")) {
        MoveDef move = read_move(table);
        const auto pin = read_pin(table, pinned, index_of);
        if (!pin) continue;
        move.pin = *pin;
        if (std::ranges::find(moves, move.pin, &MoveDef::pin) != moves.end())
            table.find("pin")->add_problem(fmt::format("particle {} moves already", move.pin),
                                           "put its waves and its path into one entry");
        moves.push_back(std::move(move));
    }
    return moves;
}

std::vector<ReleaseDef> read_releases(const TableReader& body, const std::vector<std::uint32_t>& pinned,
                                      const IndexOf& index_of) {
    std::vector<ReleaseDef> releases;
    for (const TableReader& table : body.tables("release")) {
        ReleaseDef release;
        read_fields(table, release);
        const auto pin = read_pin(table, pinned, index_of);
        if (!pin) continue;
        release.pin = *pin;
        if (std::ranges::find(releases, release.pin, &ReleaseDef::pin) != releases.end())
            table.find("pin")->add_problem(fmt::format("particle {} is let go already", release.pin),
                                           "remove one");
        releases.push_back(release);
    }
    return releases;
}

std::vector<CutDef> read_cuts(const TableReader& body, std::int64_t links) {
    std::vector<CutDef> cuts;
    for (const TableReader& table : body.tables("cut")) {
        CutDef cut;
        read_fields(table, cut);
        const auto link = table.find("link");
        const auto index = link ? read_index(*link, links, "it has links") : std::nullopt;
        if (!index) continue;
        cut.link = *index;
        if (std::ranges::find(cuts, cut.link, &CutDef::link) != cuts.end())
            link->add_problem(fmt::format("link {} is cut already", cut.link), "remove one");
        cuts.push_back(cut);
    }
    return cuts;
}

BodyStyleDef read_body_style(const TableReader& body, bool takes_link_colors) {
    BodyStyleDef def;
    read_fields(body, def);
    if (const auto color = body.find("color"); color && color->is_list()) {
        def.link_colors = color->as<std::vector<Color>>();
        for (std::size_t i = 0; i < def.link_colors.size(); ++i) {
            if (def.link_colors[i].a != def.link_colors.front().a)
                color->at(i).add_problem("another alpha than that of the first link",
                                         "give all links the same");
        }
        if (!takes_link_colors)
            color->add_problem("a list of colours is for links in turn",
                               "set style.color_by = \"link\", or give one colour");
    } else if (color) {
        def.color = color->as<Color>();
    }
    return def;
}

void read_points(const TableReader& body, Vec2& origin_m, std::vector<Vec2>& points_m) {
    const Value points = *body.find("points");
    points_m.reserve(points.size());
    if (const auto origin = body.find("origin")) {
        origin_m = origin->as<Vec2>();
        for (std::size_t i = 0; i < points.size(); ++i) {
            points_m.push_back(points.at(i).as<Vec2>());
            const Vec2 at = origin_m + points_m.back();
            if (std::max(std::abs(at.x), std::abs(at.y)) > Limits::kCoordinateMetres)
                points.at(i).add_problem(
                    fmt::format("with the origin it is at [{}, {}], beyond the limit of {:g} m", at.x, at.y,
                                Limits::kCoordinateMetres),
                    "move it closer");
        }
        return;
    }
    origin_m = points.at(0).as<Vec2>();
    for (std::size_t i = 0; i < points.size(); ++i) points_m.push_back(points.at(i).as<Vec2>() - origin_m);
}

void refuse_origin(const TableReader& body) {
    if (const auto origin = body.find("origin"); origin && !body.is_given("points"))
        origin->add_problem("only points are relative to an origin", "give \"from\" in the shape's table");
}

std::optional<std::uint32_t> read_index(const Value& entry, std::int64_t count, std::string_view owner) {
    const auto written = entry.as<std::int64_t>();
    if (written >= -count && written < count)
        return static_cast<std::uint32_t>(written < 0 ? written + count : written);
    entry.add_problem(fmt::format("{} is out of range", written),
                      fmt::format("{} 0 .. {}, or -1 .. -{} from the end", owner, count - 1, count));
    return std::nullopt;
}

std::vector<std::uint32_t> read_pinned(const Value& list, std::int64_t particles, const IndexOf& index_of) {
    std::vector<std::uint32_t> pinned;
    std::vector<bool> seen(static_cast<std::size_t>(particles));
    for (std::size_t i = 0; i < list.size(); ++i) {
        const Value entry = list.at(i);
        const auto index = index_of(entry);
        if (!index) continue;
        if (seen[*index]) entry.add_problem(fmt::format("particle {} is given twice", *index), "remove one");
        seen[*index] = true;
        pinned.push_back(*index);
    }
    return pinned;
}

}  // namespace corda::scene
