#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "corda/scene/readers.hpp"
#include "corda/sim/system.hpp"

namespace corda::scene {
namespace {

constexpr std::array<std::string_view, 3> kShapes{"line", "hang", "points"};
constexpr std::string_view kLine = "give line = { particles = 40, from = [0.0, 0.0], step = [0.0, -1.0] }";
constexpr std::string_view kHang = "give hang = { links = 20, length = 1.0, angle_deg = 45.0 }";
constexpr std::string_view kPoints = "give a list of [x, y] in m, at least 2";
constexpr std::string_view kFrom = "give the first particle as [x, y] in m";

double distance_m(sim::Vec2 a, sim::Vec2 b) {
    return std::hypot(b.x - a.x, b.y - a.y);
}

/// Sine and cosine of an angle in degrees; exactly 0 and 1 at multiples of 90.
struct Direction {
    double sine = 0.0;
    double cosine = 1.0;
};

Direction direction_of(double angle_deg) {
    int quarters = 0;
    const double rest_deg = std::remquo(angle_deg, 90.0, &quarters);  // exact
    const double rest_rad = rest_deg * (std::numbers::pi / 180.0);
    const Direction rest{std::sin(rest_rad), std::cos(rest_rad)};
    switch (static_cast<unsigned>(quarters) & 3U) {
        case 1:
            return {rest.cosine, -rest.sine};
        case 2:
            return {-rest.sine, -rest.cosine};
        case 3:
            return {-rest.cosine, rest.sine};
        default:
            return rest;
    }
}

sim::Vec2 read_from(const TableReader& shape) {
    const auto from = shape.find("from");
    return from ? from->pair(kCoordinate, kFrom) : sim::Vec2{};
}

/// A straight rope lies inside the limits if both of its ends do.
void check_last_point(const TableReader& shape, const sim::RopeDef& def) {
    const sim::Vec2 last = def.origin_m + def.points_m.back();
    if (std::max(std::abs(last.x), std::abs(last.y)) <= Limits::kCoordinateMetres) return;
    shape.fail(
        fmt::format("the last particle is at [{}, {}], beyond the limit of {:g} m; make the rope shorter",
                    last.x, last.y, Limits::kCoordinateMetres));
}

void read_line(const TableReader& line, std::int64_t particles, sim::RopeDef& def) {
    constexpr std::string_view kStep = "give step = [dx, dy] in m";
    const Value step_value = line.require("step", kStep);
    const sim::Vec2 step = step_value.pair(kCoordinate, kStep);
    if (distance_m({}, step) < kShortestBar) {
        step_value.fail(fmt::format("[{}, {}] is no distance; give a step of at least {} m", step.x, step.y,
                                    kShortestBar));
    }
    def.origin_m = read_from(line);
    def.points_m.reserve(static_cast<std::size_t>(particles));
    for (std::int64_t i = 0; i < particles; ++i) {
        def.points_m.push_back(sim::Vec2{} + static_cast<double>(i) * step);  // 0 + turns -0 into 0
    }
    check_last_point(line, def);
}

void read_hang(const TableReader& hang, std::int64_t particles, sim::RopeDef& def) {
    constexpr std::string_view kLength = "give a length in m";
    const auto links = static_cast<double>(particles - 1);
    const Value length_value = hang.require("length", kLength);
    const double length_m = length_value.number(kPositive, kLength);
    if (length_m / links < kShortestBar) {
        length_value.fail(
            fmt::format("{} m are less than {} m a link; make the rope longer", length_m, kShortestBar));
    }
    double angle_deg = 0.0;
    hang.read_number("angle_deg", angle_deg, kAnyNumber, "give an angle in degrees from straight down");
    const Direction direction = direction_of(angle_deg);
    def.origin_m = read_from(hang);
    def.points_m.reserve(static_cast<std::size_t>(particles));
    for (std::int64_t i = 0; i < particles; ++i) {
        const double along_m = static_cast<double>(i) * length_m / links;
        // 0 + and 0 - give the zeros of a straight rope one sign.
        def.points_m.push_back({0.0 + along_m * direction.sine, 0.0 - along_m * direction.cosine});
    }
    check_last_point(hang, def);
}

/// Fails at a bar between points `a` and `b`, `stride` links apart, that has no length.
[[noreturn]] void fail_short_bar(const Value& points, std::size_t a, std::size_t b, std::size_t stride,
                                 int reach) {
    const auto [first, last] = std::minmax(a, b);
    const Value place = points.at(last);
    if (stride > 1) {
        place.fail(
            fmt::format("points {} and {} coincide, and solver.reach = {} ties them by a bar, "
                        "which has no direction; move one, or give a reach below {}",
                        first, last, reach, stride));
    }
    if (b < a) {
        place.fail(
            fmt::format("points {} and {} coincide; leave this one out, as closed = true ties the "
                        "last point to the first",
                        first, last));
    }
    place.fail(fmt::format("points {} and {} coincide, and a link without length has no direction; move one",
                           first, last));
}

void refuse_short_bars(const Value& points, const sim::RopeDef& def, int reach) {
    const std::size_t count = def.points_m.size();
    const std::size_t longest = std::min(static_cast<std::size_t>(reach), def.closed ? count / 2 : count - 1);
    for (std::size_t k = 1; k <= longest; ++k) {
        for (std::size_t a = 0; a < (def.closed ? count : count - k); ++a) {
            const std::size_t b = (a + k) % count;
            if (distance_m(def.points_m[a], def.points_m[b]) < kShortestBar)
                fail_short_bar(points, a, b, k, reach);
        }
    }
}

void read_points(const Value& points, std::int64_t particles, int reach, sim::RopeDef& def) {
    def.points_m.reserve(static_cast<std::size_t>(particles));
    def.origin_m = points.at(0).pair(kCoordinate, kPoints);
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles); ++i) {
        def.points_m.push_back(points.at(i).pair(kCoordinate, kPoints) - def.origin_m);
    }
    refuse_short_bars(points, def, reach);
}

