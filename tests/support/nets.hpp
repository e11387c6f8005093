#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"

namespace corda::test {

/// A closed rope of `particles` unit masses at rest on a circle of radius 1 m; the top one is pinned at the
/// origin.
inline RopeDef ring(int particles) {
    std::vector<Vec2> points_m;
    for (int i = 0; i < particles; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / particles;
        points_m.push_back({std::sin(angle), std::cos(angle) - 1.0});
    }
    RopeDef rope = reference::rope_through(std::move(points_m));
    rope.closed = true;
    return rope;
}

/// The same without a pin, pushed at one particle: only `rattle` keeps its bars at their lengths.
inline RopeDef free_ring(int particles) {
    RopeDef rope = ring(particles);
    rope.pinned = {};
    rope.velocity_m_s.front() = {1.0, 0.5};
    return rope;
}

/// The same on its pin, if it resists bending: `exact` refuses it.
inline RopeDef stiff_ring(int particles) {
    RopeDef rope = ring(particles);
    rope.bending_n_m2 = 0.01;
    return rope;
}

/// A rope as a net of the same particles and links.
inline NetDef as_net(const RopeDef& rope) {
    NetDef net;
    net.points_m = rope.points_m;
    net.pinned = rope.pinned;
    net.moves = rope.moves;
    net.releases = rope.releases;
    for (std::uint32_t i = 0; i + 1 < rope.points_m.size(); ++i) net.bars.push_back({i, i + 1});
    return net;
}

/// A cloth of columns x rows unit masses `spacing_m` apart that hangs from the two ends of its top row, with
/// both diagonals in every square as imaginary bars.
inline NetDef cloth(std::uint32_t columns, std::uint32_t rows, double spacing_m) {
    NetDef net;
    const auto at = [&](std::uint32_t row, std::uint32_t column) { return row * columns + column; };
    for (std::uint32_t r = 0; r < rows; ++r) {
        for (std::uint32_t c = 0; c < columns; ++c) {
            net.points_m.push_back({spacing_m * c, -spacing_m * r});
            if (c + 1 < columns) net.bars.push_back({at(r, c), at(r, c + 1), true});
            if (r + 1 < rows) net.bars.push_back({at(r, c), at(r + 1, c), true});
        }
    }
    for (std::uint32_t r = 0; r + 1 < rows; ++r) {
        for (std::uint32_t c = 0; c + 1 < columns; ++c) {
            net.bars.push_back({at(r, c), at(r + 1, c + 1), false});
            net.bars.push_back({at(r, c + 1), at(r + 1, c), false});
        }
    }
    net.mass_kg.assign(net.points_m.size(), 1.0);
    net.velocity_m_s.assign(net.points_m.size(), {});
    net.pinned = {0, columns - 1};
    return net;
}

/// A net of unit masses, particle r * columns + c at spacing * (c + 0.3 r, -r): leaning to the right; bars
/// along rows, then along columns, then, with `diagonals`, both of every cell. The top row is pinned.
inline NetDef leaning_net(std::uint32_t columns, std::uint32_t rows, double spacing_m,
                          bool diagonals = false) {
    NetDef net;
    for (std::uint32_t r = 0; r < rows; ++r) {
        for (std::uint32_t c = 0; c < columns; ++c)
            net.points_m.push_back({spacing_m * (c + 0.3 * r), -spacing_m * r});
    }
    net.mass_kg.assign(net.points_m.size(), 1.0);
    net.velocity_m_s.assign(net.points_m.size(), {});
    const auto index = [columns](std::uint32_t r, std::uint32_t c) { return r * columns + c; };
    for (std::uint32_t c = 0; c < columns; ++c) net.pinned.push_back(c);
    for (std::uint32_t r = 1; r < rows; ++r) {
        for (std::uint32_t c = 0; c + 1 < columns; ++c) net.bars.push_back({index(r, c), index(r, c + 1)});
    }
    for (std::uint32_t r = 0; r + 1 < rows; ++r) {
        for (std::uint32_t c = 0; c < columns; ++c) net.bars.push_back({index(r, c), index(r + 1, c)});
    }
    for (std::uint32_t r = 0; diagonals && r + 1 < rows; ++r) {
        for (std::uint32_t c = 0; c + 1 < columns; ++c) {
            net.bars.push_back({index(r, c), index(r + 1, c + 1), false});
            net.bars.push_back({index(r, c + 1), index(r + 1, c), false});
        }
    }
    return net;
}

}  // namespace corda::test
