#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "support/estimate_families.hpp"

namespace corda::test {
namespace {

void add_velocities(Random& random, RopeDef& rope, double most_m_s) {
    for (std::size_t i = 0; i < rope.points_m.size(); ++i)
        rope.velocity_m_s.push_back(
            {pick_real(random, -most_m_s, most_m_s), pick_real(random, -most_m_s, most_m_s)});
}

/// Rest lengths: some equal to the links' lengths, the others longer.
void add_slack(Random& random, RopeDef& rope, double most) {
    for (std::size_t k = 0; k + 1 < rope.points_m.size(); ++k) {
        const Vec2 link = rope.points_m[k + 1] - rope.points_m[k];
        const double stretch = pick(random, 0, 2) == 0 ? 1.0 : pick_real(random, 1.01, most);
        rope.rest_m.push_back(std::hypot(link.x, link.y) * stretch);
    }
}

/// Rigid links that go slack and snap.
RopeDef string_rope(Random& random, int most_links) {
    RopeDef rope = crooked_rope(random, pick(random, 1, most_links), any_angle(random), 1.5);
    rope.material.is_string = true;
    add_slack(random, rope, 1.5);
    add_velocities(random, rope, 2.0);
    return rope;
}

EstimateCase string_few(Random& random) {
    return one_rope(random, string_rope(random, 4), 2.0);
}

EstimateCase string_many(Random& random) {
    RopeDef rope = string_rope(random, 9);
    if (pick(random, 0, 1) == 0) {
        for (std::size_t i = 0; i < rope.points_m.size(); ++i)
            rope.mass_kg.push_back(pick_log(random, 0.1, 5.0));
    }
    return one_rope(random, rope, 2.0);
}

/// Taut at the start, like a rope of the same shape, and high enough to go slack.
EstimateCase string_swing(Random& random) {
    const double angle = (pick(random, 0, 1) == 0 ? 1.0 : -1.0) * pick_real(random, 1.2, 2.6);
    RopeDef rope = crooked_rope(random, pick(random, 1, 4), angle, 0.3);
    rope.material.is_string = true;
    return one_rope(random, rope, 3.0);
}

EstimateCase string_thrown(Random& random) {
    RopeDef rope = string_rope(random, 4);
    rope.pinned = {};
    return one_rope(random, rope, 2.0);
}

/// A slack string whose particles fall freely from the start until a link snaps.
struct Falling {
    RopeDef rope;

    [[nodiscard]] double distance_m(std::size_t link, double time_s) const {
        const Vec2 apart = position_m(link + 1, time_s) - position_m(link, time_s);
        return std::hypot(apart.x, apart.y);
    }
    [[nodiscard]] double largest_m(std::size_t link, double until_s) const {
        double largest = 0.0;
        for (int i = 0; i <= 1000; ++i) largest = std::max(largest, distance_m(link, 1e-3 * i * until_s));
        return largest;
    }

