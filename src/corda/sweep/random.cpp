#include "corda/sweep/random.hpp"

#include <cmath>
#include <numbers>

namespace corda::sweep {
namespace {

/// The 32-bit FNV-1a hash (by Fowler, Noll and Vo).
std::uint32_t hash_of(std::string_view text) {
    std::uint32_t hash = 2166136261U;
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
    return hash;
}

constexpr std::uint32_t high_of(std::uint64_t value) {
    return static_cast<std::uint32_t>(value >> 32U);
}
constexpr std::uint32_t low_of(std::uint64_t value) {
    return static_cast<std::uint32_t>(value);
}

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
    constexpr int kRounds = 10;
    for (int round = 0; round < kRounds; ++round) {
        const std::uint64_t first = std::uint64_t{0xD2511F53U} * counter[0];
        const std::uint64_t second = std::uint64_t{0xCD9E8D57U} * counter[2];
        counter = {high_of(second) ^ counter[1] ^ key[0], low_of(second),
                   high_of(first) ^ counter[3] ^ key[1], low_of(first)};
        key[0] += 0x9E3779B9U;
        key[1] += 0xBB67AE85U;
    }
    return counter;
}

Random::Random(std::uint64_t seed, std::int64_t sample, std::string_view quantity, std::size_t component)
    : key_{low_of(seed), high_of(seed)},
      counter_{low_of(static_cast<std::uint64_t>(sample)), high_of(static_cast<std::uint64_t>(sample)),
               hash_of(quantity), static_cast<std::uint32_t>(component) << 16U} {}

double Random::uniform() {
    constexpr unsigned kUnusedBits = 64 - 53;
    const auto bits = philox(counter_, key_);
    ++counter_[3];
    return std::ldexp(static_cast<double>((std::uint64_t{bits[1]} << 32U | bits[0]) >> kUnusedBits), -53);
}

double Random::normal() {
    while (true) {
        const double u = 2.0 * uniform() - 1.0;
        const double v = 2.0 * uniform() - 1.0;
        const double square = u * u + v * v;
        if (square > 0.0 && square < 1.0) return u * std::sqrt(-2.0 * log_of(square) / square);
    }
}

double log_of(double value) {
    int exponent = 0;
    double mantissa = std::frexp(value, &exponent);
    if (mantissa < 0.5 * std::numbers::sqrt2) {  // so that values near 1 keep their digits
        mantissa *= 2.0;
        --exponent;
    }
    // log m = 2 artanh t, |t| < 0.172
    const double t = (mantissa - 1.0) / (mantissa + 1.0);
    constexpr int kTerms = 12;
    double sum = 0.0;
    for (int k = kTerms; k >= 0; --k) sum = sum * t * t + 1.0 / (2 * k + 1);
    return exponent * std::numbers::ln2 + 2.0 * t * sum;
}

double power_of(double base, double exponent) {
    double power = 1.0;
    for (double root = base; exponent > 0.0;) {
        root = std::sqrt(root);
        exponent *= 2.0;
        if (exponent < 1.0) continue;
        exponent -= 1.0;
        power *= root;
    }
    return power;
}

double angle_of(double x, double y) {
    if (x == 0.0 && y == 0.0) return 0.0;
    // tan(a / 2) = sin a / (1 + cos a): twice, until |t| <= tan(pi / 8)
    const bool is_left = x < 0.0;
    const double radius = std::sqrt(x * x + y * y);
    double t = y / (radius + std::abs(x));
    t /= 1.0 + std::sqrt(1.0 + t * t);
    constexpr int kTerms = 24;
    double sum = 0.0;
    for (int k = kTerms; k >= 0; --k) sum = 1.0 / (2 * k + 1) - sum * t * t;
    const double angle = 4.0 * t * sum;
    if (!is_left) return angle;
    return y < 0.0 ? -std::numbers::pi - angle : std::numbers::pi - angle;
}

}  // namespace corda::sweep
