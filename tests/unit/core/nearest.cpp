#include <gtest/gtest.h>

#include <array>
#include <string>

#include "corda/core/nearest.hpp"

namespace corda {
namespace {

constexpr std::array<std::string_view, 6> kWords{"mass",      "points",       "particles",
                                                 "tolerance", "tolerance_px", "fps"};

TEST(EditDistance, CountsSingleEdits) {
    EXPECT_EQ(edit_distance("mass", "mass"), 0U);
    EXPECT_EQ(edit_distance("masss", "mass"), 1U);
    EXPECT_EQ(edit_distance("mas", "mass"), 1U);
    EXPECT_EQ(edit_distance("moss", "mass"), 1U);
    EXPECT_EQ(edit_distance("msas", "mass"), 1U);  // two neighbours swapped
    EXPECT_EQ(edit_distance("MASS", "mass"), 0U);
    EXPECT_EQ(edit_distance("", "mass"), 4U);
    EXPECT_EQ(edit_distance("mass", ""), 4U);
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
}

TEST(Nearest, FindsTheNearestWord) {
    EXPECT_EQ(nearest("masss", kWords), "mass");
    EXPECT_EQ(nearest("Mass", kWords), "mass");
    EXPECT_EQ(nearest("point", kWords), "points");
    EXPECT_EQ(nearest("tolerence", kWords), "tolerance");
    EXPECT_EQ(nearest("tolerance_p", kWords), "tolerance_px");
    EXPECT_EQ(nearest("partcles", kWords), "particles");
    EXPECT_EQ(nearest("part", kWords), "particles");
    EXPECT_EQ(nearest("fbs", kWords), "fps");
}

TEST(Nearest, IsEmptyIfNoneIsClose) {
    EXPECT_FALSE(nearest("", kWords));
    EXPECT_FALSE(nearest("weight", kWords));
    EXPECT_FALSE(nearest("mass_of_balls", kWords));
    EXPECT_FALSE(nearest("ab", kWords));
    EXPECT_FALSE(nearest(std::string(100'000, 'm'), kWords));
    EXPECT_FALSE(nearest("mass", {}));
}

}  // namespace
}  // namespace corda
