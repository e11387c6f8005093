#pragma once

#include <string>

namespace corda::figures {

/// "1.23 kN", "0.345 m/s": three digits, and a prefix if the number is large or small. `unit` takes one;
/// without a unit: "0.012", "3.1·10⁻¹²".
[[nodiscard]] std::string quantity_text(double value, const std::string& unit);

/// "1.25 s"
[[nodiscard]] std::string time_text(double time_s);

}  // namespace corda::figures
