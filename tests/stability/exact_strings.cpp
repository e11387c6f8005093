// The method `exact` with strings of rigid links in hard cases: many snaps, unequal masses, symmetry, chance.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/exact/string/part.hpp"
#include "support/strings.hpp"

namespace corda::sim {
namespace {

/// A string under the method `exact`, watched frame by frame.
class WatchedString {
  public:
    explicit WatchedString(const RopeDef& rope, double tolerance = 1e-9, const WorldDef& world = {})
        : system_(build_system({&rope, 1})),
          part_(system_, world, tolerance),
          state_{0.0, system_.x_m, system_.y_m},
          energy_j_(part_.energy_j()) {
        const double scale_j = energy_scale_j(system_, Forces(world).on_particles(system_));
        scale_j_ = std::max(scale_j, std::abs(energy_j_));
    }

    /// False if it diverges.
    bool run(double duration_s, int frames_per_second = 60) {
        const auto frames = static_cast<int>(std::lround(duration_s * frames_per_second));
        for (int k = 1; k <= frames; ++k) {
            if (part_.advance_to(static_cast<double>(k) / frames_per_second, state_) == Status::kDiverged)
                return false;
            for (const Bar& bar : system_.bars) {
                const double distance_m =
                    length(state_.x_m[bar.b] - state_.x_m[bar.a], state_.y_m[bar.b] - state_.y_m[bar.a]);
                longest_ = std::max(longest_, distance_m / bar.rest_m - 1.0);
            }
            const double energy_j = part_.energy_j();
            rise_ = std::max(rise_, (energy_j - energy_j_) / scale_j_);
            energy_j_ = energy_j;
        }
        return true;
    }

    [[nodiscard]] double longest() const { return longest_; }  ///< largest strain of a link
    [[nodiscard]] double rise() const {
        return rise_;
    }  ///< largest rise of energy in a frame, over its scale
    [[nodiscard]] const StringPart& part() const { return part_; }
    [[nodiscard]] const State& state() const { return state_; }

