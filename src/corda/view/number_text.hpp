#pragma once

#include <string>

#include "corda/view/colors.hpp"

namespace corda::view {

/// 10 to that power, rounded once.
[[nodiscard]] double power_of_10(int exponent);

/// The logarithm to base 10 of a positive number, to within 1e-15 or 2e-16 of it. Computed from +, -, * and
/// /, whose results do not depend on the CPU.
[[nodiscard]] double log10_of(double value);

/// "10⁻¹²"
[[nodiscard]] std::string power_of_10_text(int exponent);

/// A positive number rounded up to two digits; any other number unchanged.
[[nodiscard]] double rounded_up(double value);

/// "3.1·10⁻¹²": two digits, rounded up.
[[nodiscard]] std::string power_text(double value);

/// 1, 2 or 5 times a power of 10.
struct RoundNumber {
    int digit = 1;
    int exponent = 0;

    /// `count` times the number, rounded once if possible: 0.3 is 3 tenths.
    [[nodiscard]] double times(double count) const {
        const double power = power_of_10(exponent < 0 ? -exponent : exponent);
        return exponent < 0 ? count * digit / power : count * digit * power;
    }
    [[nodiscard]] double value() const { return times(1.0); }
};

/// The largest round number not above a value, and the smallest not below it. The value must be normal and
/// positive.
[[nodiscard]] RoundNumber round_number_below(double value);
[[nodiscard]] RoundNumber round_number_above(double value);

/// "20 cm": `digit` times 10 to the power of `exponent` metres.
[[nodiscard]] std::string length_text(int digit, int exponent);

/// "−0.25": at most `digits` digits, and a minus sign as wide as a plus.
[[nodiscard]] std::string display_number(double value, int digits = 6);

/// "20 mN": a number with its unit, which takes a prefix.
[[nodiscard]] std::string quantity_text(double value, const std::string& unit);

/// Title of numbers, such as "tension (kN)", and the divisor of their values for this unit.
struct NumberTitle {
    std::string text;
    double unit = 1.0;
};

/// The title for values up to `largest`. `unit` takes a prefix, unless it is one of angles, or
/// is empty for bare numbers.
[[nodiscard]] NumberTitle title_of(const std::string& name, const std::string& unit, double largest);
[[nodiscard]] NumberTitle title_of(const ColorScale& scale);

}  // namespace corda::view
