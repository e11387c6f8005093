#include "corda/view/number_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

#include <fmt/format.h>

namespace corda::view {
namespace {

/// The exponent of the largest power of 1000 that is not above.
int thousands_below(double value) {
    int exponent = 0;
    while (exponent > -300 && power_of_10(exponent) > value * (1.0 + 1e-9)) exponent -= 3;
    while (exponent < 300 && power_of_10(exponent + 3) <= value) exponent += 3;
    return exponent;
}

/// "k" for 3; empty if there is none.
std::string prefix_of(int exponent) {
    constexpr const char* kPrefixes[] = {"n", "µ", "m", "", "k", "M", "G", "T"};
    return exponent < -9 || exponent > 12 ? "" : kPrefixes[exponent / 3 + 3];
}

}  // namespace

double power_of_10(int exponent) {
    double power = 1.0;
    for (int i = 0; i < std::abs(exponent); ++i) power *= 10.0;
    return exponent < 0 ? 1.0 / power : power;
}

double log10_of(double value) {
    constexpr double kLog10Of2 = 0.301029995663981195;
    int exponent = 0;
    double fraction = std::frexp(value, &exponent);
    if (fraction < 0.5 * std::numbers::sqrt2) {
        fraction *= 2.0;
        --exponent;
    }
    const double ratio = (fraction - 1.0) / (fraction + 1.0);
    double sum = 0.0;  // the series of the inverse hyperbolic tangent
    for (int n = 23; n >= 1; n -= 2) sum = 1.0 / n + ratio * ratio * sum;
    return exponent * kLog10Of2 + 2.0 * ratio * sum * std::numbers::log10e;
}

std::string power_of_10_text(int exponent) {
    std::string text = exponent < 0 ? "10⁻" : "10";
    constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    for (const char digit : std::to_string(std::abs(exponent))) text += kDigits[digit - '0'];
    return text;
}

RoundNumber round_number_below(double value) {
    RoundNumber number{1, static_cast<int>(std::floor(std::log10(value)))};
    // log10 may be off by one next to a power of 10.
    if (power_of_10(number.exponent + 1) <= value) ++number.exponent;
    if (power_of_10(number.exponent) > value) --number.exponent;
    for (const int larger : {2, 5})
        if (larger * power_of_10(number.exponent) <= value) number.digit = larger;
    return number;
}

RoundNumber round_number_above(double value) {
    RoundNumber number = round_number_below(value);
    if (number.value() >= value) return number;
    if (number.digit == 5) return {1, number.exponent + 1};
    number.digit = number.digit == 1 ? 2 : 5;
    return number;
}

double rounded_up(double value) {
    if (!(value > 0.0) || !std::isfinite(value)) return value;
    // std::stod would take a comma in some countries.
    const auto number = [](const std::string& text) {
        double parsed = 0.0;
        std::from_chars(text.data(), text.data() + text.size(), parsed);
        return parsed;
    };
    const std::string nearest = fmt::format("{:.1e}", value);
    const double half = 0.05 * power_of_10(std::stoi(nearest.substr(nearest.find('e') + 1)));
    return number(number(nearest) < value ? fmt::format("{:.1e}", value + half) : nearest);
}

std::string power_text(double value) {
    if (!(value > 0.0) || !std::isfinite(value)) return fmt::format("{}", value);
    const std::string digits = fmt::format("{:.1e}", rounded_up(value));
    const std::size_t e = digits.find('e');
    return digits.substr(0, e) + "·" + power_of_10_text(std::stoi(digits.substr(e + 1)));
}

std::string length_text(int digit, int exponent) {
    const auto [unit, power] = exponent >= 3    ? std::pair{"km", 3}
                               : exponent >= 0  ? std::pair{"m", 0}
                               : exponent >= -2 ? std::pair{"cm", -2}
                               : exponent >= -3 ? std::pair{"mm", -3}
                               : exponent >= -6 ? std::pair{"µm", -6}
                                                : std::pair{"nm", -9};
    const int rest = exponent - power;
    return fmt::format("{} {}", rest < 0 ? digit / power_of_10(-rest) : digit * power_of_10(rest), unit);
}

std::string display_number(double value, int digits) {
    return fmt::format("{}{:.{}g}", value < 0.0 ? "−" : "", std::abs(value), digits);
}

NumberTitle title_of(const std::string& name, const std::string& unit, double largest) {
    constexpr double kMinDecimals = 0.01;
    constexpr double kMaxDigits = 1e4;
    const double least = unit.empty() ? kMinDecimals : 10.0 * kMinDecimals;
    const bool is_angle = unit.starts_with("°") || unit.starts_with("rad");
    const bool is_plain = largest == 0.0 || (largest >= least * (1.0 - 1e-9) && largest < kMaxDigits);
    const int exponent = is_plain ? 0 : thousands_below(largest);
    const std::string power = exponent == 0 ? "" : power_of_10_text(exponent);
    if (unit.empty()) return {name + (power.empty() ? "" : " (" + power + ")"), power_of_10(exponent)};
    const std::string prefix = is_angle ? "" : prefix_of(exponent);
    const std::string factor = prefix.empty() && !power.empty() ? power + " " : "";
    return {fmt::format("{} ({}{}{})", name, factor, prefix, unit), power_of_10(exponent)};
}

std::string quantity_text(double value, const std::string& unit) {
    const NumberTitle title = title_of("", unit, value);
    const std::string words = title.text.substr(2, title.text.size() - 3);  // without " (" and ")"
    return fmt::format("{} {}", display_number(value / title.unit), words);
}

NumberTitle title_of(const ColorScale& scale) {
    const sim::QuantityKind& kind = sim::kind_of(scale.quantity);
    return title_of(kind.name, kind.unit, std::max(std::abs(scale.low), std::abs(scale.high)));
}

}  // namespace corda::view
