#pragma once

#include <gtest/gtest.h>

#include "corda/core/image.hpp"

namespace corda::test {

/// Matches if two pictures have the same bytes. The failure gives the sizes, the number of differing pixels
/// and the first of them.
[[nodiscard]] testing::AssertionResult equal_images(const Image& actual, const Image& expected);

}  // namespace corda::test
