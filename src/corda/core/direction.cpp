#include "corda/core/direction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace corda {
namespace {

/// A number of some 106 bits, as the sum of a double and what its rounding left over (Dekker, Numer. Math.
/// 18, 1971).
struct Pair {
    double high = 0.0;
    double low = 0.0;
};

/// `high` + `low`, of which `low` is small.
Pair normalized(double high, double low) {
    const double sum = high + low;
    return {sum, low - (sum - high)};
}

Pair operator+(Pair a, Pair b) {
    const double sum = a.high + b.high;
    const double from_b = sum - a.high;
    const double lost = (a.high - (sum - from_b)) + (b.high - from_b);
    return normalized(sum, lost + a.low + b.low);
}

Pair operator*(Pair a, Pair b) {
    const double product = a.high * b.high;
    return normalized(product, std::fma(a.high, b.high, -product) + (a.high * b.low + a.low * b.high));
}

Pair operator/(Pair a, double divisor) {
    const double quotient = a.high / divisor;
    return normalized(quotient, (std::fma(-quotient, divisor, a.high) + a.low) / divisor);
}

/// The sum of first - first x^2 / (n (n + 1)) + ..., with n two larger from term to term: the series of the
/// sine and of the cosine of x up to 45 degrees.
double series(Pair first, double x, int n) {
    constexpr int kTerms = 15;  // the next is below 1e-33 of the first
    const Pair minus_square = Pair{-x} * Pair{x};
    Pair sum = first;
    Pair term = first;
    for (int i = 0; i < kTerms; ++i, n += 2) {
        term = term * minus_square / (n * (n + 1.0));
        sum = sum + term;
    }
    return sum.high;
}

}  // namespace

Direction direction_of(double angle_deg) {
    int quarters = 0;
    const double rest_deg = std::remquo(angle_deg, 90.0, &quarters);  // exact
    const double rest_rad = rest_deg * (std::numbers::pi / 180.0);
    const Direction rest{series({rest_rad}, rest_rad, 2), series({1.0}, rest_rad, 1)};
    switch (static_cast<unsigned>(quarters) & 3U) {
        case 1:
            return {rest.cosine, -rest.sine};
        case 2:
            return {-rest.sine, -rest.cosine};
        case 3:
            return {-rest.cosine, rest.sine};
        default:
            return rest;
    }
}

double angle_rad(double y, double x) {
    const double large = std::max(std::abs(x), std::abs(y));
    if (large == 0.0) return 0.0;
    double tangent = std::min(std::abs(x), std::abs(y)) / large;
    for (int halved = 0; halved < 2; ++halved) tangent /= 1.0 + std::sqrt(1.0 + tangent * tangent);
    double sum = 0.0;
    for (int n = 25; n >= 1; n -= 2) sum = 1.0 / n - tangent * tangent * sum;
    double angle = 4.0 * tangent * sum;
    if (std::abs(y) > std::abs(x)) angle = 0.5 * std::numbers::pi - angle;
    if (x < 0.0) angle = std::numbers::pi - angle;
    return y < 0.0 ? -angle : angle;
}

}  // namespace corda
