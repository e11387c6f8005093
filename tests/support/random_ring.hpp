#pragma once

#include <cmath>
#include <random>

#include "corda/sim/system.hpp"

namespace corda::test {

/// A stretching and bending closed rope of 8 links with randomly displaced particles, one of them pinned.
inline System random_ring(double largest_move_m, unsigned seed) {
    RopeDef rope;
    for (int i = 0; i < 8; ++i) rope.points_m.push_back({std::cos(0.8 * i), std::sin(0.8 * i)});
    rope.mass_kg = {1.0, 2.0, 0.5, 1.0, 3.0, 1.0, 0.2, 1.0};
    rope.velocity_m_s.assign(8, {});
    rope.closed = true;
    rope.material.compliance_1_n = 0.01;
    rope.bending_n_m2 = 3.0;
    System system = build_system({&rope, 1});
    std::mt19937 random(seed);
    const auto draw = [&] { return largest_move_m * (static_cast<double>(random() % 2001) / 1000.0 - 1.0); };
    for (std::size_t i = 0; i < 8; ++i) {
        system.x_m[i] += draw();
        system.y_m[i] += draw();
    }
    return system;
}

}  // namespace corda::test
