#include "corda/film/motion.hpp"

#include <gtest/gtest.h>

#include "support/cancel.hpp"
#include "support/failure.hpp"

namespace corda::film {
namespace {

using test::failure_of;

constexpr std::size_t kMuch = std::size_t{1} << 20;
constexpr double kStillS = 0.33;
const FrameRate kFps(Rational{20, 1});

System system_of_a_rope() {
    RopeDef rope;
    rope.points_m = {{0.0, 0.0}, {0.3, -0.4}, {0.7, -0.5}, {1.2, -0.5}};
    return build_system({&rope, 1});
}

/// A motion of 1 s at 20 frames per second, with a still between two of them.
struct Swing {
    explicit Swing(const MethodDef& method = RattleDef{}, std::size_t budget_bytes = kMuch)
        : motion(system, WorldDef{}, {method}, Timeline(kFps, 20, {kStillS}), budget_bytes) {}

    System system = system_of_a_rope();
    Motion motion;
};

/// Diverges within a few frames.
MethodDef wild() {
    return RelaxationDef{.force_n = Vec2{1e300, 0.0}};
}

void expect_same(const State& a, const State& b) {
    EXPECT_EQ(a.time_s, b.time_s);
    EXPECT_EQ(a.x_m, b.x_m);
    EXPECT_EQ(a.y_m, b.y_m);
}

TEST(Motions, StartWhenTheyAreRead) {
    Swing swing;
    EXPECT_EQ(swing.motion.passes(), 0);
    EXPECT_EQ(swing.motion.recording().size(), 0U);
    EXPECT_TRUE(std::get<RattleDef>(swing.motion.methods().front()).step_s.has_value());  // filled in
    static_cast<void>(swing.motion.at(0.5));
    EXPECT_EQ(swing.motion.passes(), 1);
    EXPECT_EQ(swing.motion.recording().size(), 12U);  // frames 0 .. 10 and the still
}

TEST(Motions, AreSimulatedOnceForAnyOrder) {
    Swing swing;
    Simulation run(swing.system, WorldDef{}, RattleDef{}, kFps.interval_s());
    std::vector<State> states;
    for (std::int64_t k = 0; k <= 20; ++k) {
        ASSERT_EQ(run.advance_to(kFps.time_s(k)), Status::kOk);
        states.push_back(run.state());
    }
    for (const std::int64_t k : {20, 0, 13, 5, 19})
        expect_same(swing.motion.at(kFps.time_s(k)), states[static_cast<std::size_t>(k)]);
    EXPECT_EQ(swing.motion.passes(), 1);
    EXPECT_EQ(swing.motion.at(kStillS).time_s, kStillS);
    EXPECT_EQ(swing.motion.passes(), 1);
}

TEST(Motions, HaveStatesBetweenTheirTimesByAnotherRun) {
    Swing swing;
    Simulation run(swing.system, WorldDef{}, RattleDef{}, kFps.interval_s());
    for (const double time_s : {0.123, 0.777}) {
        ASSERT_EQ(run.advance_to(time_s), Status::kOk);
        expect_same(swing.motion.at(time_s), run.state());
    }
    EXPECT_EQ(swing.motion.passes(), 1);  // one after the other
    static_cast<void>(swing.motion.at(0.123));
    EXPECT_EQ(swing.motion.passes(), 2);
}

TEST(Motions, BeyondTheirBudgetAreSimulatedAgain) {
    Swing whole;
    Swing small(RattleDef{}, 0);
    for (const std::int64_t k : {20, 3, 4}) {
        expect_same(small.motion.at(kFps.time_s(k)), whole.motion.at(kFps.time_s(k)));
        EXPECT_EQ(small.motion.figures().strain, whole.motion.figures().strain);
    }
    EXPECT_EQ(small.motion.passes(), 2);  // to 20; to 3 and on to 4
    EXPECT_EQ(small.motion.recording().bounds().min_m(), whole.motion.recording().bounds().min_m());
}

TEST(Motions, CanBeCancelledAndContinue) {
    Swing swing;
    {
        std::size_t checks = 0;
        const CancelScope stop([&] {
            EXPECT_EQ(swing.motion.next(), checks);
            return checks++ < 5;
        });
        EXPECT_EQ(failure_of([&] { swing.motion.run_to_end(); }).code, ExitCode::kInterrupted);
    }
    EXPECT_EQ(swing.motion.recording().size(), 5U);
    swing.motion.run_to_end();  // continues
    EXPECT_EQ(swing.motion.recording().size(), 22U);
    EXPECT_EQ(swing.motion.passes(), 1);
    EXPECT_FALSE(swing.motion.diverges());
}

TEST(Motions, ThatDivergeEndEarly) {
    Swing swing(wild());
    swing.motion.run_to_end();
    EXPECT_TRUE(swing.motion.diverges());
    const std::size_t good = swing.motion.recording().size();
    ASSERT_GE(good, 1U);
    ASSERT_LT(good, 20U);
    EXPECT_EQ(swing.motion.at(0.0).time_s, 0.0);
    for (const double time_s : {1.0, 0.99}) {
        const test::Failure failure = failure_of([&] { static_cast<void>(swing.motion.at(time_s)); });
        EXPECT_EQ(failure.code, ExitCode::kDiverged);
        EXPECT_NE(failure.message.find("a smaller solver.step"), std::string::npos) << failure.message;
    }
    EXPECT_EQ(swing.motion.at(0.0).time_s, 0.0);
}

TEST(Motions, ReuseTheRunThatAPlannerRecords) {
    const System system = system_of_a_rope();
    Motion motion(system, WorldDef{}, {}, Timeline(kFps, 20), kMuch);
    const Plan plan = motion.record([&](const Timeline& timeline, sim::Recording& recording) {
        Simulation run(system, WorldDef{}, RattleDef{6}, kFps.interval_s());
        for (std::size_t i = 0; i < timeline.size(); ++i)
            EXPECT_EQ(recording.advance(run, timeline, {}), Status::kOk);
        Plan made;
        made.bodies.emplace_back().method = run.methods().front();
        return made;
    });
    EXPECT_EQ(plan.bodies.front().method, motion.methods().front());
    EXPECT_EQ(motion.at(1.0).time_s, 1.0);
    EXPECT_EQ(motion.passes(), 0);
    EXPECT_FALSE(motion.diverges());
}

TEST(Motions, CanBeCancelledDuringLongStepsAndRestarted) {
    const System system = system_of_a_rope();
    const MethodDef method = RelaxationDef{1e-5, 8};
    Motion motion(system, WorldDef{}, {method}, Timeline(kFps, 3), kMuch);
    static_cast<void>(motion.at(kFps.time_s(1)));
    {
        const CancelScope stop = test::cancel_after(0);
        const test::Failure failure = failure_of([&] { static_cast<void>(motion.at(kFps.time_s(2))); });
        EXPECT_EQ(failure.code, ExitCode::kInterrupted);
        EXPECT_EQ(motion.next(), 2U);
    }
    Motion alone(system, WorldDef{}, {method}, Timeline(kFps, 3), kMuch);
    EXPECT_EQ(motion.at(kFps.time_s(3)).x_m, alone.at(kFps.time_s(3)).x_m);
    EXPECT_EQ(motion.recording().size(), 4U);
    EXPECT_EQ(motion.passes(), 2);
}

}  // namespace
}  // namespace corda::film
