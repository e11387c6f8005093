#include <gmock/gmock.h>

#include <cmath>

#include "corda/sim/simulation.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

using testing::HasSubstr;

const std::vector<double> kTimes{-0.2, 0.1, 0.15, 0.7, 1.3};

/// Two particles: one on a parabola, one at rest.
Vec2 thrown(double t) {
    return {1.5 * t - 0.3, 0.7 + t - 4.905 * t * t};
}

GivenMotion parabola() {
    std::vector<Vec2> positions_m;
    for (const double t : kTimes) {
        positions_m.push_back(thrown(t));
        positions_m.push_back({0.1, -0.0});
    }
    return {kTimes, positions_m};
}

TEST(GivenMotion, HasThePositionsThatWereGivenBitForBit) {
    const GivenMotion motion = parabola();
    EXPECT_EQ(motion.particle_count(), 2U);
    EXPECT_EQ(motion.end_s(), 1.3);
    for (const double t : kTimes) {
        const State state = motion.at(t);
        EXPECT_EQ(state.time_s, t);
        EXPECT_EQ((Vec2{state.x_m[0], state.y_m[0]}), thrown(t));
        EXPECT_EQ(state.x_m[1], 0.1);
        EXPECT_TRUE(std::signbit(state.y_m[1]));
    }
}

TEST(GivenMotion, FollowsAParabolaExactlyBetweenUnequalTimes) {
    const GivenMotion motion = parabola();
    for (double t = 0.0; t <= 1.3; t += 0.01) {
        const State state = motion.at(t);
        EXPECT_NEAR(state.x_m[0], thrown(t).x, 1e-14) << t;  // measured 2.3e-15
        EXPECT_NEAR(state.y_m[0], thrown(t).y, 1e-14) << t;
        EXPECT_NEAR(state.vx_m_s[0], 1.5, 1e-13) << t;
        EXPECT_NEAR(state.vy_m_s[0], 1.0 - 9.81 * t, 1e-13) << t;
        EXPECT_EQ(state.x_m[1], 0.1);
        EXPECT_EQ(state.vx_m_s[1], 0.0);
    }
}

TEST(GivenMotion, RestsAfterItsLastTime) {
    const State state = parabola().at(2.0);
    EXPECT_EQ((Vec2{state.x_m[0], state.y_m[0]}), thrown(1.3));
    EXPECT_EQ(state.vx_m_s[0], 0.0);
}

TEST(GivenMotion, HasNoStateBeforeItsFirstTime) {
    EXPECT_EQ(test::code_of([] { static_cast<void>(parabola().at(-0.21)); }), ExitCode::kUsage);
    EXPECT_EQ(test::code_of([] { static_cast<void>(parabola().at(std::nan(""))); }), ExitCode::kUsage);
}

TEST(GivenMotion, IsAStraightLineBetweenTwoTimes) {
    const State state = GivenMotion({0.0, 2.0}, {{0, 0}, {4, -8}}).at(0.5);
    EXPECT_EQ(state.x_m[0], 1.0);
    EXPECT_EQ(state.vy_m_s[0], -4.0);
}

TEST(GivenMotion, ErrsByTheThirdPowerOfTheInterval) {
    const auto error_m = [](int per_second) {
        std::vector<double> times_s;
        std::vector<Vec2> positions_m;
        for (int k = 0; k <= 2 * per_second; ++k) {
            times_s.push_back(k / static_cast<double>(per_second));
            positions_m.push_back({std::sin(3.0 * times_s.back()), 0.0});
        }
        const GivenMotion motion(times_s, positions_m);
        double largest = 0.0;
        for (double t = 0.5; t < 1.5; t += 0.001)
            largest = std::max(largest, std::abs(motion.at(t).x_m[0] - std::sin(3.0 * t)));
        return largest;
    };
    // Measured: 5.2e-5 at 30 per second. The velocities err by the second power, and so the positions by the
    // third.
    EXPECT_LT(error_m(30), 8e-5);
    EXPECT_NEAR(std::log2(error_m(30) / error_m(60)), 3.0, 0.1);
}

TEST(GivenMotion, IsToldApartByItsHash) {
    const GivenMotion motion({0.0, 1.0}, {{0, 0}, {0, 1}});
    EXPECT_EQ(motion.hash(), GivenMotion({0.0, 1.0}, {{0, 0}, {0, 1}}, "other").hash());
    EXPECT_NE(motion.hash(), GivenMotion({0.0, 1.0}, {{0, 0}, {0, 2}}).hash());
    EXPECT_NE(motion.hash(), GivenMotion({0.0, 2.0}, {{0, 0}, {0, 1}}).hash());
}

TEST(GivenMotion, RefusesWhatIsNoMotion) {
    const double nan = std::nan("");
    struct Case {
        std::vector<double> times_s;
        std::vector<Vec2> positions_m;
        std::string message;
    };
    for (const Case& one : std::vector<Case>{
             {{}, {}, "m.csv: times: 0 times; give at least two"},
             {{0.0}, {{0, 0}}, "m.csv: times: 1 time; give at least two"},
             {{0.0, nan}, {{0, 0}, {0, 0}}, "m.csv: times[1]: nan is not a finite number; give times in s"},
             {{0.0, 0.5, 0.5},
              {{0, 0}, {0, 0}, {0, 0}},
              "m.csv: times[2]: 0.5 s comes after 0.5 s; give times that increase, by 1e-9 s or more"},
             {{0.002, 0.5},
              {{0, 0}, {0, 0}},
              "m.csv: times[0]: the first time is 0.002 s, and a film starts at 0 s; subtract it from all"},
             {{-2.0, -1.0},
              {{0, 0}, {0, 0}},
              "m.csv: times[1]: the last time is -1 s, and a film starts at 0 s; subtract the first time "
              "from all times, or add positions at later ones"},
             {{-2.0, 0.0}, {{0, 0}, {0, 0}}, "m.csv: times[1]: the last time is 0 s, and a film starts"},
             {{0.0, 1.0},
              {{0, 0}, {0, 0}, {0, 0}},
              "m.csv: positions: 3 positions at 2 times; give one per particle and time"},
             {{0.0, 1.0}, {}, "m.csv: positions: 0 positions at 2 times"},
             {{0.0, 1.0},
              {{0, 0}, {0, 0}, {0, 0}, {0, nan}},
              "m.csv: positions[1][1]: [0, nan] is not within -1e12 .. 1e12 m; give finite positions in m"},
             {{0.0, 1.0}, {{0, 0}, {HUGE_VAL, 0}}, "m.csv: positions[1][0]: [inf, 0] is not within"},
             {{0.0, 1.0}, {{0, 0}, {0, 2e12}}, "m.csv: positions[1][0]: [0, 2000000000000] is not within"},
         }) {
        const auto failure = test::failure_of([&] { GivenMotion(one.times_s, one.positions_m, "m.csv"); });
        EXPECT_EQ(failure.code, ExitCode::kUsage);
        EXPECT_THAT(failure.message, HasSubstr(one.message));
    }
}

}  // namespace
}  // namespace corda