  private:
    [[nodiscard]] Vec2 position_m(std::size_t i, double time_s) const {
        for (const std::uint32_t pin : rope.pinned) {
            if (pin == i) return rope.points_m[i];
        }
        return rope.points_m[i] + time_s * rope.velocity_m_s[i] + Vec2{0.0, -0.5 * 9.81 * time_s * time_s};
    }
};

Falling falling_string(Random& random, int links) {
    Falling falling{crooked_rope(random, links, any_angle(random), 1.5)};
    falling.rope.material.is_string = true;
    add_velocities(random, falling.rope, 2.0);
    if (links > 1 && pick(random, 0, 2) == 0) falling.rope.pinned = {0, static_cast<std::uint32_t>(links)};
    return falling;
}

/// A length from below the rounding of a metre to far above it, or 0, of either sign.
double tiny_m(Random& random, double most_m) {
    const double size_m = pick(random, 0, 7) == 0 ? 0.0 : pick_log(random, 1e-17, most_m);
    return pick(random, 0, 1) == 0 ? size_m : -size_m;
}

EstimateCase without_drag(EstimateCase made) {
    made.scene.world.drag_1_s = 0.0;
    return made;
}

/// Two links that share a particle snap almost at once, the first of the string to do so.
EstimateCase near_snaps(Random& random) {
    constexpr double kRisesBy = 1e-3;
    for (;;) {
        const int links = pick(random, 2, 4);
        Falling falling = falling_string(random, links);
        const auto first = static_cast<std::size_t>(pick(random, 0, links - 2));
        const double snap_s = pick_real(random, 0.1, 0.6);
        bool both_rise = true;
        for (std::size_t k = 0; k < static_cast<std::size_t>(links); ++k) {
            const bool snaps = k == first || k == first + 1;
            const double rest_m = falling.distance_m(k, snap_s);
            if (snaps && falling.largest_m(k, 0.99 * snap_s) > rest_m * (1.0 - kRisesBy)) both_rise = false;
            falling.rope.rest_m.push_back(snaps ? rest_m + tiny_m(random, 1e-7)
                                                : 1.3 * falling.largest_m(k, snap_s));
        }
        if (both_rise) return without_drag(one_rope(random, falling.rope, snap_s + 0.5));
    }
}

/// A string between two pins that is its own mirror image, all slack and of equal lengths, or taut and thrown
/// up. It hangs steeper than at 45 degrees: flatter links would snap in turn until the particle rests,
/// whichever was first. The truth's points differ by less than the rounding of those of the scene.
EstimateCase equal_snaps(Random& random) {
    const bool is_taut = pick(random, 0, 2) == 0;
    const int half = is_taut ? 1 : pick(random, 1, 2);
    const double width_m = pick_real(random, 0.2, 0.6);
    Falling falling;
    RopeDef& rope = falling.rope;
    rope.material.is_string = true;
    rope.pinned = {0, static_cast<std::uint32_t>(2 * half)};
    const double speed_m_s = is_taut ? pick_real(random, 0.5, 3.0) : pick_real(random, -2.0, 2.0);
    const double across_m_s = pick_real(random, -1.0, 1.0);
    std::vector<double> drop_m{0.0};
    for (int i = 1; i <= half; ++i) {
        const double slope = is_taut ? pick_real(random, 1.2, 2.0) : pick_real(random, -0.3, 0.3);
        drop_m.push_back(drop_m.back() + slope * width_m / half);
    }
    for (int i = -half; i <= half; ++i) {
        const int from_end = half - std::abs(i);
        rope.points_m.push_back({width_m * i / half, -drop_m[static_cast<std::size_t>(from_end)]});
        const double side = std::abs(i) == half || i == 0 ? 0.0 : (i < 0 ? 1.0 : -1.0);
        rope.velocity_m_s.push_back({side * across_m_s, std::abs(i) == half ? 0.0 : speed_m_s});
    }
    const double stretch = is_taut ? 1.0 : pick_real(random, 1.6, 2.2);
    for (std::size_t k = 0; k < static_cast<std::size_t>(half); ++k)
        rope.rest_m.push_back(stretch * falling.distance_m(k, 0.0));
    for (int k = half; k-- > 0;) rope.rest_m.push_back(rope.rest_m[static_cast<std::size_t>(k)]);
    EstimateCase made = without_drag(one_rope(random, rope, 1.5));
    for (const Vec2& point : rope.points_m) made.start.push_back(point.x);
    for (const Vec2& point : rope.points_m) made.start.push_back(point.y);
    made.start[static_cast<std::size_t>(half)] += ExtendedMotion::Real{1e-16L} * pick_real(random, -1.0, 1.0);
    return made;
}

/// A link that just reaches its rest length, or just does not, and returns.
EstimateCase grazing_snap(Random& random) {
    constexpr double kDuration = 1.0;
    for (;;) {
        const int links = pick(random, 1, 3);
        Falling falling = falling_string(random, links);
        const auto grazing = static_cast<std::size_t>(pick(random, 0, links - 1));
        double top_s = 0.0;
        bool turns = false;
        for (int i = 1; i < 800 && !turns; ++i) {
            const bool is_top = falling.distance_m(grazing, 1e-3 * i) > falling.distance_m(grazing, top_s);
            turns = !is_top && top_s > 0.05;
            if (is_top) top_s = 1e-3 * i;
        }
        if (!turns || falling.distance_m(grazing, top_s) < 1.001 * falling.distance_m(grazing, 0.0)) continue;
        double low_s = top_s - 2e-3;
        double high_s = top_s + 2e-3;
        for (int i = 0; i < 60; ++i) {
            const double third_s = (high_s - low_s) / 3.0;
            const bool rises =
                falling.distance_m(grazing, low_s + third_s) < falling.distance_m(grazing, high_s - third_s);
            (rises ? low_s : high_s) += rises ? third_s : -third_s;
        }
        for (std::size_t k = 0; k < static_cast<std::size_t>(links); ++k) {
            falling.rope.rest_m.push_back(k == grazing ? falling.distance_m(k, low_s) - tiny_m(random, 1e-5)
                                                       : 1.1 * falling.largest_m(k, kDuration));
        }
        return without_drag(one_rope(random, falling.rope, kDuration));
    }
}

RopeDef bungee_rope(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 1, 5), any_angle(random), 1.5);
    rope.material.is_string = true;
    rope.material.compliance_1_n = pick_log(random, 1e-5, 1e-2);
    add_slack(random, rope, 1.3);
    return rope;
}

