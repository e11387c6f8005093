#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "corda/scene/field.hpp"
#include "corda/scene/readers.hpp"
#include "corda/sim/defs.hpp"

namespace corda::scene {
namespace {

std::int64_t grid_particles(const GridDef& grid) {
    return std::int64_t{grid.columns} * grid.rows;
}

/// Along the rows and columns.
std::int64_t grid_links(const GridDef& grid) {
    const std::int64_t columns = grid.columns;
    const std::int64_t rows = grid.rows;
    return (columns - 1) * rows + columns * (rows - 1);
}

std::int64_t grid_bars(const GridDef& grid) {
    const std::int64_t cells = std::int64_t{grid.columns - 1} * (grid.rows - 1);
    return grid_links(grid) + (grid.has_diagonals ? 2 * cells : 0);
}

/// Empty if its size is not known.
std::optional<GridDef> read_grid(const TableReader& table) {
    GridDef grid;
    read_fields(table, grid);
    if (grid_particles(grid) == 1) table.add_problem("1 particle is no net", "give more columns or rows");
    return grid_particles(grid) < 2 ? std::nullopt : std::optional(grid);
}

void read_grid_points(const TableReader& table, const GridDef& grid, NetDef& def, ShapeDef& shape) {
    if (!table.has("spacing")) return;
    place(grid, def);
    shape = grid;
    const Vec2 last = def.origin_m + def.points_m.back();
    if (std::max(std::abs(last.x), std::abs(last.y)) > Limits::kCoordinateMetres) {
        table.add_problem(fmt::format("the last particle is at [{}, {}], beyond the limit of {:g} m", last.x,
                                      last.y, Limits::kCoordinateMetres),
                          "make the grid smaller");
    }
}

std::optional<std::uint32_t> read_grid_pin(const Value& entry, const GridDef& grid) {
    if (!entry.is_list()) return read_index(entry, grid_particles(grid), "the net has particles");
    const auto column = read_index(entry.at(0), grid.columns, "the grid has columns");
    const auto row = read_index(entry.at(1), grid.rows, "the grid has rows");
    if (!column || !row) return std::nullopt;
    return *row * static_cast<std::uint32_t>(grid.columns) + *column;
}

std::optional<std::uint32_t> read_point_pin(const Value& entry, std::int64_t particles) {
    if (!entry.is_list()) return read_index(entry, particles, "the net has particles");
    entry.add_problem("only a grid has columns and rows", "give the index of a particle");
    return std::nullopt;
}

/// By default the two upper corners.
void read_grid_pins(const TableReader& net, const GridDef& grid, NetDef& def) {
    const auto index_of = [&](const Value& entry) { return read_grid_pin(entry, grid); };
    def.pinned = {0};
    if (grid.columns > 1) def.pinned.push_back(static_cast<std::uint32_t>(grid.columns - 1));
    if (const auto value = net.find("pinned"))
        def.pinned = read_pinned(*value, grid_particles(grid), index_of);
    def.moves = read_moves(net, def.pinned, index_of);
    def.releases = read_releases(net, def.pinned, index_of);
}

/// By default the first.
void read_point_pins(const TableReader& net, std::int64_t particles, NetDef& def) {
    const auto index_of = [&](const Value& entry) { return read_point_pin(entry, particles); };
    def.pinned = {0};
    if (const auto value = net.find("pinned")) def.pinned = read_pinned(*value, particles, index_of);
    def.moves = read_moves(net, def.pinned, index_of);
    def.releases = read_releases(net, def.pinned, index_of);
}

std::optional<NetBar> read_bar(const Value& entry, const NetDef& def) {
    const auto count = static_cast<std::int64_t>(def.points_m.size());
    const auto a = read_index(entry.at(0), count, "the net has particles");
    const auto b = read_index(entry.at(1), count, "the net has particles");
    if (!a || !b) return std::nullopt;
    const Vec2 along = def.points_m[*b] - def.points_m[*a];
    if (*a == *b) {
        entry.add_problem(fmt::format("a bar from particle {} to itself", *a), "join two different ones");
    } else if (sim::length(along.x, along.y) < kMinBarMetres) {
        entry.add_problem(
            fmt::format("particles {} and {} coincide, and a bar without length has no direction", *a, *b),
            "move one");
    }
    return NetBar{*a, *b};
}

/// The second of two bars between the same particles is a problem.
void refuse_double_bars(const Value& list, const std::vector<NetBar>& bars) {
    struct Pair {
        std::uint32_t low;
        std::uint32_t high;
        std::size_t place;
        [[nodiscard]] auto key() const { return std::pair(low, high); }
    };
    std::vector<Pair> pairs;
    pairs.reserve(bars.size());
    for (const NetBar& bar : bars)
        pairs.push_back({std::min(bar.a, bar.b), std::max(bar.a, bar.b), pairs.size()});
    std::ranges::stable_sort(pairs, {}, &Pair::key);
    const auto same = std::ranges::adjacent_find(pairs, {}, &Pair::key);
    if (same == pairs.end()) return;
    list.at((same + 1)->place)
        .add_problem(fmt::format("particles {} and {} are joined already, by bars[{}]", same->low, same->high,
                                 same->place),
                     "remove one");
}

void read_bars(const Value& list, NetDef& def) {
    def.bars.reserve(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (const auto bar = read_bar(list.at(i), def)) def.bars.push_back(*bar);
    }
    if (def.bars.size() == list.size()) refuse_double_bars(list, def.bars);
}

}  // namespace

std::optional<BodySize> read_net_size(const TableReader& net) {
    const bool has_grid = net.is_given("grid");
    if (has_grid == net.is_given("points")) {
        net.add_problem(has_grid ? "the net has 2 shapes (grid, points)" : "the net has no shape",
                        has_grid ? "keep one of them" : "give grid, or points and bars");
        return std::nullopt;
    }
    const auto points = net.find("points");
    const auto bars = net.find("bars");
    if (has_grid && bars)
        bars->add_problem("a grid has bars of its own", "remove them, or give points in place of the grid");
    if (!has_grid && !bars) net.add_missing("bars");
    if (points && bars)
        return BodySize{static_cast<std::int64_t>(points->size()), static_cast<std::int64_t>(bars->size())};
    const auto grid = read_grid(net.table("grid"));
    return grid ? std::optional(BodySize{grid_particles(*grid), grid_bars(*grid)}) : std::nullopt;
}

NetDef read_net(const TableReader& net, const std::optional<BodySize>& size, ShapeDef& shape) {
    NetDef def;
    read_fields(net, def);
    if (def.material.is_string && def.material.compliance_1_n == 0.0 && net.is_sound("compliance")) {
        net.find("string")->add_problem("a net can only hang slack if it stretches",
                                        "give a compliance, or remove string");
    }
    if (!size) return def;
    def.mass_kg = read_mass(net, size->particles);
    def.velocity_m_s = read_velocity(net, size->particles);
    refuse_origin(net);
    if (net.has("grid")) {
        const TableReader table = net.table("grid");
        const auto grid = read_grid(table);
        read_grid_points(table, *grid, def, shape);
        read_grid_pins(net, *grid, def);
        def.cuts = read_cuts(net, grid_links(*grid));
    } else {
        read_points(net, def.origin_m, def.points_m);
        read_bars(*net.find("bars"), def);
        read_point_pins(net, size->particles, def);
        def.cuts = read_cuts(net, size->bars);
    }
    return def;
}

}  // namespace corda::scene

