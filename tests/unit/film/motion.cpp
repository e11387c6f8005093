#include "corda/film/motion.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "support/cancel.hpp"
#include "support/failure.hpp"

namespace corda::film {
namespace {

using test::failure_of;

constexpr double kStillS = 0.33;

/// 1 s of a rope at 20 frames per second.
Scene scene_by(const std::string& solver, const std::vector<Setting>& settings = {}) {
    return parse_scene(
        "schema = 1\n[world]\nduration = 1\n[video]\nfps = 20\n[[rope]]\n"
        "points = [[0, 0], [0.3, -0.4], [0.7, -0.5], [1.2, -0.5]]\n[solver]\n" +
            solver,
        "a.toml", settings);
}

std::shared_ptr<const Motion> motion_by(const std::string& solver, const RecordDef& def = {}) {
    return simulate(scene_by(solver), def);
}

void expect_same(const State& a, const State& b) {
    EXPECT_EQ(a.time_s, b.time_s);
    EXPECT_EQ(a.x_m, b.x_m);
    EXPECT_EQ(a.y_m, b.y_m);
}

TEST(Motions, HaveTheStatesOfARunAtRecordedTimesAndOthers) {
    RecordDef def;
    def.times_s = {kStillS};
    const auto motion = motion_by("method = \"rattle\"", def);
    EXPECT_EQ(motion->recording->size(), 22U);  // frames 0 .. 20 and the still
    EXPECT_TRUE(std::get<RattleDef>(motion->methods().front()).step_s.has_value());  // filled in
    Simulation run(motion->system, motion->world, motion->methods(), motion->timeline->step_s());
    for (const double time_s : {0.05, 0.123, kStillS, 0.777, 1.0}) {
        ASSERT_EQ(run.advance_to(time_s), Status::kOk);
        expect_same(motion->at(time_s), run.state());
    }
    expect_same(motion->at(0.0), {0.0, motion->system.x_m, motion->system.y_m});
}

TEST(Motions, OfWhatIsLetGoHaveNoEnergyErrorAndNoJumpOfEnergy) {
    const Scene scene = parse_scene(
        "schema = 1\n[world]\nduration = 1\n[video]\nfps = 20\n[[rope]]\n"
        "points = [[0, 0], [0.3, -0.4], [0.7, -0.5], [1.2, -0.5]]\nmass = [5, 1, 1, 1]\n"
        "release = [{ pin = 0, t = 0.4 }]\n",
        "a.toml");
    RecordDef def;
    def.fields.velocities = true;
    def.times_s = {0.4 - 1e-9, 0.4};
    const auto motion = simulate(scene, def);
    EXPECT_FALSE(motion->diverges());
    EXPECT_LT(motion->plan.error_estimate_m.value(), 1e-3);
    for (const double time_s : {0.2, 0.4 - 1e-9, 0.4, 1.0}) {
        motion->for_each({&time_s, 1}, [&](const State& state, const Figures& figures) {
            EXPECT_EQ(figures.energy_error, std::nullopt);
            const Energy energy = motion->energy_of(state);
            EXPECT_NEAR(energy.kinetic_j + energy.potential_j(), 0.0, 1e-4) << time_s;
        });
    }
}

TEST(Motions, OfACutRopeAreDrawnByItsPartsInTheCamera) {
    const Scene scene = parse_scene(
        "schema = 1\n[world]\nduration = 1\n[video]\nfps = 20\n[[rope]]\n"
        "points = [[0, 0], [0.3, -0.4], [0.7, -0.5], [1.2, -0.5]]\ncut = [{ link = 1, t = 0 }]\n"
        "[style]\ncolor_by = \"tension\"\n",
        "a.toml");
    const auto motion = simulate(scene, {});
    EXPECT_NEAR(motion->recording->bounds().min_m().y, -0.5 - 0.5 * 9.81, 1e-9);
    // The tension of the link that is gone is in no scale.
    EXPECT_EQ(motion->recording->figures(5).loads->largest_tension_n, motion->at(0.25).tension_n[0]);
    EXPECT_EQ(motion->at(0.25).tension_n[1], 0.0);
    EXPECT_LT(motion->recording->figures(20).strain, 1e-9);
}

TEST(Motions, AreReadInOrderOfTime) {
    const auto motion = motion_by("method = \"exact\"");
    const std::vector<double> times_s{0.0, 0.123, 0.5, 0.777, 1.0};
    std::vector<double> read_s;
    motion->for_each(times_s, [&](const State& state, const Figures& figures) {
        read_s.push_back(state.time_s);
        EXPECT_LT(figures.strain, 1e-9);
        expect_same(state, motion->at(state.time_s));
    });
    EXPECT_EQ(read_s, times_s);
}

TEST(Motions, RecordExposures) {
    const Scene scene = scene_by("method = \"exact\"", {"video.shutter=0.5", "video.subframes=4"});
    EXPECT_EQ(simulate(scene, {})->recording->size(), 21U + 4U * 21U);
    RecordDef def;
    def.times_s = {kStillS};
    def.shutter = 0.25;
    EXPECT_EQ(simulate(scene, def)->recording->size(), 21U + 4U * 21U + 1U + 4U);
}

TEST(Motions, CanBeCancelled) {
    for (const char* const solver :
         {"method = \"auto\"", "method = \"relaxation\"\nstep = 1e-5\nsweeps = 8"}) {
        const CancelScope stop = test::cancel_after(3);
        EXPECT_EQ(failure_of([&] { std::ignore = motion_by(solver); }).code, ExitCode::kInterrupted);
    }
    const auto motion = motion_by("method = \"relaxation\"\nstep = 1e-5\nsweeps = 8");
    const State state = motion->at(0.777);
    {
        const CancelScope stop = test::cancel_after(0);
        EXPECT_EQ(failure_of([&] { std::ignore = motion->at(0.777); }).code, ExitCode::kInterrupted);
    }
    expect_same(motion->at(0.777), state);
}

TEST(Motions, ThatDivergeEndEarly) {
    const auto motion = motion_by("method = \"relaxation\"\nforce = [1e300, 0.0]");
    EXPECT_TRUE(motion->diverges());
    ASSERT_GE(motion->recording->size(), 1U);
    EXPECT_LT(motion->end_s(), 1.0);
    EXPECT_EQ(motion->at(0.0).time_s, 0.0);
    for (const double time_s : {1.0, 0.99}) {
        const test::Failure failure = failure_of([&] { std::ignore = motion->at(time_s); });
        EXPECT_EQ(failure.code, ExitCode::kDiverged);
        EXPECT_NE(failure.message.find("a smaller solver.step"), std::string::npos) << failure.message;
    }
    EXPECT_FALSE(motion_by("method = \"rattle\"")->diverges());
}

TEST(Motions, NameThePinsThatPullALinkApart) {
    const Scene scene = parse_scene(R"(schema = 1
[world]
duration = 3.0
[[rope]]
hang = { links = 1, length = 1.0 }
[[rope]]
points = [[0, 0], [0.3, -0.4], [0.6, 0]]
pinned = [0, -1]
moves = [{ pin = -1, path = [{ t = 0.0, by = [0.0, 0.0] }, { t = 2.0, by = [2.0, 0.0] }] }]
)",
                                    "a");
    const auto motion = simulate(scene, {});
    ASSERT_TRUE(motion->diverges());
    EXPECT_EQ(divergence_of(*motion).cause,
              "; pins 0 and 2 of rope 1 are then 1.02 m apart, and the links between them reach 1 m");
    const test::Failure failure = failure_of([&] { std::ignore = motion->at(3.0); });
    EXPECT_NE(failure.message.find("of rope 1 are then"), std::string::npos) << failure.message;
    EXPECT_NE(failure.message.find("; pins that stay within reach of each other"), std::string::npos);
}

// Thrown, with a hole: cells come into line at 0.3 s.
TEST(Motions, OfNetsThatDivergeNameTheMethodThatHelps) {
    constexpr int kSide = 8;
    constexpr int kHole = 19;
    std::string points;
    std::string bars;
    const auto number = [](int k) { return std::to_string(k > kHole ? k - 1 : k); };
    const auto join = [&](int a, int b) {
        if (a != kHole && b != kHole) bars += "[" + number(a) + ", " + number(b) + "], ";
    };
    for (int k = 0; k < kSide * kSide; ++k) {
        const double spacing_m = 1.0 / (kSide - 1);
        if (k != kHole)
            points += fmt::format("[{}, {}], ", spacing_m * (k % kSide), -spacing_m * (k / kSide));
        if (k % kSide < kSide - 1) join(k, k + 1);
        if (k / kSide < kSide - 1) join(k, k + kSide);
    }
    const auto motion_of = [&](const std::string& solver) {
        return simulate(
            parse_scene("schema = 1\n[world]\nduration = 0.5\n[solver]\n" + solver + "\n[[net]]\npoints = [" +
                            points + "]\nbars = [" + bars + "]\npinned = [0, 7]\nvelocity = [0.5, 0.0]\n",
                        "a"),
            {});
    };
    const auto motion = motion_of("method = \"exact\"\ntolerance = 1e-8");
    ASSERT_TRUE(motion->diverges());
    EXPECT_EQ(divergence_of(*motion).remedy,
              "method rattle, which passes lines of bars, less speed or force");
    EXPECT_FALSE(motion_of("method = \"rattle\"")->diverges());
}

TEST(Motions, ReportTheirProgress) {
    std::vector<std::int64_t> heard;
    RecordDef def;
    def.on_progress = [&](std::int64_t done, std::int64_t all) {
        EXPECT_EQ(all, 21);
        heard.push_back(done);
        return true;
    };
    std::ignore = motion_by("method = \"exact\"", def);
    EXPECT_GE(std::ranges::max(heard), 19);
}

}  // namespace
}  // namespace corda::film
