#include "corda/sim/forces/time_function.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace corda::sim {
namespace {

double distance(Vec2 a, Vec2 b) {
    return length(a.x - b.x, a.y - b.y);
}

TimeFunction wave_and_path() {
    TimeFunction function;
    function.add_wave({{0.3, -0.2}, 1.7, 40.0});
    const std::array<PathKeyDef, 3> keys{{{0.5, {}}, {1.5, {1.0, -2.0}}, {1.75, {0.0, 1.0}}}};
    function.add_path(keys);
    return function;
}

TEST(TimeFunction, IsTheSineOfTheWaveToRounding) {
    double largest = 0.0;
    for (const double phase_deg : {0.0, 30.0, 90.0, 215.0, -400.0}) {
        TimeFunction wave;
        wave.add_wave({{2.0, 0.0}, 0.7, phase_deg});
        for (double t = 0.0; t < 20.0; t += 0.017) {
            const double angle = 2.0 * std::numbers::pi * 0.7 * t + phase_deg / 180.0 * std::numbers::pi;
            largest = std::max(largest, std::abs(wave(t).x - 2.0 * std::sin(angle)));
        }
    }
    EXPECT_LT(largest, 1e-13);
    TimeFunction cosine;
    cosine.add_wave({{1.0, 0.0}, 0.25, 90.0});
    EXPECT_EQ(cosine(0.0).x, 1.0);
    EXPECT_EQ(cosine(1.0).x, 0.0);
    EXPECT_EQ(cosine(2.0).x, -1.0);
}

TEST(TimeFunction, RestsAtTheKeysOfAPath) {
    TimeFunction path;
    const std::array<PathKeyDef, 3> keys{{{0.5, {}}, {1.5, {1.0, -2.0}}, {1.75, {0.0, 1.0}}}};
    path.add_path(keys);
    EXPECT_EQ(path(0.2), Vec2{});
    EXPECT_EQ(path(1.0), (Vec2{0.5, -1.0}));  // half way at half time
    for (const PathKeyDef& key : keys) {
        EXPECT_LT(distance(path(key.time_s), key.by_m), 1e-14);
        EXPECT_LT(distance(path.derivative()(key.time_s), {}), 1e-13);
        EXPECT_LT(distance(path.derivative().derivative()(key.time_s), {}), 1e-12);
    }
    EXPECT_EQ(path(9.0), keys[2].by_m);
    EXPECT_EQ(path.next_key_s(0.0), 0.5);
    EXPECT_EQ(path.next_key_s(0.5), 1.5);
    EXPECT_EQ(path.next_key_s(std::nextafter(1.5, 0.0)), 1.75);
    EXPECT_EQ(path.next_key_s(1.75), std::numeric_limits<double>::infinity());
}

TEST(TimeFunction, HasTheSeriesAndTheDerivativeOfItsValues) {
    const TimeFunction function = wave_and_path();
    const TimeFunction slope = function.derivative();
    for (const double t : {0.1, 0.5, 0.9, 1.5, 1.6, 2.5}) {
        std::array<Vec2, 21> term{};
        function.expand(t, 0.2, term);
        for (const double share : {0.1, 0.5, 0.9}) {  // no key lies in between
            const double later = t + 0.1 * share;
            Vec2 sum;
            for (std::size_t k = term.size(); k-- > 0;) sum = 0.5 * share * sum + term[k];
            EXPECT_LT(distance(sum, function(later)), 1e-14) << t << ' ' << share;
        }
        EXPECT_LT(distance(5.0 * term[1], slope(t)), 1e-13);
        EXPECT_LE(length(function(t).x, function(t).y), function.bound());
        EXPECT_LE(length(slope(t).x, slope(t).y), slope.bound());
    }
}

TEST(TimeFunction, AddsAndTurns) {
    const TimeFunction function = wave_and_path();
    TimeFunction none = function;
    none.add(-1.0, function);
    EXPECT_LT(none.bound(), 1e-15);
    for (const double t : {0.0, 0.7, 1.6, 3.0}) {
        const Vec2 v = function(t);
        EXPECT_LT(distance(function.turned({0.8, 0.6})(t), 0.8 * v + 0.6 * left_of(v)), 1e-15);
    }
    EXPECT_TRUE(TimeFunction().empty());
    EXPECT_FALSE(function.empty());
}

}  // namespace
}  // namespace corda::sim
