#include <gtest/gtest.h>

#include <array>
#include <string>

#include "corda/scene/nearest_key.hpp"

namespace corda::scene {
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

TEST(NearestKey, FindsTheOneThatWasMeant) {
    EXPECT_EQ(nearest_key("masss", kWords), "mass");
    EXPECT_EQ(nearest_key("Mass", kWords), "mass");
    EXPECT_EQ(nearest_key("point", kWords), "points");
    EXPECT_EQ(nearest_key("tolerence", kWords), "tolerance");
    EXPECT_EQ(nearest_key("tolerance_p", kWords), "tolerance_px");
    EXPECT_EQ(nearest_key("partcles", kWords), "particles");
    EXPECT_EQ(nearest_key("part", kWords), "particles");
    EXPECT_EQ(nearest_key("fbs", kWords), "fps");
}

TEST(NearestKey, GivesNothingWhereNoneIsClose) {
    EXPECT_FALSE(nearest_key("", kWords));
    EXPECT_FALSE(nearest_key("weight", kWords));
    EXPECT_FALSE(nearest_key("ab", kWords));
    EXPECT_FALSE(nearest_key(std::string(100'000, 'm'), kWords));
    EXPECT_FALSE(nearest_key("mass", {}));
}

}  // namespace
}  // namespace corda::scene
