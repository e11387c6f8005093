#include "corda/core/timeline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace corda {
namespace {

const FrameRate kNtsc(Rational{30000, 1001});

TEST(Timeline, WithFramesOnlyHasTheirTimes) {
    const Timeline timeline(kNtsc, 100);
    ASSERT_EQ(timeline.size(), 101U);
    for (std::int64_t k = 0; k <= 100; ++k) {
        const auto i = static_cast<std::size_t>(k);
        EXPECT_EQ(timeline.time_s(i), kNtsc.time_s(k));
        EXPECT_TRUE(timeline.is_frame(i));
        EXPECT_EQ(timeline.find(kNtsc.time_s(k)), i);
    }
    EXPECT_EQ(timeline.find(0.01), std::nullopt);
    EXPECT_EQ(timeline.find(kNtsc.time_s(101)), std::nullopt);
}

TEST(Timeline, MergesOtherTimesInOrderAndDropsThoseOfFrames) {
    // 10 frames per second; 0.2 is a frame's time, and 0.25 is given twice.
    const Timeline timeline(FrameRate(Rational{10, 1}), 3, {0.9, 0.25, 0.2, 0.05, 0.25});
    const std::vector<double> expected{0.0, 0.05, 0.1, 0.2, 0.25, 0.3, 0.9};
    ASSERT_EQ(timeline.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_DOUBLE_EQ(timeline.time_s(i), expected[i]);
        EXPECT_EQ(timeline.find(timeline.time_s(i)), i);
    }
    EXPECT_FALSE(timeline.is_frame(1));
    EXPECT_TRUE(timeline.is_frame(3));
    EXPECT_FALSE(timeline.is_frame(6));
}

TEST(Timeline, IncreasesForEveryRate) {
    for (const Rational rate : {Rational{24000, 1001}, Rational{1, 7}, Rational{1000000, 3}}) {
        const FrameRate fps(rate);
        const double end_s = fps.time_s(50);
        const Timeline timeline(fps, 50, {0.1 * end_s, 0.5 * end_s, 0.999 * end_s, 2.0 * end_s});
        for (std::size_t i = 1; i < timeline.size(); ++i)
            EXPECT_LT(timeline.time_s(i - 1), timeline.time_s(i));
    }
}

TEST(TimeWithin, TreatsARoundingErrorBeyondTheEndAsTheEnd) {
    EXPECT_EQ(time_within(0.1 + 0.1 + 0.1, 0.3), 0.3);  // 0.30000000000000004
    EXPECT_EQ(time_within(0.3 - 0.1 - 0.2, 0.3), 0.0);  // -2.8e-17
    EXPECT_FALSE(std::signbit(time_within(-0.0, 0.3).value()));
    EXPECT_EQ(time_within(0.25, 0.3), 0.25);
    EXPECT_EQ(time_within(0.3001, 0.3), std::nullopt);
    EXPECT_EQ(time_within(-1e-6, 0.3), std::nullopt);
    EXPECT_EQ(time_within(std::nan(""), 0.3), std::nullopt);
}

}  // namespace
}  // namespace corda
