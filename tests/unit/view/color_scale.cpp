#include "corda/view/color_scale.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "corda/view/look.hpp"
#include "corda/view/number_text.hpp"

namespace corda::view {
namespace {

sim::Spread spread_of(std::initializer_list<double> values) {
    sim::Spread spread;
    for (const double value : values) spread.add(value);
    return spread;
}

ColorScale scale(std::initializer_list<double> values, Theme theme = Theme::kDark,
                 Quantity quantity = Quantity::kTension) {
    StyleDef style;
    style.theme = theme;
    return scale_of(quantity, spread_of(values), style);
}

TEST(ColorScale, EndsAtARoundNumber) {
    EXPECT_EQ(scale({0.0, 3.0}).high, 3.0);
    EXPECT_EQ(scale({1.0, 3.01}).high, 4.0);
    EXPECT_EQ(scale({712.0}).high, 800.0);
    EXPECT_EQ(scale({8.1e-7}).high, 1e-6);
    EXPECT_NEAR(scale({0.3}).high, 0.3, 1e-15);
    EXPECT_EQ(scale({712.0}).low, 0.0);
    EXPECT_EQ(scale({}).high, 1.0);
    EXPECT_EQ(scale({0.0, 1e-15}).high, 1.0);  // rounding alone
    EXPECT_LE(scale({1e308}).high, 1e301);
}

TEST(ColorScale, GoesBelowZeroIfValuesDo) {
    EXPECT_EQ(scale({-0.01, 1.0}).low, 0.0);
    EXPECT_EQ(scale({-0.1, 1.0}).low, -1.0);
    EXPECT_EQ(scale({-7.0, 1.0}).high, 8.0);
    const ColorScale about_zero = scale({-1.0, 1.0});
    const Color zero = about_zero.color(0.0);
    EXPECT_TRUE(zero.r == zero.g && zero.g == zero.b);
    EXPECT_GT(about_zero.color(-1.0).b, about_zero.color(-1.0).r);
    EXPECT_GT(about_zero.color(1.0).r, about_zero.color(1.0).b);
}

TEST(ColorScale, IsCutWhereFewValuesLieFarBeyond) {
    sim::Spread spread;
    for (int i = 0; i < 1000; ++i) spread.add(1.0 + 0.001 * i);
    spread.add(500.0);
    const ColorScale cut = scale_of(Quantity::kSpeed, spread, {});
    EXPECT_TRUE(cut.is_cut);
    EXPECT_LE(cut.high, 3.0);
    EXPECT_EQ(cut.color(500.0), cut.color(cut.high));
    EXPECT_FALSE(scale({1.0, 1.5}).is_cut);
}

TEST(ColorScale, HasAColourOfItsOwnForWhatIsNotKnown) {
    const ColorScale one = scale({1.0});
    EXPECT_EQ(one.color(std::nan("")), look_of({}).support);
    EXPECT_EQ(one.color(-5.0), one.colors.front());
    EXPECT_EQ(one.color(1.0), one.colors.back());
    EXPECT_EQ(one.color(0.5), one.colors[4]);
}

TEST(ColorScale, SaysItsUnit) {
    const auto title = [](std::initializer_list<double> values, Quantity quantity) {
        return title_of(scale(values, Theme::kDark, quantity)).text;
    };
    EXPECT_EQ(title({0.5}, Quantity::kTension), "tension (N)");
    EXPECT_EQ(title({2e4}, Quantity::kTension), "tension (kN)");
    EXPECT_EQ(title({0.02}, Quantity::kSpeed), "speed (mm/s)");
    EXPECT_EQ(title({1e-14, 1e20}, Quantity::kSpeed), "speed (10¹⁸ m/s)");
    EXPECT_EQ(title({0.02}, Quantity::kStrain), "strain");
    EXPECT_EQ(title({2e-5}, Quantity::kStrain), "strain (10⁻⁶)");
    EXPECT_EQ(title_of(scale({2e4})).unit, 1e3);
}

}  // namespace
}  // namespace corda::view
