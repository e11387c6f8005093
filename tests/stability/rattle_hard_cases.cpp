// Method `rattle` in the hard cases of section 5 of src/sim/README.md: a result within bounds, or a named
// failure.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/reference/numbers.hpp"
#include "corda/reference/ropes.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

bool long_tests() {
    return std::getenv("CORDA_TEST_LONG") != nullptr;
}

double seconds_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

class Payload : public testing::TestWithParam<std::tuple<int, double, double>> {};

TEST_P(Payload, KeepsLengthsAndEnergy) {
    const auto [links, angle_deg, payload_kg] = GetParam();
    RopeDef rope = reference::straight_rope(links, 1.0, angle_deg);
    rope.payload_kg = payload_kg;
    test::RattleRun run(rope, WorldDef{}, 6);
    const double start_s = seconds_now();
    // A light rope with a heavy payload takes 2e5 steps per second: all of the ten seconds in the long form
    // only.
    ASSERT_TRUE(run.go(links * payload_kg > 2e7 && !long_tests() ? 1.0 : 10.0, 600));
    std::printf("N=%d %g deg payload %g: strain %.1e energy %.1e, %llu steps %llu parts, %.2f s\n", links,
                angle_deg, payload_kg, run.strain(), run.energy_error(),
                static_cast<unsigned long long>(run.solver().steps()),
                static_cast<unsigned long long>(run.solver().parts()), seconds_now() - start_s);
    EXPECT_LT(run.strain(), 1e-9);
    EXPECT_LT(run.energy_error(), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Section5, Payload,
                         testing::Combine(testing::Values(10, 50), testing::Values(45.0, 90.0),
                                          testing::Values(1e3, 1e6)));

TEST(LongRope, OfAThousandLinksFinishes) {
    test::RattleRun run(reference::straight_rope(1000, 1.0, 45.0), WorldDef{}, 2);
    const double start_s = seconds_now();
    ASSERT_TRUE(run.go(long_tests() ? 5.0 : 0.5, 30));
    std::printf("N=1000: strain %.1e energy %.1e, %llu steps, %.2f s\n", run.strain(), run.energy_error(),
                static_cast<unsigned long long>(run.solver().steps()), seconds_now() - start_s);
    EXPECT_LT(run.strain(), 1e-11);
    EXPECT_LT(run.energy_error(), 1e-3);
}

TEST(LongRope, OfAHundredThousandLinksGoesOn) {
    test::RattleRun run(reference::straight_rope(100'000, 1.0, 45.0), WorldDef{}, 2);
    // Links of 10 micrometres under a ton of weight each step by 0.6 microseconds.
    ASSERT_TRUE(run.go(long_tests() ? 0.1 : 50.0 * run.solver().step_s(), 10));
    // measured after 50 steps: strain 8e-12, rounding of positions over the links' length; energy 4e-16
    EXPECT_LT(run.strain(), 1e-9);
    EXPECT_LT(run.energy_error(), 1e-3);
}

TEST(LinkLengths, FromOneToAHundredKeepLengthsAndEnergy) {
    std::vector<Vec2> points_m(1);
    constexpr int kLinks = 11;
    for (int i = 0; i < kLinks; ++i) {
        const double link_m = 0.002 * std::pow(100.0, (i * 7 % kLinks) / (kLinks - 1.0));
        const Vec2 last = points_m.back();
        points_m.push_back({last.x + link_m * std::sqrt(0.5), last.y - link_m * std::sqrt(0.5)});
    }
    test::RattleRun run(reference::rope_through(std::move(points_m)), WorldDef{}, 8);
    ASSERT_TRUE(run.go(10.0, 600));
    std::printf("links 1:100: strain %.1e energy %.1e, %llu steps %llu parts\n", run.strain(),
                run.energy_error(), static_cast<unsigned long long>(run.solver().steps()),
                static_cast<unsigned long long>(run.solver().parts()));
    EXPECT_LT(run.strain(), 1e-12);
    EXPECT_LT(run.energy_error(), 1e-8);
}

TEST(Masses, FromAMillionthToAMillionKilogramsWork) {
    for (const bool heavy_first : {true, false}) {
        RopeDef rope = reference::straight_rope(6, 1.0, 60.0);
        rope.mass_kg = {1.0, 1e6, 1e-6, 1.0, 1e-6, 1e6, 1e-3};
        if (heavy_first) rope.mass_kg = {1.0, 1e6, 1e4, 1e2, 1.0, 1e-3, 1e-6};
        test::RattleRun run(rope, WorldDef{}, 8);
        ASSERT_TRUE(run.go(0.02, 60));
        std::printf("masses: strain %.1e energy %.1e, h %.1e, %llu steps %llu parts\n", run.strain(),
                    run.energy_error(), run.solver().step_s(),
                    static_cast<unsigned long long>(run.solver().steps()),
                    static_cast<unsigned long long>(run.solver().parts()));
        EXPECT_LT(run.strain(), 1e-12);
        EXPECT_LT(run.energy_error(), 1e-8);
    }
}

TEST(ThrownTip, AtAHundredMetresPerSecondKeepsItsEnergy) {
    for (const int links : {1, 10, 20}) {
        RopeDef rope = reference::straight_rope(links, 1.0, 30.0);
        rope.velocity_m_s.back() = {100.0 * std::cos(std::numbers::pi / 6.0), 100.0 * 0.5};
        test::RattleRun run(rope, WorldDef{}, 8);
        const double start_s = seconds_now();
        ASSERT_TRUE(run.go(links == 1 ? 10.0 : 1.0, 600));
        const double relative = run.largest_energy_change_j() / (0.5 * 100.0 * 100.0);
        std::printf("thrown, N=%d: strain %.1e energy %.1e, h %.1e, %llu steps %llu parts, %.2f s\n", links,
                    run.strain(), relative, run.solver().step_s(),
                    static_cast<unsigned long long>(run.solver().steps()),
                    static_cast<unsigned long long>(run.solver().parts()), seconds_now() - start_s);
        EXPECT_LT(run.strain(), 1e-12);
        EXPECT_LT(relative, 1e-6) << links;
    }
}

TEST(Undamped, FiftyLinksFromTheHorizontalForAMinute) {
    test::RattleRun run(reference::straight_rope(50, 1.0, 90.0), WorldDef{}, 8);
    const double start_s = seconds_now();
    ASSERT_TRUE(run.go(60.0, 3600));
    std::printf("N=50 60 s: strain %.1e energy %.1e, %.2f s\n", run.strain(), run.energy_error(),
                seconds_now() - start_s);
    EXPECT_LT(run.strain(), 1e-12);
    EXPECT_LT(run.energy_error(), 1e-3);
}

TEST(ManySteps, OfOneLinkKeepTheEnergyWithoutATrend) {
    for (const int order : {2, 8}) {
        const int steps = long_tests() ? 10'000'000 : (order == 2 ? 1'000'000 : 200'000);
        const double step_s = order == 2 ? 1.0 / 1000.0 : 1.0 / 100.0;
        test::RattleRun run(reference::straight_rope(1, 1.0, 90.0), WorldDef{}, order, step_s);
        ASSERT_TRUE(run.go(0.1 * steps * step_s, 5000));
        const double early = run.energy_error();
        ASSERT_TRUE(run.go(1.0 * steps * step_s, 45000));
        std::printf("order %d, %d steps: energy %.3e in the first tenth, %.3e in all\n", order, steps, early,
                    run.energy_error());
        // measured: order 2, 3.7e-6, the method's own, of which a trend would make ten times as much; order 8
        // 4e-15 after 2e5 steps and 8.9e-14 after 1e7, all of it rounding.
        EXPECT_LT(run.energy_error(), order == 2 ? 1.01 * early : 1e-12);
        EXPECT_LT(run.energy_error(), 1e-5);
    }
}

TEST(Inverted, ExactlyUprightStays) {
    test::RattleRun run(reference::straight_rope(10, 1.0, 180.0), WorldDef{}, 4);
    ASSERT_TRUE(run.go(10.0, 10));
    EXPECT_EQ(run.tip_x(), 0.0);
    EXPECT_NEAR(run.tip_y(), 1.0, 1e-14);
    EXPECT_NEAR(run.loads()->largest_tension_n, 98.1, 1e-10);
}

TEST(Steps, ThatAreMuchTooLongAreDivided) {
    constexpr Vec2 kTip = reference::released_tip_m(20, 45.0, 2.0);
    for (const double step_s : {1.0, 0.1}) {
        test::RattleRun run(reference::straight_rope(20, 1.0, 45.0), WorldDef{}, 8, step_s);
        ASSERT_TRUE(run.go(2.0));
        EXPECT_GT(run.solver().parts(), 100U);
        std::printf("h=%g: error %.1e with %llu parts\n", step_s, run.tip_error_m(kTip),
                    static_cast<unsigned long long>(run.solver().parts()));
        EXPECT_LT(run.tip_error_m(kTip), 1e-6);
    }
}

TEST(Steps, OfANanosecondWork) {
    test::RattleRun run(reference::straight_rope(20, 1.0, 45.0), WorldDef{}, 4, 1e-9);
    ASSERT_TRUE(run.go(1e-5));
    EXPECT_EQ(run.solver().steps(), 10000U);
    EXPECT_LT(run.strain(), 1e-13);
    EXPECT_NEAR(run.tip_y() - run.system().y_m.back(), -0.5 * 9.81 * 0.5 * 1e-10, 1e-12);
}

TEST(StraightBetweenPins, IsRefusedWithTheReason) {
    RopeDef rope = reference::straight_rope(10, 1.0, 90.0);
    rope.pinned = {0, 10};
    try {
        test::RattleRun run(rope, WorldDef{}, 4);
        FAIL() << "not refused";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kInvalidScene);
        EXPECT_NE(std::string(error.what()).find("straight"), std::string::npos) << error.what();
    }
}

TEST(PulledTaut, BetweenPinsItGoesOnOrSaysThatItDiverged) {
    // Thrown upwards so hard that the middle is pulled straight against both pins.
    RopeDef rope = reference::straight_rope(2, 1.0, 90.0);
    rope.points_m = {{0.0, 0.0}, {0.4, -0.3}, {0.8, 0.0}};
    rope.pinned = {0, 2};
    test::RattleRun run(rope, WorldDef{}, 4);
    EXPECT_TRUE(run.go(1.0));  // a triangle: it cannot move at all
    RopeDef longer = reference::straight_rope(10, 1.0, 90.0);
    for (std::size_t i = 0; i <= 10; ++i)
        longer.points_m[i] = {0.08 * static_cast<double>(i), i % 2 == 0 ? 0.0 : -0.06};
    longer.pinned = {0, 10};
    for (std::size_t i = 1; i < 10; ++i) longer.velocity_m_s[i] = {0.0, 5.0};
    test::RattleRun taut(longer, WorldDef{}, 4);
    if (taut.go(5.0, 300)) {
        EXPECT_LT(taut.strain(), 1e-9);
        std::printf("taut: energy %.1e parts %llu/%llu\n", taut.energy_error(),
                    static_cast<unsigned long long>(taut.solver().parts()),
                    static_cast<unsigned long long>(taut.solver().steps()));
    } else {
        std::printf("taut: diverged\n");
    }
}

}  // namespace
}  // namespace corda::sim
