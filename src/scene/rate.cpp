#include "corda/scene/rate.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "corda/scene/problems.hpp"

namespace corda::scene {
namespace {

/// The fraction that someone who wrote a number such as 29.97 or 12.5 means.
std::optional<Rational> nearest_fraction(double fps) {
    constexpr double kBroadcast = 2e-4;  // 23.98 for 24000/1001 is the coarsest habit
    constexpr std::array<std::int64_t, 5> kBroadcastRates{24, 30, 48, 60, 120};
    for (const std::int64_t rate : kBroadcastRates) {
        const Rational fraction{rate * 1000, 1001};
        if (std::abs(fps / fraction.value() - 1.0) < kBroadcast) return fraction;
    }
    constexpr std::int64_t kLargestDenominator = 1000;
    for (std::int64_t den = 2; den <= kLargestDenominator; ++den) {
        const double num = std::round(fps * static_cast<double>(den));
        if (std::abs(fps * static_cast<double>(den) - num) < 1e-9 * num) {
            return Rational::reduced(static_cast<std::int64_t>(num), den);
        }
    }
    return std::nullopt;
}

std::variant<Rational, std::string> rate_from_number(double fps) {
    if (!std::isfinite(fps)) return fmt::format("{} is not a finite number", fps);
    if (std::abs(fps) > static_cast<double>(Rational::kLargestPart))
        return fmt::format("{} is out of range", fps);
    if (fps == std::floor(fps)) return Rational{static_cast<std::int64_t>(fps), 1};
    const auto fraction = nearest_fraction(fps);
    return fraction ? fmt::format("{} is not exact; write \"{}\"", fps, fraction->text())
                    : fmt::format("{} is not exact", fps);
}

}  // namespace

std::variant<Rational, std::string> read_rate(const toml::node& node) {
    if (node.is_number()) return rate_from_number(number_of(node));
    const std::string& text = node.as_string()->get();
    if (const auto rate = Rational::parse(text)) return *rate;
    return fmt::format("\"{}\" is not a fraction", excerpt(text));
}

}  // namespace corda::scene
