#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/system.hpp"

// Bodies of every kind that method relaxation can run, for tests that compare two implementations.
namespace corda::test {

using Random = std::mt19937;

inline int pick(Random& random, int least, int most) {
    return std::uniform_int_distribution<int>(least, most)(random);
}

inline double pick_real(Random& random, double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random);
}

inline std::vector<std::uint32_t> random_pins(Random& random, std::size_t particles) {
    std::vector<std::uint32_t> pinned;
    // None, one, or enough for bars between two pins.
    const std::array<double, 3> shares{0.0, 1.0 / static_cast<double>(particles), 0.3};
    const double share = shares[static_cast<std::size_t>(pick(random, 0, 2))];
    for (std::uint32_t i = 0; i < particles; ++i) {
        if (pick_real(random, 0.0, 1.0) < share) pinned.push_back(i);
    }
    return pinned;
}

/// A rope with special positions, too: some particles on one of the two previous ones, some at x = -0, and
/// sometimes all x so small that moves along x are subnormal numbers.
inline RopeDef random_rope(Random& random, int particles) {
    RopeDef rope;
    const int coincident_percent = pick(random, 0, 1) * pick(random, 1, 60);
    const double width_m =
        std::array{1.0, 1.0, 1.0, 1e-310, 0.0}[static_cast<std::size_t>(pick(random, 0, 4))];
    for (int i = 0; i < particles; ++i) {
        Vec2 point{width_m * pick_real(random, -1.0, 1.0), -0.7 * i + pick_real(random, -0.3, 0.3)};
        if (i >= 2 && pick(random, 1, 100) <= coincident_percent)
            point = rope.points_m[static_cast<std::size_t>(i - pick(random, 1, 2))];
        if (pick(random, 0, 19) == 0) point.x = -0.0;
        rope.points_m.push_back(point);
        rope.mass_kg.push_back(pick_real(random, 0.5, 2.0));
        rope.velocity_m_s.push_back({width_m * pick_real(random, -1.0, 1.0), pick_real(random, -1.0, 1.0)});
    }
    rope.closed = particles >= 3 && pick(random, 0, 3) == 0;
    rope.pinned = random_pins(random, rope.points_m.size());
    return rope;
}

inline NetDef random_net(Random& random) {
    NetDef net;
    const int particles = pick(random, 2, 60);
    for (int i = 0; i < particles; ++i) {
        net.points_m.push_back({pick_real(random, -1.0, 1.0), pick_real(random, -1.0, 1.0)});
        net.mass_kg.push_back(1.0);
        net.velocity_m_s.push_back({pick_real(random, -1.0, 1.0), 0.0});
    }
    for (std::uint32_t a = 0; a < net.points_m.size(); ++a) {
        for (std::uint32_t b = 0; b < a; ++b) {
            if (pick(random, 0, 9) == 0) net.bars.push_back({a, b, true});
        }
    }
    std::shuffle(net.bars.begin(), net.bars.end(), random);
    net.pinned = random_pins(random, net.points_m.size());
    return net;
}

inline System random_system(Random& random) {
    std::vector<RopeDef> ropes;
    const int largest = pick(random, 0, 1) == 0 ? 300 : 30;
    const int reach = pick(random, 1, 20);
    for (int count = pick(random, 1, 4); count > 0; --count) {
        ropes.push_back(random_rope(random, pick(random, 2, largest)));
        ropes.back().reach = reach;
    }
    std::vector<NetDef> nets;
    for (int count = pick(random, 0, 2); count > 0; --count) nets.push_back(random_net(random));
    return build_system(ropes, nets);
}

/// The source report's rope, with its bars to seven neighbours.
inline RopeDef report_rope(int particles) {
    RopeDef rope = reference::report_rope(particles);
    rope.reach = 7;
    return rope;
}
inline System report_system(int particles) {
    const RopeDef rope = report_rope(particles);
    return build_system({&rope, 1});
}

}  // namespace corda::test
