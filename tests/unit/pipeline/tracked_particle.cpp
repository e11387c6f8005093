#include "corda/pipeline/tracked_particle.hpp"

#include <gtest/gtest.h>

#include "corda/scene/scene.hpp"

namespace corda::pipeline {
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
    EXPECT_EQ(particles_text(system, followed), "the free ends of rope 0 to rope 2 (particles 4, 0, 4)");
}

TEST(TrackedParticle, IsInTheMiddleOfBodiesWithoutAFreeEnd) {
    const System system = system_with(
        "[[rope]]\npoints = [[0, 0], [1, -1], [2, -1.5], [3, -1], [4, 0]]\npinned = [0, -1]\n"
        "[[rope]]\npoints = [[0, 0], [1, 0], [1, -1], [0, -1]]\nclosed = true\n"
        "[[net]]\ngrid = { columns = 5, rows = 3, spacing = 0.1, diagonals = true }\npinned = [[0, 0], [4, "
        "0]]\n");
    const auto followed = tracked_particles(system);
    ASSERT_EQ(followed.size(), 3U);
    EXPECT_EQ(particle_text(system, followed[0]), "particle 2 of rope 0 (the middle one of its free ones)");
    EXPECT_EQ(followed[1].pin, 5U);
    EXPECT_EQ(particle_text(system, followed[2]), "particle 7 of net 0 (the most central of its free ones)");
}

TEST(TrackedParticle, IsLimitedToTheFirstMovingBodies) {
    std::string bodies = "[[rope]]\npoints = [[0, 0], [1, 0]]\npinned = [0, 1]\n";
    for (int i = 0; i < 9; ++i) bodies += "[[rope]]\nhang = { links = 2, length = 1.0 }\n";
    const System system = system_with(bodies);
    const auto followed = tracked_particles(system);
    ASSERT_EQ(followed.size(), kMaxBodies);
    EXPECT_EQ(followed.front().body, 1U);
    EXPECT_EQ(moving_count(system), 9U);
    EXPECT_EQ(particles_text(system, followed), "the free ends of rope 1 to rope 6 (particle 2 of each)");
}

}  // namespace
}  // namespace corda::pipeline