  private:
    System system_;
    StringPart part_;
    State state_;
    double energy_j_;
    double scale_j_ = 0.0;
    double longest_ = -1.0;
    double rise_ = 0.0;
};

/// Links of rest length 1 / `links`, at nine tenths of it at the start.
RopeDef slack_rope(int links) {
    return test::string_of(reference::straight_rope(links, 0.9, 90.0).points_m,
                           std::vector<double>(static_cast<std::size_t>(links), 1.0 / links));
}

void expect_sound(const RopeDef& rope, double duration_s, const WorldDef& world, const char* name) {
    const auto start = std::chrono::steady_clock::now();
    WatchedString string(rope, 1e-9, world);
    EXPECT_TRUE(string.run(duration_s)) << name;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%s: %llu events, %llu + %llu steps in %.2f s; longest %.1e, energy rises %.1e\n", name,
                static_cast<unsigned long long>(string.part().events()),
                static_cast<unsigned long long>(string.part().steps()),
                static_cast<unsigned long long>(string.part().rejected_steps()), seconds, string.longest(),
                string.rise());
    EXPECT_LT(string.longest(), 1e-11) << name;  // measured 6.4e-14
    EXPECT_LT(string.rise(), 1e-9) << name;      // measured 4.0e-12
}

TEST(Dropped, WithSlackLinks) {
    expect_sound(slack_rope(20), 5.0, WorldDef{}, "20 links");
    RopeDef two_pins = slack_rope(20);
    two_pins.pinned = {0, 20};
    expect_sound(two_pins, 5.0, WorldDef{}, "20 links between two pins");
    RopeDef middle = slack_rope(20);
    middle.pinned = {10};
    expect_sound(middle, 5.0, WorldDef{}, "20 links pinned in the middle");
    RopeDef loaded = slack_rope(20);
    loaded.payload_kg = 1000.0;
    expect_sound(loaded, 5.0, WorldDef{}, "20 links with a payload of 1000");
    RopeDef damped = slack_rope(20);
    expect_sound(damped, 20.0, WorldDef{{0.0, -9.81}, 20.0, 0.5}, "20 links with drag");
    RopeDef free = slack_rope(20);
    free.pinned = {};
    free.velocity_m_s[3] = {3.0, 4.0};
    free.velocity_m_s[17] = {-1.0, 4.0};
    expect_sound(free, 2.0, WorldDef{}, "20 links thrown");
}

TEST(Dropped, OfManyLinks) {
    expect_sound(slack_rope(200), 0.5, WorldDef{}, "200 links");
}

TEST(Straight, FallsAndSnapsInALine) {
    // The motion stays vertical, and cosines are exactly 1 and -1.
    RopeDef rope = slack_rope(10);
    for (std::size_t i = 0; i < rope.points_m.size(); ++i)
        rope.points_m[i] = {0.0, 0.05 * static_cast<double>(i)};
    WatchedString string(rope);
    ASSERT_TRUE(string.run(5.0));
    for (std::size_t i = 0; i <= 10; ++i) {
        EXPECT_EQ(string.state().x_m[i], 0.0);
        EXPECT_NEAR(string.state().y_m[i], -0.1 * static_cast<double>(i), 1e-14);
    }
    EXPECT_EQ(string.part().events(), 10U);
}

TEST(Symmetric, StaysSo) {
    for (const int links : {8, 9, 20}) {
        RopeDef rope = slack_rope(links);
        for (Vec2& point : rope.points_m) point.x -= 0.45;
        rope.pinned = {0, static_cast<std::uint32_t>(links)};
        WatchedString string(rope);
        ASSERT_TRUE(string.run(1.0));
        double worst_m = 0.0;
        for (std::size_t i = 0; i < rope.points_m.size(); ++i) {
            const std::size_t other = rope.points_m.size() - 1 - i;
            worst_m = std::max({worst_m, std::abs(string.state().x_m[i] + string.state().x_m[other]),
                                std::abs(string.state().y_m[i] - string.state().y_m[other])});
        }
        std::printf("symmetric, %d links: %llu events, off by %.1e m\n", links,
                    static_cast<unsigned long long>(string.part().events()), worst_m);
        EXPECT_LT(worst_m, 1e-9);  // measured 1.3e-13
    }
}

TEST(FreeFall, OfARopeWithoutTensionIsNoEvent) {
    RopeDef rope = reference::straight_rope(10, 1.0, 90.0);
    rope.material.is_string = true;
    rope.pinned = {};
    for (Vec2& velocity : rope.velocity_m_s) velocity = {3.0, 5.0};
    WatchedString string(rope, 1e-9, WorldDef{{0.0, -9.81}, 10.0, 0.3});
    ASSERT_TRUE(string.run(5.0));
    EXPECT_EQ(string.part().events(), 0U);
}

TEST(StringBits, AreTheSameWhateverTimesAreAskedFor) {
    RopeDef rope = slack_rope(12);
    WatchedString one(rope);
    ASSERT_TRUE(one.run(1.5, 2));
    EXPECT_GT(one.part().events(), 10U);
    for (const int frames_per_second : {24, 60, 1000}) {
        WatchedString many(rope);
        ASSERT_TRUE(many.run(1.5, frames_per_second));
        EXPECT_EQ(one.state().x_m, many.state().x_m) << frames_per_second;
        EXPECT_EQ(one.state().y_m, many.state().y_m) << frames_per_second;
        EXPECT_EQ(one.part().steps(), many.part().steps()) << frames_per_second;
        EXPECT_EQ(one.part().events(), many.part().events()) << frames_per_second;
    }
}

/// Links of any lengths within a factor of 10 and masses within a factor of 100, half of them slack at first.
RopeDef random_rope(std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    };
    const std::size_t links = 1 + random() % 25;
    RopeDef rope;
    rope.material.is_string = true;
    rope.pinned.clear();
    rope.points_m.push_back({between(-1.0, 1.0), between(-1.0, 1.0)});
    const double speed_m_s = random() % 3 == 0 ? 3.0 : 0.0;
    for (std::size_t i = 0; i <= links; ++i) {
        rope.mass_kg.push_back(std::pow(10.0, between(-1.0, 1.0)));
        rope.velocity_m_s.push_back({between(-speed_m_s, speed_m_s), between(-speed_m_s, speed_m_s)});
        if (random() % (links + 1) == 0) rope.pinned.push_back(static_cast<std::uint32_t>(i));
        if (i == links) break;
        const double length_m = std::pow(10.0, between(-1.0, 0.0)) / static_cast<double>(links);
        const double angle = between(0.0, 6.2831853);
        const Vec2 next = rope.points_m.back() + length_m * Vec2{std::cos(angle), std::sin(angle)};
        const Vec2 along = next - rope.points_m.back();
        const double slack = random() % 2 == 0 ? 1.0 : between(1.0, 10.0);
        rope.rest_m.push_back(slack * length(along.x, along.y));
        rope.points_m.push_back(next);
    }
    return rope;
}

TEST(Random, StringsKeepTheirLengthsAndGainNoEnergy) {
    double longest = -1.0;
    double rise = 0.0;
    std::uint64_t events = 0;
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        WorldDef world;
        if (seed % 3 == 0) world.gravity_m_s2 = {0.0, 0.0};
        if (seed % 4 == 0) world.drag_1_s = 0.7;
        WatchedString string(random_rope(seed), 1e-9, world);
        EXPECT_TRUE(string.run(2.0, 30)) << seed;
        longest = std::max(longest, string.longest());
        rise = std::max(rise, string.rise());
        events += string.part().events();
    }
    std::printf("random strings: %llu events, longest %.1e, energy rises %.1e\n",
                static_cast<unsigned long long>(events), longest, rise);
    EXPECT_GT(events, 1000U);
    EXPECT_LT(longest, 1e-11);  // measured 3.3e-13
    EXPECT_LT(rise, 1e-9);      // measured 3.5e-12
}

}  // namespace
}  // namespace corda::sim
