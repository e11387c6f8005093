#include "corda/figures/quantity_text.hpp"

#include <cmath>

#include <fmt/format.h>

#include "corda/report/writers.hpp"
#include "corda/view/number_text.hpp"

namespace corda::figures {

std::string quantity_text(double value, const std::string& unit) {
    constexpr double kMinPlain = 1e-3;
    if (unit.empty()) {
        const bool is_plain = value == 0.0 || std::abs(value) >= kMinPlain || !std::isfinite(value);
        return is_plain ? report::short_number(value) : view::power_text(value);
    }
    // " (kN)"
    const view::NumberTitle title = view::title_of("", unit, std::abs(value));
    return report::short_number(value / title.unit) + " " + title.text.substr(2, title.text.size() - 3);
}

std::string time_text(double time_s) {
    return fmt::format("{:.4g} s", time_s);
}

}  // namespace corda::figures
