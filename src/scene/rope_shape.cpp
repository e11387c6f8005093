#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "corda/core/direction.hpp"
#include "corda/scene/readers.hpp"
#include "corda/sim/distance.hpp"
#include "corda/sim/system.hpp"

namespace corda::scene {
namespace {

constexpr std::array<std::string_view, 3> kShapes{"line", "hang", "points"};

double distance_m(Vec2 a, Vec2 b) {
    return sim::length(b.x - a.x, b.y - a.y);
}

/// A straight rope lies inside the limits if both of its ends do.
bool check_last_point(const TableReader& shape, const RopeDef& def) {
    const Vec2 last = def.origin_m + def.points_m.back();
    if (std::max(std::abs(last.x), std::abs(last.y)) <= Limits::kCoordinateMetres) return true;
    shape.add_problem(
        fmt::format("the last particle is at [{}, {}], beyond the limit of {:g} m; make the rope shorter",
                    last.x, last.y, Limits::kCoordinateMetres));
    return false;
}

bool read_line(const TableReader& line, std::int64_t particles, RopeDef& def) {
    const auto step_value = line.find("step");
    if (!step_value) return false;
    const auto step = step_value->as<Vec2>();
    if (distance_m({}, step) < kMinBarMetres) {
        step_value->add_problem(fmt::format("[{}, {}] is no distance; give a step of at least {} m", step.x,
                                            step.y, number_text(kMinBarMetres)));
        return false;
    }
    line.read("from", def.origin_m);
    def.points_m.reserve(static_cast<std::size_t>(particles));
    for (std::int64_t i = 0; i < particles; ++i) {
        def.points_m.push_back(Vec2{} + static_cast<double>(i) * step);  // 0 + turns -0 into 0
    }
    return check_last_point(line, def);
}

bool read_hang(const TableReader& hang, std::int64_t particles, RopeDef& def) {
    const auto length_value = hang.find("length");
    if (!length_value) return false;
    const auto links = static_cast<double>(particles - 1);
    const auto length_m = length_value->as<double>();
    if (length_m / links < kMinBarMetres) {
        length_value->add_problem(fmt::format("{} m are less than {} m per link; make the rope longer",
                                              length_m, number_text(kMinBarMetres)));
        return false;
    }
    double angle_deg = 0.0;
    hang.read("angle_deg", angle_deg);
    const Direction direction = direction_of(angle_deg);
    hang.read("from", def.origin_m);
    def.points_m.reserve(static_cast<std::size_t>(particles));
    for (std::int64_t i = 0; i < particles; ++i) {
        const double along_m = static_cast<double>(i) * length_m / links;
        // 0 + and 0 - give the zeros of a straight rope one sign.
        def.points_m.push_back({0.0 + along_m * direction.sine, 0.0 - along_m * direction.cosine});
    }
    return check_last_point(hang, def);
}

/// Why a bar between points `first` < `last`, `stride` links apart, cannot have no length.
std::string short_bar_problem(std::size_t first, std::size_t last, std::size_t stride, bool closes,
                              int reach) {
    const std::string coincide = fmt::format("points {} and {} coincide", first, last);
    if (stride > 1) {
        return fmt::format(
            "{}, and the solver's reach = {} ties them by a bar, which has no direction; move one, or give "
            "a reach below {}",
            coincide, reach, stride);
    }
    return coincide + (closes ? "; leave this one out, because closed = true ties the last point to the first"
                              : ", and a link without length has no direction; move one");
}

/// Whether no bar has the length 0; otherwise the first of them is a problem. A link that hangs slack may
/// have its ends at one place (`has_rest_lengths`).
bool check_short_bars(const Value& points, const RopeDef& def, bool has_rest_lengths) {
    const std::size_t count = def.points_m.size();
    const std::size_t longest =
        std::min(static_cast<std::size_t>(def.reach), def.closed ? count / 2 : count - 1);
    for (std::size_t k = has_rest_lengths && def.material.is_string ? 2 : 1; k <= longest; ++k) {
        for (std::size_t a = 0; a < (def.closed ? count : count - k); ++a) {
            const std::size_t b = (a + k) % count;
            if (distance_m(def.points_m[a], def.points_m[b]) >= kMinBarMetres) continue;
            const auto [first, last] = std::minmax(a, b);
            points.at(last).add_problem(short_bar_problem(first, last, k, b < a, def.reach));
            return false;
        }
    }
    return true;
}

bool has_one_shape(const TableReader& rope) {
    std::vector<std::string_view> given;
    std::copy_if(kShapes.begin(), kShapes.end(), std::back_inserter(given),
                 [&](std::string_view shape) { return rope.is_given(shape); });
    if (given.empty())
        rope.add_problem(fmt::format("the rope has no shape; give one of: {}", fmt::join(kShapes, ", ")));
    const auto here =
        std::count_if(given.begin(), given.end(), [&](std::string_view shape) { return rope.has(shape); });
    if (here > 1)  // of a shape beside a misspelt key one is told enough
        rope.add_problem(fmt::format("the rope has {} shapes ({}); keep one of them", given.size(),
                                     fmt::join(given, ", ")));
    return given.size() == 1;
}

/// 0 if it is not known.
std::int64_t read_particle_count(const TableReader& rope) {
    std::int64_t particles = 0;
    rope.table("line").read("particles", particles);
    if (particles > 0) return particles;
    std::int64_t links = 0;
    rope.table("hang").read("links", links);
    if (links > 0) return links + 1;
    const auto points = rope.find("points");
    return points ? static_cast<std::int64_t>(points->size()) : 0;
}

bool read_closed(const TableReader& rope, std::int64_t particles) {
    bool closed = false;
    rope.read("closed", closed);
    if (!closed) return false;
    const auto fail = [&](std::string_view problem) { rope.find("closed")->add_problem(problem); };
    if (!rope.has("points"))
        fail("the closing link of a straight rope would lie on its others; give points, or remove it");
    if (particles < 3) fail("2 points close to no ring; give at least 3, or remove it");
    return particles >= 3;
}

}  // namespace

std::optional<BodySize> read_rope_size(const TableReader& rope, int reach) {
    const std::int64_t particles = has_one_shape(rope) ? read_particle_count(rope) : 0;
    if (particles == 0) return std::nullopt;
    const bool closed = read_closed(rope, particles);
    const std::uint64_t bars =
        bar_count(static_cast<std::uint64_t>(particles), static_cast<std::uint64_t>(reach), closed);
    return BodySize{particles, static_cast<std::int64_t>(bars)};
}

bool read_rope_shape(const TableReader& rope, std::int64_t particles, RopeDef& def) {
    refuse_origin(rope);
    if (rope.has("line")) return read_line(rope.table("line"), particles, def);
    if (rope.has("hang")) return read_hang(rope.table("hang"), particles, def);
    read_points(rope, def.origin_m, def.points_m);
    return check_short_bars(*rope.find("points"), def, rope.is_given("link_length"));
}

}  // namespace corda::scene
