#pragma once

#include <cmath>
#include <functional>

namespace corda::test {

/// The argument between `low` and `high` at which a function changes sign, by the Illinois form of regula
/// falsi.
inline double root(const std::function<double(double)>& f, double low, double high) {
    double f_low = f(low);
    double f_high = f(high);
    double middle = low;
    for (int k = 0; k < 60 && std::abs(high - low) > 1e-15 * std::abs(high); ++k) {
        const double last = middle;
        middle = (low * f_high - high * f_low) / (f_high - f_low);
        if (middle == last) break;
        const double f_middle = f(middle);
        if (f_middle == 0.0) break;
        if ((f_middle < 0.0) != (f_high < 0.0)) {
            low = high;
            f_low = f_high;
        } else {
            f_low *= 0.5;
        }
        high = middle;
        f_high = f_middle;
    }
    return middle;
}

}  // namespace corda::test
