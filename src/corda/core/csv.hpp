#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "corda/core/output_file.hpp"

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

/// A CSV file of numbers that is written row by row. Throws the errors of OutputFile.
class CsvFile {
  public:
    CsvFile(const std::string& path, const OutputOptions& options, const std::vector<std::string>& columns);

    void add_row(std::span<const double> values);
    void commit() { file_.commit(); }

  private:
    OutputFile file_;
    CsvLine line_;
};

}  // namespace corda