EstimateCase bungee(Random& random) {
    RopeDef rope = bungee_rope(random);
    if (pick(random, 0, 1) == 0) add_velocities(random, rope, 2.0);
    return one_rope(random, rope, 2.0);
}

RopeDef ring_rope(Random& random) {
    const int links = pick(random, 4, 12);
    RopeDef rope;
    const double flat = pick_real(random, 0.5, 0.9);
    for (int i = 0; i < links; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / links;
        rope.points_m.push_back(
            {flat * std::sin(angle), std::cos(angle) + 0.1 * pick_real(random, -1.0, 1.0)});
    }
    rope.closed = true;
    return rope;
}

EstimateCase ring(Random& random) {
    return one_rope(random, ring_rope(random), 1.0);
}

EstimateCase elastic_ring(Random& random) {
    RopeDef rope = ring_rope(random);
    rope.material.compliance_1_n = pick_log(random, 1e-5, 1e-2);
    rope.material.is_string = pick(random, 0, 2) == 0;
    return one_rope(random, rope, 1.0);
}

/// A closed polygon with bars from one particle to others, which make it movable, rigid, or overdetermined.
EstimateCase braced(Random& random) {
    const RopeDef rope = ring_rope(random);
    const auto count = static_cast<std::uint32_t>(rope.points_m.size());
    NetDef net;
    net.points_m = rope.points_m;
    net.pinned = {0};
    for (std::uint32_t i = 0; i < count; ++i) net.bars.push_back({i, (i + 1) % count});
    for (std::uint32_t i = 2; i + 1 < count; ++i) {
        if (pick(random, 0, 2) != 0) net.bars.push_back({0, i});
    }
    return one_net(random, net, 1.0);
}

NetDef grid(Random& random, int columns, int rows) {
    NetDef net;
    const auto index = [&](int column, int row) {
        return static_cast<std::uint32_t>(row * columns + column);
    };
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            net.points_m.push_back({column + 0.3 * row + 0.1 * pick_real(random, -1.0, 1.0),
                                    -row + 0.1 * pick_real(random, -1.0, 1.0)});
            if (column > 0) net.bars.push_back({index(column - 1, row), index(column, row)});
            if (row > 0) net.bars.push_back({index(column, row - 1), index(column, row)});
        }
    }
    net.pinned = {0};
    return net;
}

NetDef grid(Random& random) {
    const int columns = pick(random, 2, 4);
    const int rows = pick(random, 2, 4);
    return grid(random, columns, rows);
}

/// A net whose cells are parallelograms, on a pin, on a row of pins, or free.
EstimateCase parallelograms(Random& random) {
    NetDef net = grid(random);
    const auto is_below = [](const NetBar& bar) { return bar.b != bar.a + 1; };
    const std::size_t columns = std::find_if(net.bars.begin(), net.bars.end(), is_below)->b;
    std::vector<Vec2>& at = net.points_m;
    for (std::size_t i = 0; i < at.size(); ++i) {
        const std::size_t column = i % columns;
        if (i > column && column > 0) at[i] = at[i - 1] + at[column] - at[column - 1];
        net.velocity_m_s.push_back({pick_real(random, -0.5, 0.5), pick_real(random, -0.5, 0.5)});
    }
    const int pins = pick(random, 0, 2);
    if (pins == 0) net.pinned = {};
    for (std::uint32_t i = 1; pins == 2 && i < columns; ++i) net.pinned.push_back(i);
    return one_net(random, net, 0.2);  // before a cell is in line, where the truth takes tiny steps
}

EstimateCase net(Random& random) {
    return one_net(random, grid(random), 0.5);
}

EstimateCase elastic_net(Random& random) {
    NetDef net = grid(random);
    net.material.compliance_1_n = pick_log(random, 1e-4, 1e-2);
    net.material.is_string = pick(random, 0, 2) == 0;
    return one_net(random, net, 0.5);
}

/// A cloth of light, stiff strings on one or both of its upper corners.
EstimateCase string_cloth(Random& random) {
    const int columns = pick(random, 4, 7);
    const int rows = pick(random, 4, 7);
    NetDef net = grid(random, columns, rows);
    const double spacing_m = pick_log(random, 0.03, 0.3);
    for (Vec2& point : net.points_m) point = spacing_m * point;
    if (pick(random, 0, 2) > 0) net.pinned.push_back(columns - 1);
    net.mass_kg.assign(net.points_m.size(), pick_log(random, 3e-3, 3e-2));
    net.material = {pick_log(random, 1e-4, 1e-3), true};
    return one_net(random, net, 0.5);
}

