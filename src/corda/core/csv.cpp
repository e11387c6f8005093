#include "corda/core/csv.hpp"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "corda/core/text.hpp"

namespace corda {

void CsvLine::begin_cell() {
    if (is_ended_)
        line_.clear();
    else
        line_ += style_ == CsvStyle::kComma ? ';' : ',';
    is_ended_ = false;
}

void CsvLine::add(double value) {
    begin_cell();
    if (std::isnan(value)) return;
    const std::size_t first = line_.size();
    fmt::format_to(std::back_inserter(line_), "{:.17g}", value);
    if (style_ == CsvStyle::kPoint) return;
    if (const std::size_t point = line_.find('.', first); point != std::string::npos) line_[point] = ',';
}

void CsvLine::add(std::string_view text) {
    begin_cell();
    const std::string readable = utf8(text);
    if (readable.find_first_of(style_ == CsvStyle::kComma ? ";\"\r\n" : ",\"\r\n") == std::string::npos) {
        line_ += readable;
        return;
    }
    line_ += '"';
    for (const char c : readable) {
        if (c == '"') line_ += '"';
        line_ += c;
    }
    line_ += '"';
}

std::string_view CsvLine::end() {
    if (is_ended_) line_.clear();
    line_ += '\n';
    is_ended_ = true;
    return line_;
}

}  // namespace corda
