#include <fmt/format.h>

#include "corda/core/text.hpp"
#include "corda/report/writers.hpp"

namespace corda::report {
namespace {

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"') result += '"';
        result += c;
    }
    return result + '"';
}

std::string csv_cell(const Cell& cell) {
    if (const auto* number = std::get_if<double>(&cell)) return fmt::format("{:.17g}", *number);
    if (const auto* text = std::get_if<std::string>(&cell)) return quoted(utf8(*text));
    return {};
}

}  // namespace

std::string csv_text(const Table& table) {
    std::string text;
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        if (i > 0) text += ',';
        text += quoted(table.columns[i].key);
    }
    text += '\n';
    for (const auto& row : table.rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (i > 0) text += ',';
            text += csv_cell(row[i]);
        }
        text += '\n';
    }
    return text;
}

}  // namespace corda::report
