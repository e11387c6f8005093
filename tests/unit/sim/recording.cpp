#include "corda/sim/recording.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "benchmark/study/reference/ropes.hpp"
#include "support/simulate.hpp"

namespace corda::sim {
namespace {

constexpr std::size_t kParticles = 3;
const Timeline kTimes(FrameRate(Rational{10, 1}), 5);

Simulation swing() {
    return test::simulate(reference::straight_rope(2, 1.0, 80.0), WorldDef{}, ExactDef{});
}

TEST(Recording, GivesBackTheStatesOfTheRun) {
    Simulation run = swing();
    Recording recording(kParticles, 5);
    std::vector<State> states;
    for (int k = 0; k < 5; ++k) {
        ASSERT_EQ(recording.advance(run, kTimes, {}), Status::kOk);
        states.push_back(run.state());
    }
    EXPECT_EQ(recording.size(), 5U);
    EXPECT_EQ(recording.diagnostics().steps, run.diagnostics().steps);
    State state;
    for (const std::size_t k : {4U, 0U, 2U}) {
        recording.read(k, state);
        EXPECT_EQ(state.time_s, states[k].time_s);
        EXPECT_EQ(state.x_m, states[k].x_m);
        EXPECT_EQ(state.y_m, states[k].y_m);
    }
    EXPECT_EQ(recording.figures(4).energy_error, run.figures().energy_error);
    EXPECT_EQ(recording.wall_s(), 0.0);
}

TEST(Recording, HasTheBoundsOfItsStates) {
    Recording recording(kParticles, 51);
    Simulation run = swing();
    const Timeline timeline(FrameRate(Rational{50, 1}), 50);
    for (int k = 0; k <= 50; ++k) ASSERT_EQ(recording.advance(run, timeline, {}), Status::kOk);
    EXPECT_EQ(recording.size(), 51U);
    EXPECT_LT(recording.bounds().min_m().x, 0.0);  // it has swung to the other side
    EXPECT_LT(recording.bounds().min_m().y, -0.9);
    EXPECT_GT(recording.bounds().max_m().x, 0.98);
    ASSERT_EQ(recording.particle_bounds().size(), kParticles);
    MotionBounds all;
    for (const MotionBounds& particle : recording.particle_bounds()) all.include(particle);
    EXPECT_EQ(all.min_m(), recording.bounds().min_m());
    EXPECT_EQ(all.max_m(), recording.bounds().max_m());
    EXPECT_EQ(recording.particle_bounds()[0].min_m(), recording.particle_bounds()[0].max_m());  // pinned
}

TEST(Recording, BoundsOnlyFrames) {
    // At 1.14 s it is at the other end, at 2 s almost back.
    const Timeline timeline(FrameRate(Rational{1, 2}), 1, {1.14});
    Recording recording(kParticles, timeline.size());
    Simulation run = swing();
    while (recording.size() < timeline.size()) ASSERT_EQ(recording.advance(run, timeline, {}), Status::kOk);
    State still;
    recording.read(1, still);
    EXPECT_LT(still.x_m.back(), -0.9);
    EXPECT_EQ(recording.bounds().min_m().x, 0.0);
}

TEST(Recording, OfBodiesEndsWithTheFirstThatDiverges) {
    Recording whole(2 * kParticles, 5);
    for (const int states : {4, 3}) {
        Recording body = whole.for_part(kParticles);
        Simulation run = swing();
        for (int k = 0; k < states; ++k) ASSERT_EQ(body.advance(run, kTimes, {}), Status::kOk);
        whole.add_body(body, states == 4 ? 0 : kParticles);
    }
    EXPECT_EQ(whole.size(), 3U);
    State state;
    whole.read(2, state);
    EXPECT_EQ(state.time_s, 0.2);
    EXPECT_EQ(state.x_m[1], state.x_m[1 + kParticles]);
    EXPECT_NE(state.x_m[1], state.x_m[2 + kParticles]);
    const MotionBounds& last = whole.particle_bounds().back();
    EXPECT_TRUE(last.min_m().x <= state.x_m.back() && state.x_m.back() <= last.max_m().x);
    whole.clear();
    EXPECT_TRUE(whole.particle_bounds().front().empty());
    EXPECT_EQ(whole.size(), 0U);
}

TEST(Recording, KeepsTensionsOfAllBodiesAndTheirHistogram) {
    constexpr std::size_t kBars = kParticles - 1;
    Recording whole(2 * kParticles, 5, 2 * kBars, Quantity::kTension);
    std::vector<double> expected_n;
    for (const std::size_t body : {0U, 1U}) {
        Recording part = whole.for_part(kParticles, kBars);
        Simulation run = swing();
        for (int k = 0; k < 5; ++k) ASSERT_EQ(part.advance(run, kTimes, {}), Status::kOk);
        expected_n.insert(expected_n.end(), run.state().tension_n.begin(), run.state().tension_n.end());
        whole.add_body(part, body * kParticles, body * kBars);
    }
    State state;
    whole.read(4, state);
    EXPECT_EQ(state.tension_n, expected_n);
    EXPECT_EQ(state.tension_n.size(), 2 * kBars);
    EXPECT_TRUE(state.vx_m_s.empty());
    EXPECT_GE(whole.histogram().largest(), state.tension_n[0]);
    EXPECT_LT(whole.histogram().least(), whole.histogram().largest());
    whole.clear();
    EXPECT_TRUE(whole.histogram().empty());
}

TEST(Recording, AddsNoStateOfARunThatDiverges) {
    RopeDef rope = reference::straight_rope(1, 1.0, 0.0);
    rope.pinned = {};
    RelaxationDef thrown{1.0};
    thrown.force_n = Vec2{1e11, 0.0};
    Simulation run = test::simulate(rope, WorldDef{}, thrown);
    Recording recording(2, 3);
    const Timeline timeline(FrameRate(Rational{1, 100}), 2);
    EXPECT_EQ(recording.advance(run, timeline, {}), Status::kOk);
    EXPECT_EQ(recording.advance(run, timeline, {}), Status::kDiverged);
    EXPECT_EQ(recording.size(), 1U);
    EXPECT_EQ(recording.bounds().max_m().x, 0.0);
}

TEST(Recording, MeasuresOnlySteppingAndClearsItWithTheStates) {
    double now_s = 0.0;
    const auto clock_s = [&now_s] { return now_s += 0.25; };
    Simulation run = swing();
    Recording recording(kParticles, 3);
    ASSERT_EQ(recording.advance(run, kTimes, clock_s), Status::kOk);
    now_s += 100.0;
    ASSERT_EQ(recording.advance(run, kTimes, clock_s), Status::kOk);
    EXPECT_EQ(recording.wall_s(), 0.5);
    recording.clear();
    EXPECT_EQ(recording.wall_s(), 0.0);
    EXPECT_EQ(recording.size(), 0U);
    EXPECT_TRUE(recording.bounds().empty());
    EXPECT_TRUE(recording.particle_bounds().front().empty());
    EXPECT_EQ(recording.diagnostics().steps, 0U);
}

TEST(Histogram, HasEndsAndBoundsOfRareValues) {
    Histogram histogram;
    EXPECT_TRUE(histogram.empty());
    for (int i = 0; i < 999; ++i) histogram.add(1.0 + i * 0.001);
    histogram.add(-500.0);
    histogram.add(std::nan(""));
    EXPECT_EQ(histogram.least(), -500.0);
    EXPECT_EQ(histogram.largest(), 1.998);
    EXPECT_EQ(histogram.size_exceeded_by(0.0), 500.0);
    // The 10 largest of 1000 sizes are 500 and those above 1.989.
    EXPECT_GE(histogram.size_exceeded_by(0.01), 1.989);
    EXPECT_LE(histogram.size_exceeded_by(0.01), 1.989 * 17.0 / 16.0);
}

TEST(Histogram, OfTwoEqualsThatOfAllValues) {
    Histogram all;
    Histogram a;
    Histogram b;
    for (int i = 0; i < 100; ++i) {
        all.add(i * i);
        (i % 3 == 0 ? a : b).add(i * i);
    }
    a.add(b);
    a.add(Histogram());
    EXPECT_EQ(a.least(), all.least());
    EXPECT_EQ(a.largest(), all.largest());
    for (const double share : {0.0, 0.1, 0.5})
        EXPECT_EQ(a.size_exceeded_by(share), all.size_exceeded_by(share));
}

}  // namespace
}  // namespace corda::sim
