#include "corda/film/swing.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace corda::film {
namespace {

constexpr double kStep = 1.0 / 30.0;

/// The passages of an angle in rad over time, at unit distance from the pin, up to `end_s`.
Passages passages_of(const std::function<double(double)>& angle_rad, double end_s) {
    constexpr double kSmall = 1e-5;
    Passages passages;
    for (int k = 0; k * kStep <= end_s; ++k) {
        const double t = k * kStep;
        const double angle = angle_rad(t);
        const double rate = (angle_rad(t + kSmall) - angle_rad(t - kSmall)) / (2.0 * kSmall);
        passages.include(t, {std::sin(angle), -std::cos(angle)},
                         {rate * std::cos(angle), rate * std::sin(angle)});
    }
    return passages;
}

TEST(Passages, AreBetweenStatesAndGiveThePeriod) {
    const auto swing = [](double t) { return 0.8 * std::cos(std::numbers::pi * t); };
    const Passages passages = passages_of(swing, 10.0);
    ASSERT_EQ(passages.times_s().size(), 10U);
    for (std::size_t i = 0; i < 10; ++i)
        EXPECT_NEAR(passages.times_s()[i], 0.5 + static_cast<double>(i), 1e-6);  // measured 2e-7
    const Period period = passages.period();
    ASSERT_TRUE(period.seconds);
    EXPECT_NEAR(*period.seconds, 2.0, 1e-6);
    EXPECT_EQ(period.reason, "");
}

TEST(Period, TakesThreePassages) {
    const auto swing = [](double t) { return 0.8 * std::cos(std::numbers::pi * t); };
    for (const double end_s : {0.4, 0.6, 1.6}) {
        const Period period = passages_of(swing, end_s).period();
        EXPECT_FALSE(period.seconds) << end_s;
        EXPECT_EQ(period.reason, "fewer than three passages below the pin");
    }
    EXPECT_NEAR(passages_of(swing, 2.6).period().seconds.value(), 2.0, 1e-6);
}

TEST(Period, NeedsSuccessivePeriodsThatAgree) {
    // Halves of 1.1 s and 0.9 s: whole periods agree.
    const auto lopsided = [](double t) { return 0.12 - 0.8 * std::sin(std::numbers::pi * (t - 0.5)); };
    for (const double end_s : {2.7, 3.7, 10.0})
        EXPECT_NEAR(passages_of(lopsided, end_s).period().seconds.value(), 2.0, 1e-6) << end_s;
    // Of three passages, halves of 1.2 s and 0.8 s do not tell a period.
    const auto oblique = [](double t) { return 0.25 - 0.8 * std::sin(std::numbers::pi * (t - 0.5)); };
    EXPECT_THAT(passages_of(oblique, 2.7).period().reason,
                testing::MatchesRegex("the two halves differ by [0-9]+.[0-9] %, more than 20 %"));
    EXPECT_NEAR(passages_of(oblique, 10.0).period().seconds.value(), 2.0, 1e-6);
    // A swing whose periods become longer, by 2 % per half-period and by 16 %.
    const auto slowing = [](double rate) {
        return [rate](double t) { return 0.8 * std::cos(std::numbers::pi / rate * std::log1p(rate * t)); };
    };
    EXPECT_TRUE(passages_of(slowing(0.02), 10.0).period().seconds);
    const Period none = passages_of(slowing(0.15), 10.0).period();
    EXPECT_FALSE(none.seconds);
    EXPECT_THAT(none.reason,
                testing::MatchesRegex("successive periods differ by [0-9]+.[0-9] %, more than 10 %"));
}

TEST(Period, TellsADifferenceAboveTheLimit) {
    // Periods of 2 s and 2.22272 s differ by 10.02 %.
    Passages passages;
    double side = -1.0;
    for (const double t : {1.0, 2.0, 3.0, 4.22272}) {
        for (const double before_after : {-0.1, 0.1})
            passages.include(t + before_after, {std::copysign(0.1, side * before_after), -1.0}, {side, 0.0});
        side = -side;
    }
    EXPECT_EQ(passages.period().reason, "successive periods differ by 10.1 %, more than 10 %");
}

TEST(Period, NeedsAlternatingDirections) {
    const Period period = passages_of([](double t) { return 3.0 * t; }, 10.0).period();
    EXPECT_FALSE(period.seconds);
    EXPECT_EQ(period.reason, "two successive passages below the pin are in the same direction");
}

TEST(Passages, AreFoundAtStatesThatAreBelowThePin) {
    constexpr double kRate = 0.5 * std::numbers::pi;
    for (const double offset_m : {0.0, -1e-9, 1e-9, -1e-10, 1e-10}) {
        Passages passages;
        const double xs_m[] = {-1.0, 0.0, 1.0, 0.0};
        const double speeds_m_s[] = {0.0, kRate, 0.0, -kRate};
        for (int k = 0; k <= 12; ++k)
            passages.include(k, {xs_m[k % 4] + offset_m, -1.0}, {speeds_m_s[k % 4], 0.0});
        ASSERT_EQ(passages.times_s().size(), 6U) << offset_m;
        for (std::size_t i = 0; i < 6; ++i)
            EXPECT_NEAR(passages.times_s()[i], 1.0 + 2.0 * static_cast<double>(i), 1e-8) << offset_m;
        EXPECT_NEAR(passages.period().seconds.value(), 4.0, 1e-8) << offset_m;
    }
}

TEST(Passages, DoNotCountAStartBelowThePin) {
    for (const double side : {-1.0, 1.0}) {
        const auto swing = [side](double t) { return side * 0.1 * std::sin(std::numbers::pi * t); };
        const std::vector<double> times_s = passages_of(swing, 2.5).times_s();
        ASSERT_EQ(times_s.size(), 2U) << side;
        EXPECT_NEAR(times_s[0], 1.0, 1e-6);
    }
}

TEST(Passages, DoNotCountTheRoundingOfWhatHangsAtRest) {
    EXPECT_TRUE(passages_of([](double t) { return 1e-14 * std::cos(9.0 * t); }, 10.0).times_s().empty());
    EXPECT_EQ(
        passages_of([](double t) { return 1e-6 * std::cos(std::numbers::pi * t); }, 3.0).times_s().size(),
        3U);
}

}  // namespace
}  // namespace corda::film
