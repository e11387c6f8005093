#include "corda/film/tracked_particle.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "corda/scene/scene.hpp"

namespace corda::film {
namespace {

System system_with(const std::string& bodies) {
    return system_of(parse_scene("schema = 1\n" + bodies, "scene.toml"));
}

TEST(TrackedParticle, IsTheFreeEndOfAnOpenRope) {
    const System system = system_with(
        "[[rope]]\nhang = { links = 4, length = 1.0 }\n"
        "[[rope]]\nhang = { links = 4, length = 1.0 }\npinned = [-1]\n"
        "[[rope]]\nhang = { links = 4, length = 1.0 }\npinned = []\n");
    const auto followed = tracked_particles(system);
    ASSERT_EQ(followed.size(), 3U);
    EXPECT_EQ(followed[0].particle, 4U);
    EXPECT_EQ(followed[0].pin, 0U);
    EXPECT_EQ(followed[1].particle, 5U);
    EXPECT_EQ(followed[1].pin, 9U);
    EXPECT_EQ(followed[2].particle, 14U);
    EXPECT_EQ(followed[2].pin, std::nullopt);
}

TEST(TrackedParticle, IsInTheMiddleOfBodiesWithoutAFreeEnd) {
    const System system = system_with(
        "[[rope]]\npoints = [[0, 0], [1, -1], [2, -1.5], [3, -1], [4, 0]]\npinned = [0, -1]\n"
        "[[rope]]\npoints = [[0, 0], [1, 0], [1, -1], [0, -1]]\nclosed = true\n"
        "[[net]]\ngrid = { columns = 5, rows = 3, spacing = 0.1, diagonals = true }\npinned = [[0, 0], [4, "
        "0]]\n");
    const auto followed = tracked_particles(system);
    ASSERT_EQ(followed.size(), 3U);
    EXPECT_EQ(followed[0].particle, 2U);
    EXPECT_FALSE(followed[0].is_free_end);
    EXPECT_EQ(followed[1].pin, 5U);
    EXPECT_EQ(followed[2].particle, 9U + 7U);
}

TEST(TrackedParticle, IsLimitedToTheFirstMovingBodies) {
    std::string bodies = "[[rope]]\npoints = [[0, 0], [1, 0]]\npinned = [0, 1]\n";
    for (int i = 0; i < 9; ++i) bodies += "[[rope]]\nhang = { links = 2, length = 1.0 }\n";
    const System system = system_with(bodies);
    const auto followed = tracked_particles(system);
    ASSERT_EQ(followed.size(), kMaxBodies);
    EXPECT_EQ(followed.front().body, 1U);
    EXPECT_EQ(followed.back().body, kMaxBodies);
}

TEST(TrackedParticle, TurnsByLessThanHalfATurnPastItsPin) {
    const System system = system_with("[[rope]]\nhang = { links = 1, length = 1.0 }\n");
    const TrackedParticle tip = tracked_particles(system).front();
    // To the left at 5 m/s, 1 mm above the pin: 1 mm past it, the rate is 2500 1/s.
    for (const double start_m : {0.051, 0.049, 0.0}) {
        State state{0.0, {0.0, start_m}, {0.0, 0.001}, {0.0, -5.0}, {0.0, 0.0}};
        const view::CurvePoint before = turning_of(tip, state, nullptr);
        state.time_s = 0.01;
        state.x_m[1] -= 0.05;
        const view::CurvePoint after = turning_of(tip, state, &before);
        EXPECT_GT(after.x, before.x);
        EXPECT_LT(after.x, before.x + std::numbers::pi);
    }
}

}  // namespace
}  // namespace corda::film
