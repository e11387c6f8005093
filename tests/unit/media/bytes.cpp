#include "corda/media/bytes.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace corda::media {
namespace {

constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();

TEST(Checked, ArithmeticGivesTheResultOrNone) {
    EXPECT_EQ(checked_add(kMost, std::int64_t{0}), kMost);
    EXPECT_EQ(checked_add(kMost, std::int64_t{1}), std::nullopt);
    EXPECT_EQ(checked_add(std::uint64_t{1}, ~std::uint64_t{0}), std::nullopt);
    EXPECT_EQ(checked_multiply(kMost / 2, std::int64_t{2}), kMost - 1);
    EXPECT_EQ(checked_multiply(kLeast, std::int64_t{-1}), std::nullopt);
}

TEST(SaneStamps, CanBeAddedAFewTimes) {
    EXPECT_TRUE(is_sane_stamp(0));
    EXPECT_TRUE(is_sane_stamp(-(std::int64_t{1} << 60)));
    EXPECT_FALSE(is_sane_stamp((std::int64_t{1} << 60) + 1));
    EXPECT_FALSE(is_sane_stamp(kMost));
    EXPECT_FALSE(is_sane_stamp(kLeast));  // AV_NOPTS_VALUE
}

}  // namespace
}  // namespace corda::media