void require_one_shape(const TableReader& rope) {
    std::vector<std::string_view> given;
    std::copy_if(kShapes.begin(), kShapes.end(), std::back_inserter(given),
                 [&](std::string_view shape) { return rope.has(shape); });
    if (given.size() == 1) return;
    if (given.empty()) rope.fail("the rope has no shape; give one of: line, hang, points");
    rope.fail(fmt::format("the rope has {} shapes ({}); keep one of them", given.size(), joined(given)));
}

std::int64_t read_particle_count(const TableReader& rope) {
    require_one_shape(rope);
    if (rope.has("line")) {
        constexpr std::string_view kRemedy = "give a number of particles, at least 2";
        return rope.table("line", kLine)
            .require("particles", kRemedy)
            .integer(2, Limits::kParticles, kRemedy);
    }
    if (rope.has("hang")) {
        constexpr std::string_view kRemedy = "give a number of links, at least 1";
        return 1 + rope.table("hang", kHang)
                       .require("links", kRemedy)
                       .integer(1, Limits::kParticles - 1, kRemedy);
    }
    const Value points = rope.require("points", kPoints);
    const std::size_t count = points.size(kPoints);
    if (count < 2) points.fail(fmt::format("{} points are no rope; {}", count, kPoints));
    return static_cast<std::int64_t>(count);
}

bool is_closed(const TableReader& rope, std::int64_t particles) {
    const auto closed = rope.find("closed");
    if (!closed || !closed->boolean("give true or false")) return false;
    if (!rope.has("points")) {
        closed->fail(
            "the closing link of a straight rope would lie on its others; give points, or remove it");
    }
    if (particles < 3) closed->fail("2 points close to no ring; give at least 3, or remove it");
    return true;
}

}  // namespace

BodySize read_rope_size(const TableReader& rope, int reach) {
    const std::int64_t particles = read_particle_count(rope);
    const std::uint64_t bars = sim::bar_count(static_cast<std::uint64_t>(particles),
                                              static_cast<std::uint64_t>(reach), is_closed(rope, particles));
    return {particles, static_cast<std::int64_t>(bars)};
}

void read_shape(const TableReader& rope, std::int64_t particles, int reach, sim::RopeDef& def) {
    if (rope.has("line")) {
        read_line(rope.table("line", kLine), particles, def);
    } else if (rope.has("hang")) {
        read_hang(rope.table("hang", kHang), particles, def);
    } else {
        read_points(rope.require("points", kPoints), particles, reach, def);
    }
}

}  // namespace corda::scene