/// Some of: a rope, a stretching rope, a string or a ring, a bungee.
EstimateCase several(Random& random) {
    EstimateCase made =
        one_rope(random, crooked_rope(random, pick(random, 2, 8), any_angle(random), 1.0), 1.0);
    std::vector<RopeDef>& ropes = made.scene.ropes;
    if (pick(random, 0, 1) == 0) {
        ropes.push_back(crooked_rope(random, pick(random, 1, 4), any_angle(random), 1.0));
        ropes.back().material.compliance_1_n = pick_log(random, 1e-4, 1e-2);
    }
    if (pick(random, 0, 1) == 0) ropes.push_back(bungee_rope(random));
    ropes.push_back(pick(random, 0, 3) == 0 ? ring_rope(random) : string_rope(random, 3));
    for (RopeDef& rope : ropes) {
        const Vec2 place{pick_real(random, -3.0, 3.0), pick_real(random, -3.0, 3.0)};
        for (Vec2& point : rope.points_m) point = point + place;
    }
    return made;
}

/// From micrometres to kilometres, with any gravity and any masses.
EstimateCase units(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 2, 8), any_angle(random), 1.0);
    const double scale = pick_log(random, 1e-6, 1e4);
    const double gravity_m_s2 = pick_log(random, 1e-2, 1e3);
    for (Vec2& point : rope.points_m) point = scale * point;
    const double mass_kg = pick_log(random, 1e-6, 1e6);
    for (std::size_t i = 0; i < rope.points_m.size(); ++i)
        rope.mass_kg.push_back(mass_kg * pick_log(random, 0.5, 2.0));
    const double angle = any_angle(random);
    EstimateCase made = one_rope(random, rope, 5.0 * std::sqrt(scale * 9.81 / gravity_m_s2));
    made.scene.world.gravity_m_s2 = {gravity_m_s2 * std::sin(angle), -gravity_m_s2 * std::cos(angle)};
    made.scene.world.drag_1_s = 0.0;
    const auto rate = static_cast<std::int64_t>(60e3 * std::sqrt(gravity_m_s2 / (9.81 * scale)));
    made.scene.video.fps = FrameRate(Rational{std::clamp<std::int64_t>(rate, 1, 99'999'999), 1000});
    return made;
}

EstimateCase tiny_frames(Random& random) {
    EstimateCase made = one_rope(random, crooked_rope(random, pick(random, 2, 8), any_angle(random), 1.5),
                                 pick_real(random, 0.5, 6.0));
    made.scene.video.width_px = 2 * pick(random, 1, 16);
    made.scene.video.height_px = 2 * pick(random, 1, 16);
    made.scene.solver = AutoDef{pick_log(random, 1e-3, 50.0)};
    return made;
}

EstimateCase odd_rates(Random& random) {
    EstimateCase made = one_rope(random, crooked_rope(random, pick(random, 2, 8), any_angle(random), 1.5),
                                 pick_real(random, 0.5, 4.0));
    made.scene.video.fps = FrameRate(Rational{pick(random, 500, 120'000), pick(random, 900, 1100)});
    return made;
}

EstimateCase much_drag(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 2, 12), any_angle(random), 1.5);
    add_velocities(random, rope, 3.0);
    if (pick(random, 0, 2) == 0) rope.material.compliance_1_n = pick_log(random, 1e-5, 1e-2);
    EstimateCase made = one_rope(random, rope, 5.0);
    made.scene.world.drag_1_s = pick_log(random, 0.3, 30.0);
    return made;
}

/// Rounded points, as in a file, far from (0, 0).
EstimateCase far_away(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 2, 6), any_angle(random), 1.5);
    rope.origin_m = {pick_log(random, 10.0, 1e8), -pick_log(random, 10.0, 1e8)};
    EstimateCase made = one_rope(random, rope, 3.0);
    made.scene.solver = AutoDef{pick_log(random, 1e-7, 1.0)};
    return made;
}

}  // namespace

std::span<const EstimateFamily> other_families() {
    static const auto families = std::to_array<EstimateFamily>({{"string_few", string_few},
                                                                {"string_many", string_many},
                                                                {"string_swing", string_swing},
                                                                {"string_thrown", string_thrown},
                                                                {"near_snaps", near_snaps},
                                                                {"equal_snaps", equal_snaps},
                                                                {"grazing_snap", grazing_snap},
                                                                {"bungee", bungee},
                                                                {"ring", ring},
                                                                {"elastic_ring", elastic_ring},
                                                                {"braced", braced},
                                                                {"net", net},
                                                                {"parallelograms", parallelograms},
                                                                {"elastic_net", elastic_net},
                                                                {"string_cloth", string_cloth},
                                                                {"several", several},
                                                                {"units", units},
                                                                {"tiny_frames", tiny_frames},
                                                                {"odd_rates", odd_rates},
                                                                {"much_drag", much_drag},
                                                                {"far_away", far_away}});
    return families;
}

}  // namespace corda::test
