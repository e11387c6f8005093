#include "corda/report/report.hpp"

#include <cmath>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>

#include "corda/core/csv.hpp"
#include "corda/report/writers.hpp"

namespace corda::report {
namespace {

// From here to there a number is written in full: exponents would be harder to read than zeros.
constexpr double kMinRounded = 1e3;
constexpr double kMaxInFull = 1e6;

}  // namespace

bool is_failed(const Table& table, std::size_t row) {
    for (std::size_t column = 0; column < table.columns.size(); ++column) {
        if (table.columns[column].key != kFailureKey) continue;
        const auto* reason = std::get_if<std::string>(&table.rows[row][column]);
        return reason != nullptr && !reason->empty();
    }
    return false;
}

std::string file_stem(const std::string& id, int width_mm, const std::vector<int>& widths_mm) {
    return widths_mm.size() > 1 ? fmt::format("{}_{}mm", id, width_mm) : id;
}

std::string csv_text(const Table& table) {
    CsvLine line;
    for (const Column& column : table.columns) line.add(column.key);
    std::string text(line.end());
    for (const auto& row : table.rows) {
        for (const Cell& cell : row) {
            if (const auto* number = std::get_if<double>(&cell))
                line.add(*number);
            else if (const auto* words = std::get_if<std::string>(&cell))
                line.add(*words);
            else
                line.add(std::string_view());
        }
        text += line.end();
    }
    return text;
}

std::string short_number(double value) {
    if (std::isnan(value)) return "NaN";
    if (std::isinf(value)) return value > 0.0 ? "∞" : "−∞";
    const std::string three_digits = fmt::format("{:.2e}", value);
    const bool is_whole = value == std::round(value);
    const double shown = is_whole ? value : std::strtod(three_digits.c_str(), nullptr);
    if (std::abs(shown) < kMaxInFull && (is_whole || std::abs(shown) >= kMinRounded)) {
        return fmt::format("{:.0f}", shown + 0.0);  // + 0.0: -0 becomes 0
    }
    std::string text = fmt::format("{:.3g}", value);
    // People write 1.23e-5, not 1.23e-05.
    const std::size_t digits = text.find('e') + 2;
    if (digits >= 2 && digits + 1 < text.size() && text[digits] == '0') text.erase(digits, 1);
    return text;
}

}  // namespace corda::report
