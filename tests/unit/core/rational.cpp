#include "corda/core/rational.hpp"

#include <gtest/gtest.h>

namespace corda {
namespace {

TEST(Rational, IsARateIfBothPartsArePositiveAndNotTooLarge) {
    constexpr std::int64_t kLargest = Rational::kMaxPart;
    for (const Rational rate : {Rational{1, 1}, Rational{30000, 1001}, Rational{kLargest, kLargest}})
        EXPECT_TRUE(rate.is_rate()) << rate.text();
    for (const Rational other : {Rational{0, 1}, Rational{-60, 1}, Rational{60, 0}, Rational{60, -1},
                                 Rational{kLargest + 1, 1}, Rational{1, kLargest + 1}})
        EXPECT_FALSE(other.is_rate()) << other.text();
}

TEST(Rational, ReadsIntegersAndFractionsInLowestTerms) {
    EXPECT_EQ(Rational::parse("60"), (Rational{60, 1}));
    EXPECT_EQ(Rational::parse("30000/1001"), (Rational{30000, 1001}));
    EXPECT_EQ(Rational::parse("50/2"), (Rational{25, 1}));
    EXPECT_EQ(Rational::parse("24000/1001")->text(), "24000/1001");
    EXPECT_EQ(Rational::parse("120/2")->text(), "60");
}

TEST(Rational, RejectsOtherText) {
    for (const char* text :
         {"", "/", "60/", "/2", "60/0", "-60", "6e1", "60.0", " 60", "60/1/1", "99999999999", "0x10"}) {
        EXPECT_FALSE(Rational::parse(text).has_value()) << text;
    }
}

TEST(FrameRate, FrameTimesComeFromIntegers) {
    const FrameRate ntsc(Rational{30000, 1001});
    EXPECT_EQ(ntsc.time_s(0), 0.0);
    EXPECT_EQ(ntsc.time_s(30000), 1001.0);
    EXPECT_EQ(ntsc.time_s(3'000'000'000), 100'100'000.0);
}

TEST(FrameRate, CountsTheFramesThatStartBeforeTheEnd) {
    const FrameRate sixty(Rational{60, 1});
    EXPECT_EQ(sixty.frame_count(10.0), 600);
    EXPECT_EQ(sixty.frame_count(1.0 / 60.0), 1);
    EXPECT_EQ(sixty.frame_count(0.001), 1);
    // 0.1 * 30 is 3.0000000000000004 in binary; three frames are intended.
    EXPECT_EQ(FrameRate(Rational{30, 1}).frame_count(0.1), 3);
    EXPECT_EQ(FrameRate(Rational{30000, 1001}).frame_count(1.0), 30);
    EXPECT_EQ(FrameRate(Rational{24000, 1001}).frame_count(2.0), 48);
}

TEST(FrameRate, LastFrameWithinADurationMayBeAtItsEnd) {
    EXPECT_EQ(FrameRate(Rational{60, 1}).last_frame_within(10.0), 600);
    EXPECT_EQ(FrameRate(Rational{30, 1}).last_frame_within(0.1), 3);
    EXPECT_EQ(FrameRate(Rational{30000, 1001}).last_frame_within(1.0), 29);
}

}  // namespace
}  // namespace corda
