#pragma once

#include <gtest/gtest.h>

#include <span>
#include <utility>

#include "corda/study/measure.hpp"

namespace corda::test {

/// The exponent of study::fit_slope, which must use every point.
inline double slope(std::span<const std::pair<double, double>> points) {
    const study::Slope fit = study::fit_slope(points).value();
    EXPECT_EQ(fit.points, points.size());
    return fit.exponent;
}

}  // namespace corda::test
