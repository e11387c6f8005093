#pragma once

#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/system.hpp"

namespace corda::test {

inline constexpr std::size_t kChainParticles = 9;

/// A rope of unequal links and masses in motion, pinned at its first particle.
inline RopeDef chain_rope() {
    RopeDef rope = reference::rope_through({{0.0, 0.0},
                                            {0.3, -0.1},
                                            {0.35, -0.5},
                                            {0.6, -0.4},
                                            {0.9, -0.6},
                                            {0.8, -0.9},
                                            {1.2, -1.0},
                                            {1.3, -0.7},
                                            {1.5, -0.75}});
    for (std::size_t i = 0; i < kChainParticles; ++i) {
        const auto k = static_cast<double>(i);
        rope.mass_kg[i] = 0.5 + 0.3 * k;
        rope.velocity_m_s[i] = {0.4 * k - 1.0, 0.2 * k * k - 1.5};
    }
    return rope;
}

/// Its pinned ends.
enum class Pins { kNone, kStart, kEnd, kBoth };

inline System chain(Pins pins, double bending_n_m2 = 0.0) {
    constexpr std::uint32_t kLast = kChainParticles - 1;
    RopeDef rope = chain_rope();
    rope.bending_n_m2 = bending_n_m2;
    rope.pinned.clear();
    if (pins == Pins::kStart || pins == Pins::kBoth) rope.pinned.push_back(0);
    if (pins == Pins::kEnd || pins == Pins::kBoth) rope.pinned.push_back(kLast);
    return build_system({&rope, 1});
}

}  // namespace corda::test
