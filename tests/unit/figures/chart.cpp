#include "corda/figures/chart.hpp"

#include <gtest/gtest.h>

namespace corda::figures {
namespace {

TEST(QuantityText, HasThreeDigitsAndAPrefix) {
    EXPECT_EQ(quantity_text(27345.0, "N"), "27.3 kN");
    EXPECT_EQ(quantity_text(5.0, "m/s"), "5 m/s");
    EXPECT_EQ(quantity_text(0.0, "N"), "0 N");
    EXPECT_EQ(quantity_text(4.9512e-8, "N"), "49.5 nN");
    EXPECT_EQ(quantity_text(-0.5, "J"), "-0.5 J");
}

TEST(QuantityText, OfBareNumbersIsAPower) {
    EXPECT_EQ(quantity_text(0.25123, ""), "0.251");
    EXPECT_EQ(quantity_text(3.04e-12, ""), "3.1·10⁻¹²");
    EXPECT_EQ(quantity_text(0.0, ""), "0");
}

TEST(QuantityText, OfATimeHasFourDigits) {
    EXPECT_EQ(time_text(1.0 / 60.0), "0.01667 s");
    EXPECT_EQ(time_text(10.0), "10 s");
}

}  // namespace
}  // namespace corda::figures
