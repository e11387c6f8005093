#include "benchmark/study/reference/ropes.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "corda/sim/defs.hpp"

namespace corda::reference {

RopeDef rope_through(std::vector<Vec2> points_m) {
    RopeDef rope;
    rope.mass_kg.assign(points_m.size(), 1.0);
    rope.velocity_m_s.assign(points_m.size(), {});
    rope.points_m = std::move(points_m);
    return rope;
}

RopeDef straight_rope(int links, double length_m, double angle_deg) {
    const double angle = angle_deg * std::numbers::pi / 180.0;
    Vec2 along{std::sin(angle), -std::cos(angle)};
    if (angle_deg == 90.0) along = {1.0, 0.0};
    if (angle_deg == 180.0) along = {0.0, 1.0};
    std::vector<Vec2> points_m;
    for (int i = 0; i <= links; ++i) points_m.push_back((i * length_m / links) * along);
    return rope_through(std::move(points_m));
}

RopeDef released_rope(const ReleasedChain& row) {
    RopeDef rope = straight_rope(row.links, row.length_m, row.angle_deg);
    rope.mass_kg.back() = row.tip_mass_kg;
    return rope;
}

RopeDef report_rope(int particles) {
    std::vector<Vec2> points_m;
    for (int i = 0; i < particles; ++i) points_m.push_back({0.1 * i, -1.0 * i});
    return rope_through(std::move(points_m));
}

RopeDef folded_rope(int links) {
    const double link_m = 1.0 / links;
    std::vector<Vec2> points_m;
    for (int i = 0; i <= links / 2; ++i) points_m.push_back({0.0, -link_m * i});
    for (int i = links / 2; i >= 0; --i) points_m.push_back({link_m, -link_m * i});
    return rope_through(std::move(points_m));
}

RopeDef slack_rope(int links) {
    const double depth_m = std::sqrt(0.75 * 0.75 - 0.5 * 0.5);
    std::vector<Vec2> points_m;
    for (int i = 0; i <= links; ++i) {
        // Computed from the nearer pin, so that both halves have the same bits.
        const double along = 2.0 * std::min(i, links - i) / links;
        points_m.push_back({2 * i <= links ? 0.5 * along : 1.0 - 0.5 * along, -depth_m * along});
    }
    RopeDef rope = rope_through(std::move(points_m));
    rope.pinned = {0, static_cast<std::uint32_t>(links)};
    return rope;
}

RopeDef spinning_rope(int links, double length_m, double omega_1_s) {
    RopeDef rope = straight_rope(links, length_m, 90.0);
    for (std::size_t i = 0; i < rope.points_m.size(); ++i)
        rope.velocity_m_s[i] = {0.0, omega_1_s * rope.points_m[i].x};
    return rope;
}

double length_m(const RopeDef& rope) {
    double sum_m = 0.0;
    for (std::size_t i = 1; i < rope.points_m.size(); ++i) {
        const Vec2 link = rope.points_m[i] - rope.points_m[i - 1];
        sum_m += sim::length(link.x, link.y);
    }
    return sum_m;
}

}  // namespace corda::reference
