#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "corda/scene/readers.hpp"
#include "corda/sim/distance.hpp"

namespace corda::scene {
namespace {

constexpr std::string_view kGrid = "give grid = { columns = 40, rows = 30, spacing = 0.1 }";
constexpr std::string_view kPoints = "give a list of [x, y] in m, at least 2";
constexpr std::string_view kBars = "give bars = [[0, 1], [1, 2]], pairs of particle indices";
constexpr Range kSpacing{.low = kShortestBar, .high = Limits::kCoordinateMetres};

/// A net of particles in rows, particle row * columns + column; row 0 on top.
struct Grid {
    std::int64_t columns = 0;
    std::int64_t rows = 0;
    bool has_diagonals = true;

    [[nodiscard]] std::int64_t particles() const { return columns * rows; }
    [[nodiscard]] std::int64_t bars() const {
        const std::int64_t sides = (columns - 1) * rows + columns * (rows - 1);
        return sides + (has_diagonals ? 2 * (columns - 1) * (rows - 1) : 0);
    }
};

Grid read_grid(const TableReader& table) {
    constexpr std::string_view kColumns = "give the number of particles in a row, at least 1";
    constexpr std::string_view kRows = "give the number of rows, at least 1";
    Grid grid;
    grid.columns = table.require("columns", kColumns).integer(1, Limits::kParticles, kColumns);
    grid.rows = table.require("rows", kRows).integer(1, Limits::kParticles, kRows);
    if (grid.particles() < 2) table.fail("1 particle is no net; give more columns or rows");
    if (const auto value = table.find("diagonals")) grid.has_diagonals = value->boolean("give true or false");
    return grid;
}

void add_grid_points(const TableReader& table, const Grid& grid, sim::NetDef& def) {
    constexpr std::string_view kRemedy = "give a distance in m, or [dx, dy]";
    const Value value = table.require("spacing", kRemedy);
    sim::Vec2 spacing;
    if (value.is_list()) {
        spacing = value.pair(kSpacing, kRemedy);
    } else {
        spacing.x = spacing.y = value.number(kSpacing, kRemedy);
    }
    if (const auto from = table.find("from"))
        def.origin_m = from->pair(kCoordinate, "give the upper left particle as [x, y] in m");
    def.points_m.reserve(static_cast<std::size_t>(grid.particles()));
    for (std::int64_t row = 0; row < grid.rows; ++row) {
        for (std::int64_t column = 0; column < grid.columns; ++column) {
            // 0 - and not -: no zero has a sign.
            def.points_m.push_back(
                {static_cast<double>(column) * spacing.x, 0.0 - static_cast<double>(row) * spacing.y});
        }
    }
    const sim::Vec2 last = def.origin_m + def.points_m.back();
    if (std::max(std::abs(last.x), std::abs(last.y)) > Limits::kCoordinateMetres) {
        table.fail(
            fmt::format("the last particle is at [{}, {}], beyond the limit of {:g} m; make the grid smaller",
                        last.x, last.y, Limits::kCoordinateMetres));
    }
}

/// Bars along the rows, then along the columns, then both diagonals of each cell.
void add_grid_bars(const Grid& grid, std::vector<sim::NetBar>& bars) {
    const auto columns = static_cast<std::uint32_t>(grid.columns);
    const auto rows = static_cast<std::uint32_t>(grid.rows);
    const auto add = [&](std::uint32_t last_row, std::uint32_t last_column, auto&& add_at) {
        for (std::uint32_t row = 0; row < last_row; ++row) {
            for (std::uint32_t column = 0; column < last_column; ++column) add_at(row * columns + column);
        }
    };
    bars.reserve(static_cast<std::size_t>(grid.bars()));
    add(rows, columns - 1, [&](std::uint32_t i) { bars.push_back({i, i + 1}); });
    add(rows - 1, columns, [&](std::uint32_t i) { bars.push_back({i, i + columns}); });
    if (!grid.has_diagonals) return;
    add(rows - 1, columns - 1, [&](std::uint32_t i) {
        bars.push_back({i, i + columns + 1, false});
        bars.push_back({i + 1, i + columns, false});
    });
}

std::int64_t read_grid_pin(const Value& entry, const Grid& grid) {
    constexpr std::string_view kRemedy =
        "give particles as indices, -1 is the last, or as [column, row], [-1, 0] the upper right one";
    if (!entry.is_list()) return read_index(entry, grid.particles(), "the net has particles", kRemedy);
    if (entry.size(kRemedy) != 2) {
        entry.fail(fmt::format("this is a list of {}, not [column, row]; {}", entry.size(kRemedy), kRemedy));
    }
    const std::int64_t column = read_index(entry.at(0), grid.columns, "the grid has columns", kRemedy);
    return read_index(entry.at(1), grid.rows, "the grid has rows", kRemedy) * grid.columns + column;
}

/// Pins of a grid; by default the two upper corners.
void read_grid_pins(const TableReader& net, const Grid& grid, std::vector<std::uint32_t>& pinned) {
    const auto value = net.find("pinned");
    if (value) {
        pinned = read_pinned(*value, grid.particles(), "give a list of particles",
                             [&](const Value& entry) { return read_grid_pin(entry, grid); });
        return;
    }
    pinned = {0};
    if (grid.columns > 1) pinned.push_back(static_cast<std::uint32_t>(grid.columns - 1));
}

/// Pins of a net of points; by default the first.
void read_point_pins(const TableReader& net, std::int64_t particles, std::vector<std::uint32_t>& pinned) {
    constexpr std::string_view kRemedy = "give a list of particle indices, -1 is the last";
    pinned = {0};
    if (const auto value = net.find("pinned")) {
        pinned = read_pinned(*value, particles, kRemedy, [&](const Value& entry) {
            return read_index(entry, particles, "the net has particles", kRemedy);
        });
    }
}

void read_points(const Value& points, sim::NetDef& def) {
    const std::size_t count = points.size(kPoints);
    def.points_m.reserve(count);
    def.origin_m = points.at(0).pair(kCoordinate, kPoints);
    for (std::size_t i = 0; i < count; ++i)
        def.points_m.push_back(points.at(i).pair(kCoordinate, kPoints) - def.origin_m);
}

sim::NetBar read_bar(const Value& entry, const sim::NetDef& def) {
    const auto count = static_cast<std::int64_t>(def.points_m.size());
    if (entry.size(kBars) != 2)
        entry.fail(fmt::format("this is a list of {}, not a pair; {}", entry.size(kBars), kBars));
    const auto end = [&](std::size_t i) {
        return static_cast<std::uint32_t>(read_index(entry.at(i), count, "the net has particles", kBars));
    };
    const sim::NetBar bar{end(0), end(1)};
    if (bar.a == bar.b)
        entry.fail(fmt::format("a bar from particle {} to itself; join two different ones", bar.a));
    const sim::Vec2 along = def.points_m[bar.b] - def.points_m[bar.a];
    if (sim::length(along.x, along.y) < kShortestBar) {
        entry.fail(
            fmt::format("particles {} and {} coincide, and a bar without length has no direction; "
                        "move one",
                        bar.a, bar.b));
    }
    return bar;
}

/// Fails at the second of two bars between the same particles.
void refuse_double_bars(const Value& list, const std::vector<sim::NetBar>& bars) {
    struct Pair {
        std::uint32_t low;
        std::uint32_t high;
        std::size_t place;
        [[nodiscard]] auto key() const { return std::pair(low, high); }
    };
    std::vector<Pair> pairs;
    pairs.reserve(bars.size());
    for (const sim::NetBar& bar : bars)
        pairs.push_back({std::min(bar.a, bar.b), std::max(bar.a, bar.b), pairs.size()});
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& a, const Pair& b) { return a.key() < b.key(); });
    const auto same = std::adjacent_find(pairs.begin(), pairs.end(),
                                         [](const Pair& a, const Pair& b) { return a.key() == b.key(); });
    if (same == pairs.end()) return;
    list.at((same + 1)->place)
        .fail(fmt::format("particles {} and {} are joined already, by bars[{}]; remove one", same->low,
                          same->high, same->place));
}

