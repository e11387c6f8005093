#include "corda/golden/cases.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace corda::golden {
namespace {

using testing::ElementsAre;

TEST(Variant, HasTheNameOfThePictureAndACause) {
    const std::vector<std::string> references{"ref/swing.nvidia.png", "ref/swing.png",     "ref/swing..png",
                                              "re.f/wing.png",        "ref/.swing.png",    "ref/swing",
                                              "ref/swing.v2.amd.png", "ref/swing.amd.jpg", "ref/.nvidia.png"};
    EXPECT_THAT(variants_of(references, "swing.png"), ElementsAre("ref/swing.nvidia.png", "ref/swing.png"));
    EXPECT_THAT(variants_of(references, "swing.v2.png"), ElementsAre("ref/swing.v2.amd.png"));
}

}  // namespace
}  // namespace corda::golden
