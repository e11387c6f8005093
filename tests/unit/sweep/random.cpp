#include "corda/sweep/random.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <set>
#include <vector>

namespace corda::sweep {
namespace {

using Words = std::array<std::uint32_t, 4>;

/// Known answers of Random123, the library of its authors.
TEST(Philox, GivesItsAuthorsAnswers) {
    constexpr std::uint32_t kOnes = 0xffffffffU;
    EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5U, 0xe169c58dU, 0xbc57ac4cU, 0x9b00dbd8U}));
    EXPECT_EQ(philox({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
              (Words{0x408f276dU, 0x41c83b0eU, 0xa20bc7c6U, 0x6d5451fdU}));
    EXPECT_EQ(philox({0x243f6a88U, 0x85a308d3U, 0x13198a2eU, 0x03707344U}, {0xa4093822U, 0x299f31d0U}),
              (Words{0xd16cfe09U, 0x94fdccebU, 0x5001e420U, 0x24126ea1U}));
}

TEST(Random, IsAFunctionOfItsArguments) {
    std::set<double> first;
    for (const std::uint64_t seed : {0ULL, 1ULL, 1ULL << 32U, ~0ULL})
        for (const std::int64_t sample : {0LL, 1LL, 1LL << 32U})
            for (const char* const quantity : {"", "rope[0].mass", "rope[1].mass"})
                for (const std::size_t component : {0UL, 1UL, 65535UL}) {
                    const double number = Random(seed, sample, quantity, component).uniform();
                    EXPECT_EQ(number, Random(seed, sample, quantity, component).uniform());
                    EXPECT_TRUE(first.insert(number).second)
                        << seed << " " << sample << quantity << component;
                }
    EXPECT_EQ(first.size(), 4 * 3 * 3 * 3);
}

/// The quantity "" has the hash 2166136261; its counter is (sample, 0, hash, component << 16 + draw).
TEST(Random, TakesItsNumbersFromTheCounter) {
    Random random((std::uint64_t{7} << 32U) + 5, 3, "", 2);
    for (std::uint32_t draw = 0; draw < 3; ++draw) {
        const Words words = philox({3, 0, 2166136261U, (2U << 16U) + draw}, {5, 7});
        const std::uint64_t bits = (std::uint64_t{words[1]} << 32U | words[0]) >> 11U;
        EXPECT_EQ(random.uniform(), std::ldexp(static_cast<double>(bits), -53));
    }
}

constexpr int kDraws = 100'000;

TEST(Random, UniformNumbersFillTheirInterval) {
    Random random(1, 2, "rope[0].mass");
    std::array<int, 10> counts{};
    for (int i = 0; i < kDraws / 2; ++i) {  // a component has 2^16 draws
        const double u = random.uniform();
        ASSERT_TRUE(u >= 0.0 && u < 1.0);
        ASSERT_EQ(std::ldexp(u, 53), std::floor(std::ldexp(u, 53)));
        ++counts[static_cast<std::size_t>(10.0 * u)];
    }
    for (const int count : counts) EXPECT_NEAR(count, kDraws / 20, 300);
}

TEST(Random, NormalNumbersHaveTheirMoments) {
    std::array<double, 5> moments{};
    double beyond = 0.0;
    for (int i = 0; i < kDraws; ++i) {
        const double value = Random(1, i, "rope[0].mass").normal();
        for (std::size_t k = 1; k < moments.size(); ++k) moments[k] += std::pow(value, k) / kDraws;
        beyond += std::abs(value) > 1.959963985 ? 1.0 / kDraws : 0.0;
    }
    EXPECT_NEAR(moments[1], 0.0, 0.01);
    EXPECT_NEAR(moments[2], 1.0, 0.015);
    EXPECT_NEAR(moments[3], 0.0, 0.03);
    EXPECT_NEAR(moments[4], 3.0, 0.1);
    EXPECT_NEAR(beyond, 0.05, 0.002);
}

/// Error of `value` in units of the last place of the result that is expected.
double ulps(long double expected, double value) {
    int exponent = 0;
    std::frexp(static_cast<double>(expected), &exponent);
    return static_cast<double>(std::abs(value - expected) / std::ldexp(1.0L, exponent - 53));
}

/// The largest error over random pairs of numbers, each 0 <= u < 1.
double largest_ulps(const std::function<double(double, double)>& error) {
    double largest = 0.0;
    for (int i = 0; i < 2 * kDraws; ++i)
        largest = std::max(largest, error(Random(1, i, "u").uniform(), Random(1, i, "v").uniform()));
    return largest;
}

/// 2^-1000 .. 2^1000.
double wide(double u, double v) {
    return std::ldexp(1.0 + u, static_cast<int>(2000.0 * v) - 1000);
}

TEST(Functions, LogarithmIsThatOfTheLibrary) {
    const auto error = [](double value) {
        return ulps(std::log(static_cast<long double>(value)), log_of(value));
    };
    EXPECT_LT(largest_ulps([&](double u, double) { return error(1.0 - u); }), 3.0);
    EXPECT_LT(largest_ulps([&](double u, double v) { return error(wide(u, v)); }), 3.0);
    EXPECT_LT(largest_ulps([&](double u, double) { return error(1.0 + std::ldexp(u, -30)); }), 3.0);
    EXPECT_EQ(log_of(1.0), 0.0);
}

TEST(Functions, PowerIsThatOfTheLibrary) {
    const auto error = [](double base, double exponent) {
        return ulps(std::pow(static_cast<long double>(base), static_cast<long double>(exponent)),
                    power_of(base, exponent));
    };
    EXPECT_LT(largest_ulps([&](double u, double v) { return error(1.0 + 1000.0 * u, v); }), 40.0);
    EXPECT_LT(largest_ulps([&](double u, double v) { return error(wide(v, u), v); }), 40.0);
    EXPECT_EQ(power_of(1000.0, 0.0), 1.0);
    EXPECT_EQ(power_of(9.0, 0.5), 3.0);
    EXPECT_EQ(power_of(1.0, 1.0 - 0x1p-53), 1.0);
}

TEST(Functions, AngleIsThatOfTheLibrary) {
    const auto error = [](double x, double y) {
        return ulps(std::atan2(static_cast<long double>(y), static_cast<long double>(x)), angle_of(x, y));
    };
    EXPECT_LT(largest_ulps([&](double u, double v) { return error(2.0 * u - 1.0, 2.0 * v - 1.0); }), 6.0);
    EXPECT_EQ(angle_of(0.0, 0.0), 0.0);
    EXPECT_EQ(angle_of(2.0, 0.0), 0.0);
    EXPECT_EQ(angle_of(-2.0, 0.0), std::numbers::pi);
    for (const double sign : {1.0, -1.0}) {
        EXPECT_NEAR(angle_of(0.0, sign), sign * std::numbers::pi / 2, 1e-15);
        EXPECT_NEAR(angle_of(1.0, sign), sign * std::numbers::pi / 4, 1e-15);
        EXPECT_NEAR(angle_of(-1.0, sign), sign * 3 * std::numbers::pi / 4, 1e-15);
    }
}

}  // namespace
}  // namespace corda::sweep
