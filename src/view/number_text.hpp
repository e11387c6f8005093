#pragma once

#include <string>

#include "corda/view/color_scale.hpp"

namespace corda::view {

/// 10 to that power, rounded once.
[[nodiscard]] double power_of_10(int exponent);

/// A positive number, rounded up to two digits; another one as it is.
[[nodiscard]] double rounded_up(double value);

/// "3.1·10⁻¹²": two digits, rounded up.
[[nodiscard]] std::string power_text(double value);

/// 1, 2 or 5 times a power of 10.
struct RoundNumber {
    int digit = 1;
    int exponent = 0;

    /// So many of it, rounded once as far as that goes: 0.3 is 3 tenths.
    [[nodiscard]] double times(double count) const {
        const double power = power_of_10(exponent < 0 ? -exponent : exponent);
        return exponent < 0 ? count * digit / power : count * digit * power;
    }
    [[nodiscard]] double value() const { return times(1.0); }
};

/// The largest one that is not above a value, the least that is not below it. The value is normal and
/// positive.
[[nodiscard]] RoundNumber round_number_below(double value);
[[nodiscard]] RoundNumber round_number_above(double value);

/// "20 cm": `digit` times 10 to the power of `exponent` metres.
[[nodiscard]] std::string length_text(int digit, int exponent);

/// "−0.25": at most so many digits, and a minus sign that is as wide as a plus.
[[nodiscard]] std::string number_text(double value, int digits = 6);

/// What stands beside numbers: "tension (kN)", and what values are divided by for that unit.
struct NumberTitle {
    std::string text;
    double unit = 1.0;
};

/// For values of this size. `unit` is one that takes a prefix, or empty for bare numbers.
[[nodiscard]] NumberTitle title_of(const std::string& name, const std::string& unit, double largest);
[[nodiscard]] NumberTitle title_of(const ColorScale& scale);

}  // namespace corda::view
