#include "corda/golden/cases.hpp"

#include <gtest/gtest.h>

namespace corda::golden {
namespace {

TEST(Variant, IsNamedByItsCause) {
    EXPECT_EQ(variant_cause("ref/swing.nvidia.png"), "nvidia");
    EXPECT_EQ(base_of_variant("ref/swing.nvidia.png"), "swing.png");
    EXPECT_EQ(variant_cause("swing.v2.old_mesa.mp4"), "old_mesa");
    EXPECT_EQ(base_of_variant("swing.v2.old_mesa.mp4"), "swing.v2.mp4");
}

TEST(Variant, NeedsANameAndACause) {
    for (const char* const name : {"swing.png", "re.f/swing.png", ".nvidia.png", "swing..png", "swing", ""}) {
        EXPECT_EQ(variant_cause(name), "") << name;
        EXPECT_EQ(base_of_variant(name), "") << name;
    }
}

}  // namespace
}  // namespace corda::golden
