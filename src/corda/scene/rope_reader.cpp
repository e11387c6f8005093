#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "corda/core/direction.hpp"
#include "corda/scene/field.hpp"
#include "corda/scene/readers.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

namespace corda::scene {
namespace {

constexpr std::array<std::string_view, 3> kShapes{"line", "hang", "points"};

double distance_m(Vec2 a, Vec2 b) {
    return sim::length(b.x - a.x, b.y - a.y);
}

/// Whether particle `i` lies inside the limits; a straight rope does if its last one does.
bool check_point(const TableReader& shape, const RopeDef& def, std::size_t i) {
    const Vec2 at = def.origin_m + def.points_m[i];
    if (std::max(std::abs(at.x), std::abs(at.y)) <= Limits::kCoordinateMetres) return true;
    const std::string which =
        i + 1 == def.points_m.size() ? "the last particle" : fmt::format("particle {}", i);
    shape.add_problem(fmt::format("{} is at [{}, {}], beyond the limit of {:g} m", which, at.x, at.y,
                                  Limits::kCoordinateMetres),
                      "make the rope shorter");
    return false;
}

bool read_line(const TableReader& table, RopeDef& def, ShapeDef& shape) {
    LineDef line;
    read_fields(table, line);
    const auto step = table.find("step");
    if (!step) return false;
    if (distance_m({}, line.step_m) < kMinBarMetres) {
        step->add_problem(fmt::format("[{}, {}] is no distance", line.step_m.x, line.step_m.y),
                          fmt::format("give a step of at least {} m", number_text(kMinBarMetres)));
        return false;
    }
    place(line, def);
    shape = line;
    return check_point(table, def, def.points_m.size() - 1);
}

/// Whether a list of the arms has one number per link.
bool has_one_per_link(const TableReader& table, std::string_view key, std::size_t links) {
    const auto list = table.find(key);
    if (!list || list->size() == links) return true;
    list->add_problem(fmt::format("{} values for {} lengths", list->size(), links), "give one per link");
    return false;
}

bool read_arms(const TableReader& rope, const TableReader& table, RopeDef& def, ShapeDef& shape) {
    for (const char* const key : {"links", "particles", "length", "angle_deg"}) {
        if (const auto other = table.find(key))
            other->add_problem(fmt::format("{} is of a straight rope, and lengths of one of arms", key),
                               "keep one of them");
    }
    if (!table.is_given("angles_deg")) table.add_missing("angles_deg");
    ArmsDef arms;
    read_fields(table, arms);
    const bool has_rates = table.is_given("rates_deg_s");
    if (const auto velocity = rope.find("velocity"); velocity && has_rates)
        velocity->add_problem("hang.rates_deg_s gives the velocities, too", "keep one of them");
    const bool have_sizes = has_one_per_link(table, "angles_deg", arms.lengths_m.size()) &&
                            has_one_per_link(table, "rates_deg_s", arms.lengths_m.size());
    if (!have_sizes || !table.has("angles_deg") || table.has("rates_deg_s") != has_rates) return false;
    place(arms, def);
    for (std::size_t i = 0; i < def.points_m.size(); ++i)
        if (!check_point(table, def, i)) return false;
    if (has_rates) def.velocity_m_s = velocities_m_s(arms);
    shape = arms;
    return true;
}

bool read_hang(const TableReader& table, RopeDef& def, ShapeDef& shape) {
    if (!table.is_given("length")) table.add_missing("length");
    HangDef hang;
    read_fields(table, hang);
    const auto length = table.find("length");
    if (!length || hang.links < 1) return false;
    if (hang.length_m / hang.links < kMinBarMetres) {
        length->add_problem(
            fmt::format("{} m are less than {} m per link", hang.length_m, number_text(kMinBarMetres)),
            "make the rope longer");
        return false;
    }
    place(hang, def);
    shape = hang;
    return check_point(table, def, def.points_m.size() - 1);
}

/// Adds the problem of a bar without length between points `first` < `last`, `stride` links apart.
void refuse_short_bar(const Value& points, std::size_t first, std::size_t last, std::size_t stride,
                      bool closes, int reach) {
    const Value point = points.at(last);
    const std::string coincide = fmt::format("points {} and {} coincide", first, last);
    if (stride > 1)
        point.add_problem(fmt::format("{}, and the solver's reach = {} ties them by a bar, which has no "
                                      "direction",
                                      coincide, reach),
                          fmt::format("move one, or give a reach below {}", stride));
    else if (closes)
        point.add_problem(coincide,
                          "leave this one out, because closed = true ties the last point to the first");
    else
        point.add_problem(coincide + ", and a link without length has no direction", "move one");
}

/// Returns true if no bar has the length 0; otherwise the first of them is a problem. A link that hangs slack
/// may have its ends at one place (`has_rest_lengths`).
bool check_short_bars(const Value& points, const RopeDef& def, bool has_rest_lengths) {
    const std::size_t count = def.points_m.size();
    const std::size_t longest =
        std::min(static_cast<std::size_t>(def.reach), def.closed ? count / 2 : count - 1);
    for (std::size_t k = has_rest_lengths && def.material.is_string ? 2 : 1; k <= longest; ++k) {
        for (std::size_t a = 0; a < (def.closed ? count : count - k); ++a) {
            const std::size_t b = (a + k) % count;
            if (distance_m(def.points_m[a], def.points_m[b]) >= kMinBarMetres) continue;
            const auto [first, last] = std::minmax(a, b);
            refuse_short_bar(points, first, last, k, b < a, def.reach);
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
        rope.add_problem("the rope has no shape", fmt::format("give one of: {}", fmt::join(kShapes, ", ")));
    const auto here = std::ranges::count_if(given, [&](std::string_view shape) { return rope.has(shape); });
    if (here > 1)  // a misspelt key has a problem already
        rope.add_problem(fmt::format("the rope has {} shapes ({})", given.size(), fmt::join(given, ", ")),
                         "keep one of them");
    return given.size() == 1;
}

bool refuses_arms_without_lengths(const TableReader& hang) {
    for (const char* const key : {"angles_deg", "rates_deg_s"}) {
        const auto list = hang.find(key);
        if (!list) continue;
        list->add_problem(fmt::format("{} is of a rope of arms, which has lengths", key),
                          "give lengths, one per link, in place of links and length");
        return true;
    }
    return false;
}

/// The number of particles; 0 if it is unknown.
std::int64_t read_particle_count(const TableReader& rope) {
    std::int64_t particles = 0;
    rope.table("line").read("particles", particles);
    if (particles > 0) return particles;
    if (rope.has("hang")) {
        const TableReader hang = rope.table("hang");
        if (hang.is_given("lengths")) {
            const auto lengths = hang.find("lengths");
            return lengths ? static_cast<std::int64_t>(lengths->size()) + 1 : 0;
        }
        if (refuses_arms_without_lengths(hang)) return 0;
        std::int64_t links = 0;
        hang.read("links", links);
        hang.read("particles", particles);
        if (hang.is_given("links") == hang.is_given("particles"))
            hang.add_problem(links > 0 ? "links and particles are both given"
                                       : "give links, the number of links, or particles",
                             links > 0 ? "keep one of them" : "");
        else if (links > 0)
            particles = links + 1;
        return particles;
    }
    const auto points = rope.find("points");
    return points ? static_cast<std::int64_t>(points->size()) : 0;
}

bool read_closed(const TableReader& rope, std::int64_t particles) {
    bool closed = false;
    rope.read("closed", closed);
    if (!closed) return false;
    const Value value = *rope.find("closed");
    if (!rope.has("points"))
        value.add_problem("the closing link of a straight rope would lie on its others",
                          "give points, or remove it");
    if (particles < 3) value.add_problem("2 points close to no ring", "give at least 3, or remove it");
    return particles >= 3;
}

/// A string's link may be shorter than the distance that it spans by this share of it: lengths are written
/// with fewer digits than distances have.
constexpr double kLengthSlack = 1e-9;

void refuse_contradictions(const TableReader& rope, const RopeDef& def) {
    if (!def.material.is_string) return;
    if (def.bending_n_m2 > 0.0) {
        rope.find("bending")->add_problem("a string hangs slack, and so has no bending stiffness",
                                          "remove bending or string");
    }
    if (def.closed && def.material.compliance_1_n == 0.0 && rope.is_sound("compliance")) {
        rope.find("string")->add_problem("a closed rope can only hang slack if it stretches",
                                         "give a compliance, or remove string or closed");
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
                        "and which a string that does not stretch cannot span",
                        rest_m, distance_m, k, k + 1),
            "give at least that, or a compliance");
    }
    return rest_m;
}

void read_link_lengths(const TableReader& rope, RopeDef& def) {
    const auto value = rope.find("link_length");
    if (!value || !rope.is_sound("compliance") || !rope.is_sound("string")) return;
    if (def.material.compliance_1_n == 0.0 && !def.material.is_string) {
        value->add_problem(
            "links that neither stretch nor hang slack are as long as their particles are apart at the start",
            "give compliance or string = true, or remove it");
        return;
    }
    const std::size_t links = def.closed ? def.points_m.size() : def.points_m.size() - 1;
    if (value->is_list() && value->size() != links) {
        value->add_problem(fmt::format("{} values for {} links", value->size(), links), "give one per link");
        return;
    }
    def.rest_m.reserve(links);
    const LinkRange between = links_between_pins(def);
    for (std::size_t k = 0; k < links; ++k) {
        const Value entry = value->is_list() ? value->at(k) : *value;
        def.rest_m.push_back(read_link_length(entry, def, between.contains(k), k));
    }
}

/// The positions of a rope's particles; `closed` and `reach` are set. Returns whether it has them.
bool read_rope_shape(const TableReader& rope, RopeDef& def, ShapeDef& shape) {
    refuse_origin(rope);
    if (rope.has("line")) return read_line(rope.table("line"), def, shape);
    if (rope.has("hang")) {
        const TableReader hang = rope.table("hang");
        return hang.is_given("lengths") ? read_arms(rope, hang, def, shape) : read_hang(hang, def, shape);
    }
    read_points(rope, def.origin_m, def.points_m);
    return check_short_bars(*rope.find("points"), def, rope.is_given("link_length"));
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

RopeDef read_rope(const TableReader& rope, const std::optional<BodySize>& size, int reach, ShapeDef& shape) {
    RopeDef def;
    def.reach = reach;
    read_fields(rope, def);
    refuse_contradictions(rope, def);
    if (!size) return def;
    def.mass_kg = read_mass(rope, size->particles);
    def.velocity_m_s = read_velocity(rope, size->particles);
    const auto index_of = [&](const Value& entry) {
        return read_index(entry, size->particles, "the rope has particles");
    };
    if (const auto pinned = rope.find("pinned")) def.pinned = read_pinned(*pinned, size->particles, index_of);
    def.moves = read_moves(rope, def.pinned, index_of);
    def.releases = read_releases(rope, def.pinned, index_of);
    def.cuts = read_cuts(rope, def.closed ? size->particles : size->particles - 1);
    if (def.closed && def.cuts.size() > 1)
        rope.tables("cut")[1].add_problem("a closed rope is cut once; it is open from then on",
                                          "give one cut, or an open rope");
    if (read_rope_shape(rope, def, shape)) read_link_lengths(rope, def);
    return def;
}

}  // namespace corda::scene

namespace corda {

void place(const LineDef& line, RopeDef& rope) {
    rope.origin_m = line.from_m;
    rope.points_m.clear();
    rope.points_m.reserve(static_cast<std::size_t>(line.particles));
    for (int i = 0; i < line.particles; ++i)
        rope.points_m.push_back(Vec2{} + static_cast<double>(i) * line.step_m);  // 0 + turns -0 into 0
}

void place(const HangDef& hang, RopeDef& rope) {
    const Direction direction = direction_of(hang.angle_deg);
    rope.origin_m = hang.from_m;
    rope.points_m.clear();
    rope.points_m.reserve(static_cast<std::size_t>(hang.links) + 1);
    for (int i = 0; i <= hang.links; ++i) {
        const double along_m = static_cast<double>(i) * hang.length_m / static_cast<double>(hang.links);
        // 0 + and 0 - give the zeros of a straight rope one sign.
        rope.points_m.push_back({0.0 + along_m * direction.sine, 0.0 - along_m * direction.cosine});
    }
}

void place(const ArmsDef& arms, RopeDef& rope) {
    rope.origin_m = arms.from_m;
    rope.points_m.assign(1, {});
    for (std::size_t k = 0; k < arms.lengths_m.size(); ++k) {
        const Direction direction = direction_of(arms.angles_deg[k]);
        const double length_m = arms.lengths_m[k];
        rope.points_m.push_back(rope.points_m.back() +
                                Vec2{0.0 + length_m * direction.sine, 0.0 - length_m * direction.cosine});
    }
}

std::vector<Vec2> velocities_m_s(const ArmsDef& arms) {
    constexpr double kRadians = std::numbers::pi / 180.0;
    std::vector<Vec2> velocities(1);
    for (std::size_t k = 0; k < arms.lengths_m.size(); ++k) {
        const Direction direction = direction_of(arms.angles_deg[k]);
        const double speed_m_s = arms.lengths_m[k] * (kRadians * arms.rates_deg_s[k]);
        velocities.push_back(velocities.back() +
                             Vec2{0.0 + speed_m_s * direction.cosine, 0.0 + speed_m_s * direction.sine});
    }
    return velocities;
}

}  // namespace corda