namespace corda {

void place(const GridDef& grid, NetDef& net) {
    net.origin_m = grid.from_m;
    net.points_m.clear();
    net.points_m.reserve(static_cast<std::size_t>(scene::grid_particles(grid)));
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            // 0 - and not -: no zero has a sign.
            net.points_m.push_back({static_cast<double>(column) * grid.spacing_m.x,
                                    0.0 - static_cast<double>(row) * grid.spacing_m.y});
        }
    }
    net.bars.clear();
    net.bars.reserve(static_cast<std::size_t>(scene::grid_bars(grid)));
    const auto columns = static_cast<std::uint32_t>(grid.columns);
    const auto rows = static_cast<std::uint32_t>(grid.rows);
    const auto add = [&](std::uint32_t last_row, std::uint32_t last_column, auto&& add_at) {
        for (std::uint32_t row = 0; row < last_row; ++row) {
            for (std::uint32_t column = 0; column < last_column; ++column) add_at(row * columns + column);
        }
    };
    // Bars along the rows, then along the columns, then both diagonals of each cell.
    add(rows, columns - 1, [&](std::uint32_t i) { net.bars.push_back({i, i + 1}); });
    add(rows - 1, columns, [&](std::uint32_t i) { net.bars.push_back({i, i + columns}); });
    if (!grid.has_diagonals) return;
    add(rows - 1, columns - 1, [&](std::uint32_t i) {
        net.bars.push_back({i, i + columns + 1, false});
        net.bars.push_back({i + 1, i + columns, false});
    });
}

}  // namespace corda
