#pragma once

#include <cstdint>

namespace corda::scene {

/// What a scene may ask for at most. Checked before any memory is taken.
struct Limits {
    static constexpr std::int64_t kFileBytes = 16 << 20;
    static constexpr std::size_t kTextBytes = 1000;  // of a title
    static constexpr std::int64_t kParticles = 1'000'000;
    static constexpr std::int64_t kBars = 20'000'000;
    static constexpr double kGibibytes = 8.0;  // of memory to simulate it
    static constexpr std::int64_t kFrames = 10'000'000;
    static constexpr std::int64_t kSteps = 1'000'000'000;
    static constexpr double kBarUpdates = 1e13;       // about a day
    static constexpr double kParticleUpdates = 1e11;  // some four hours
    static constexpr double kCoordinateMetres = 1e9;
};

}  // namespace corda::scene
