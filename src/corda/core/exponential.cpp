#include "corda/core/exponential.hpp"

#include <cmath>
#include <numbers>

namespace corda {

double natural_log(double x) {
    int exponent = 0;
    double mantissa = std::frexp(x, &exponent);  // exact; 0.5 .. 1
    if (mantissa < 0.5 * std::numbers::sqrt2) {
        mantissa *= 2.0;
        --exponent;
    }
    // ln m = 2 artanh q = 2 (q + q^3 / 3 + ...), |q| < 0.172: the term after the last is below 1e-18.
    const double q = (mantissa - 1.0) / (mantissa + 1.0);
    double sum = 0.0;
    for (int n = 21; n >= 1; n -= 2) sum = 1.0 / n + q * q * sum;
    return exponent * std::numbers::ln2 + 2.0 * q * sum;
}

double exponential(double x) {
    // ln 2 as a sum whose first part, of few bits, has exact multiples.
    constexpr double kLn2High = 0x1.62e42fefap-1;
    constexpr double kLn2Low = 0x1.cf79abc9e3b3ap-40;
    const double twos = std::round(x / std::numbers::ln2);
    const double rest =
        (x - twos * kLn2High) - twos * kLn2Low;  // |rest| < 0.35: the term after the last is below 1e-18
    double sum = 1.0;
    for (int n = 15; n >= 1; --n) sum = 1.0 + rest / n * sum;
    return std::ldexp(sum, static_cast<int>(twos));
}

}  // namespace corda
