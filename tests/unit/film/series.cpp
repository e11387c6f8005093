#include "corda/film/series.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "corda/film/motion.hpp"
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

TEST(Series, AreReadFromAStateAndItsFigures) {
    const Scene scene = parse_scene(
        "schema = 1\n[world]\nduration = 0.1\n"
        "[[rope]]\npoints = [[2, 3], [2, 2]]\n[[rope]]\npoints = [[5, 3], [5, 2]]\n",
        "scene.toml");
    RecordDef def;
    def.fields.velocities = true;
    const auto motion = simulate(scene, def);
    const SeriesSource source(*motion);
    State state = motion->at(0.1);
    state.vx_m_s[1] = 2.0;
    Figures figures;
    figures.strain = 0.25;
    const Instant instant(source, state, figures);
    EXPECT_EQ(kSeries.time.value(instant), 0.1);
    EXPECT_EQ(kSeries.strain.value(instant), 0.25);
    EXPECT_NEAR(kSeries.tip_x.value(instant), 2.0, 1e-12);
    EXPECT_NEAR(kSeries.tip_y.value(instant), 2.0, 1e-12);
    EXPECT_NEAR(kSeries.tip_distance.value(instant), 3.0, 1e-12);
    EXPECT_NEAR(kSeries.kinetic.value(instant), 2.0 * motion->system.mass_kg[1], 1e-12);
    EXPECT_NEAR(kSeries.total.value(instant), kSeries.kinetic.value(instant), 1e-12);
    for (const Series& unknown : {kSeries.energy_error, kSeries.pin_force, kSeries.largest_tension})
        EXPECT_TRUE(std::isnan(unknown.value(instant))) << unknown.key;
    state.vx_m_s.clear();
    for (const Series& energy : {kSeries.kinetic, kSeries.weight, kSeries.elastic, kSeries.total})
        EXPECT_TRUE(std::isnan(energy.value({source, state, figures}))) << energy.key;
}

}  // namespace
}  // namespace corda::film
