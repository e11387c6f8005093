#pragma once

#include <gtest/gtest.h>

#include "corda/core/image.hpp"

namespace corda::test {

/// Whether two pictures have the same bytes; the failure names the sizes, the count and the first pixel that
/// differs.
[[nodiscard]] testing::AssertionResult equal_images(const Image& actual, const Image& expected);

}  // namespace corda::test
