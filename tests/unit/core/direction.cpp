#include "corda/core/direction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <ostream>

namespace corda {
namespace {

struct Rounded {
    double angle_deg;
    double sine;
    double cosine;
};

void PrintTo(const Rounded& rounded, std::ostream* out) {
    *out << rounded.angle_deg << " degrees";
}

/// Computed from fractions, and rounded once. The C library of Debian 12 rounds 11.9 and 43.7 the other way,
/// and the rounding of 44.1276 depends on whether the CPU has FMA.
constexpr Rounded kRounded[] = {
    {1e-09, 0x1.330aa445be654p-36, 0x1.0000000000000p+0},
    {0.1, 0x1.c98701025eb1fp-10, 0x1.ffffcce4c8e64p-1},
    {11.9, 0x1.a64e61449d60fp-3, 0x1.f4ff2133b5657p-1},
    {18.0, 0x1.3c6ef372fe94fp-2, 0x1.e6f0e134454ffp-1},
    {30.0, 0x1.fffffffffffffp-2, 0x1.bb67ae8584cabp-1},
    {33.3, 0x1.191984d01e95bp-1, 0x1.abeef145aa617p-1},
    {43.7, 0x1.61bb56e1e9d93p-1, 0x1.7228bfef87325p-1},
    {44.1276, 0x1.647c035c61b47p-1, 0x1.6f824cd1db374p-1},
    {45.0, 0x1.6a09e667f3bccp-1, 0x1.6a09e667f3bcdp-1},
};

class RoundedDirection : public testing::TestWithParam<Rounded> {};

TEST_P(RoundedDirection, IsRoundedOnce) {
    const Direction direction = direction_of(GetParam().angle_deg);
    EXPECT_EQ(direction.sine, GetParam().sine);
    EXPECT_EQ(direction.cosine, GetParam().cosine);
}

TEST_P(RoundedDirection, MirrorsWithoutRounding) {
    const Direction direction = direction_of(-GetParam().angle_deg);
    EXPECT_EQ(direction.sine, -GetParam().sine);
    EXPECT_EQ(direction.cosine, GetParam().cosine);
}

INSTANTIATE_TEST_SUITE_P(Angles, RoundedDirection, testing::ValuesIn(kRounded));

TEST(DirectionOf, IsExactAtMultiplesOfARightAngle) {
    const Rounded kRight[] = {{0.0, 0.0, 1.0},       {90.0, 1.0, 0.0},   {180.0, 0.0, -1.0},
                              {270.0, -1.0, 0.0},    {-90.0, -1.0, 0.0}, {360.0, 0.0, 1.0},
                              {36000090.0, 1.0, 0.0}};
    for (const Rounded& right : kRight) {
        const Direction direction = direction_of(right.angle_deg);
        EXPECT_EQ(direction.sine, right.sine) << right.angle_deg;
        EXPECT_EQ(direction.cosine, right.cosine) << right.angle_deg;
    }
}

TEST(DirectionOf, IsNearTheLibrarysSineAndCosineOfAnyAngle) {
    constexpr double kRadians = std::numbers::pi / 180.0;
    for (int i = -40000; i <= 40000; ++i) {
        const double angle_deg = 0.0173 * i;
        const Direction direction = direction_of(angle_deg);
        EXPECT_NEAR(direction.sine, std::sin(angle_deg * kRadians), 2e-15) << angle_deg;
        EXPECT_NEAR(direction.cosine, std::cos(angle_deg * kRadians), 2e-15) << angle_deg;
    }
}

TEST(AngleRad, IsNearTheLibrarysInAllDirections) {
    for (int i = -40000; i <= 40000; ++i) {
        const double y = 1e3 * std::sin(0.0173 * i);
        const double x = 1e3 * std::cos(0.0173 * i);
        EXPECT_NEAR(angle_rad(y, x), std::atan2(y, x), 2e-15) << i;  // measured 9e-16
    }
    EXPECT_EQ(angle_rad(0.0, 0.0), 0.0);
    EXPECT_EQ(angle_rad(1e300, 0.0), std::numbers::pi / 2.0);
    EXPECT_EQ(angle_rad(0.0, -1e-300), std::numbers::pi);
    EXPECT_EQ(angle_rad(-2.0, 0.0), -std::numbers::pi / 2.0);
}

}  // namespace
}  // namespace corda
