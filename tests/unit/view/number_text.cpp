#include "corda/view/number_text.hpp"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

namespace corda::view {
namespace {

TEST(NumberText, IsRoundedUpToTwoDigits) {
    EXPECT_EQ(rounded_up(0.031), 0.031);
    EXPECT_EQ(rounded_up(0.0311), 0.032);
    EXPECT_EQ(rounded_up(9.91), 10.0);
    EXPECT_EQ(rounded_up(1.001), 1.1);
    EXPECT_EQ(rounded_up(5.449), 5.5);
    EXPECT_EQ(power_text(3.1e-12), "3.1·10⁻¹²");
    EXPECT_EQ(power_text(3.11e-12), "3.2·10⁻¹²");
    EXPECT_EQ(power_text(2e45), "2.0·10⁴⁵");
    EXPECT_EQ(power_text(0.0), "0");
}

TEST(LengthText, HasAUnitThatFits) {
    for (const auto& [digit, exponent, text] : {std::tuple{1, 0, "1 m"},
                                                {5, 2, "500 m"},
                                                {2, 3, "2 km"},
                                                {1, 8, "100000 km"},
                                                {2, -1, "20 cm"},
                                                {5, -2, "5 cm"},
                                                {1, -3, "1 mm"},
                                                {2, -4, "200 µm"},
                                                {5, -9, "5 nm"},
                                                {2, -10, "0.2 nm"}})
        EXPECT_EQ(length_text(digit, exponent), text);
}

TEST(RoundedUp, KeepsValuesThatAreNotPositive) {
    const double infinite = std::numeric_limits<double>::infinity();
    EXPECT_EQ(rounded_up(infinite), infinite);
    EXPECT_EQ(rounded_up(0.0), 0.0);
    EXPECT_TRUE(std::isnan(rounded_up(std::nan(""))));
}

TEST(RoundedUp, DoesNotDependOnTheLocale) {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* const name : {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8"}) {
        if (std::setlocale(LC_ALL, name) == nullptr) continue;  // not installed
        EXPECT_EQ(rounded_up(0.00123), 0.0013) << name;
    }
    std::setlocale(LC_ALL, before.c_str());
    EXPECT_EQ(rounded_up(0.00123), 0.0013);
}

TEST(NumberText, HasAMinusSign) {
    EXPECT_EQ(display_number(-0.25), "−0.25");
    EXPECT_EQ(display_number(-0.0), "0");
    EXPECT_EQ(display_number(1e6), "1e+06");
}

TEST(RoundNumbers, AreTheNearestOnes) {
    for (const auto& [value, below, above] : {std::tuple{1.0, 1.0, 1.0},
                                              {1.001, 1.0, 2.0},
                                              {0.3, 0.2, 0.5},
                                              {5.0, 5.0, 5.0},
                                              {7e-12, 5e-12, 1e-11},
                                              {999.0, 500.0, 1000.0},
                                              {1e-3, 1e-3, 1e-3}}) {
        EXPECT_DOUBLE_EQ(round_number_below(value).value(), below);
        EXPECT_DOUBLE_EQ(round_number_above(value).value(), above);
    }
    EXPECT_EQ(round_number_above(0.1).times(3.0), 0.3);
}

TEST(Logarithm, IsNearTheLibrarys) {
    for (int i = -30000; i <= 30000; ++i) {
        const double value = std::exp(0.0231 * i);
        EXPECT_NEAR(log10_of(value), std::log10(value), 1e-13) << value;  // measured 5.7e-14, half a last bit
    }
    for (int exponent = -300; exponent <= 300; ++exponent)
        EXPECT_NEAR(log10_of(power_of_10(exponent)), exponent, 1e-13);
    EXPECT_EQ(log10_of(1.0), 0.0);
}

TEST(NumberTitles, HaveNoPrefixForAngles) {
    EXPECT_EQ(title_of("angle", "°", 3e-4).text, "angle (10⁻⁶ °)");
    EXPECT_EQ(title_of("angular velocity", "rad/s", 31.0).text, "angular velocity (rad/s)");
}

TEST(NumberTitles, HaveAPrefixThatFits) {
    EXPECT_EQ(title_of("energy", "J", 550.0).text, "energy (J)");
    EXPECT_EQ(title_of("energy", "J", 5.5e6).text, "energy (MJ)");
    EXPECT_EQ(title_of("energy", "J", 5.5e6).unit, 1e6);
    EXPECT_EQ(title_of("x", "m", 3e-6).text, "x (µm)");
    EXPECT_EQ(title_of("energy", "J", 3e-16).text, "energy (10⁻¹⁸ J)");
    EXPECT_EQ(title_of("energy", "J", 0.0).text, "energy (J)");
}

}  // namespace
}  // namespace corda::view
