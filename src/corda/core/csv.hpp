#pragma once

#include <string>
#include <string_view>

namespace corda {

/// The decimal sign of numbers. With a comma, cells are separated by semicolons.
enum class CsvStyle { kPoint, kComma };

/// A line of CSV (RFC 4180), cell by cell.
class CsvLine {
  public:
    explicit CsvLine(CsvStyle style = CsvStyle::kPoint) : style_(style) {}
    /// A number with 17 significant digits; NaN is an empty cell.
    void add(double value);
    /// A text, in quotes if it needs them; bytes that are not UTF-8 are escaped (see core/text.hpp).
    void add(std::string_view text);
    /// The finished line with its end. The next cell begins a new one.
    [[nodiscard]] std::string_view end();

  private:
    void begin_cell();

    CsvStyle style_;
    std::string line_;
    bool is_ended_ = true;
};

}  // namespace corda