void read_bars(const Value& list, sim::NetDef& def) {
    def.bars.reserve(list.size(kBars));
    for (std::size_t i = 0; i < list.size(kBars); ++i) def.bars.push_back(read_bar(list.at(i), def));
    refuse_double_bars(list, def.bars);
}

void require_one_shape(const TableReader& net) {
    if (net.has("grid") != net.has("points")) return;
    net.fail(net.has("grid") ? "the net has 2 shapes (grid, points); keep one of them"
                             : "the net has no shape; give grid, or points and bars");
}

}  // namespace

BodySize read_net_size(const TableReader& net) {
    require_one_shape(net);
    if (net.has("grid")) {
        if (const auto bars = net.find("bars"))
            bars->fail("a grid has bars of its own; remove them, or give points in place of the grid");
        const Grid grid = read_grid(net.table("grid", kGrid));
        return {grid.particles(), grid.bars()};
    }
    const Value points = net.require("points", kPoints);
    const Value bars = net.require("bars", kBars);
    if (points.size(kPoints) < 2)
        points.fail(fmt::format("{} points are no net; {}", points.size(kPoints), kPoints));
    if (bars.size(kBars) == 0) bars.fail(fmt::format("the list is empty; {}", kBars));
    return {static_cast<std::int64_t>(points.size(kPoints)), static_cast<std::int64_t>(bars.size(kBars))};
}

sim::NetDef read_net(const TableReader& net) {
    sim::NetDef def;
    if (net.has("grid")) {
        const TableReader table = net.table("grid", kGrid);
        const Grid grid = read_grid(table);
        add_grid_points(table, grid, def);
        add_grid_bars(grid, def.bars);
        read_grid_pins(net, grid, def.pinned);
    } else {
        read_points(net.require("points", kPoints), def);
        read_bars(net.require("bars", kBars), def);
        read_point_pins(net, static_cast<std::int64_t>(def.points_m.size()), def.pinned);
    }
    const auto particles = static_cast<std::int64_t>(def.points_m.size());
    def.mass_kg = read_mass(net, particles);
    def.velocity_m_s = read_velocity(net, particles);
    def.material = read_material(net);
    if (def.material.is_string && def.material.compliance_1_n == 0.0) {
        net.find("string")->fail(
            "a net can only hang slack where it stretches; give a compliance, or remove string");
    }
    return def;
}

}  // namespace corda::scene
