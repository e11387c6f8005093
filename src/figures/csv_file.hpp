#pragma once

#include <span>
#include <string>
#include <vector>

#include "corda/core/output_file.hpp"

namespace corda::figures {

/// A CSV of numbers that is written row by row: it has a row per state, and a long motion has more of them
/// than memory is meant for. Throws what OutputFile throws.
class CsvFile {
  public:
    /// `keys`: of the columns, [a-z0-9_]+.
    CsvFile(const std::string& path, const OutputOptions& options, const std::vector<std::string>& keys);

    /// Numbers with 17 significant digits; NaN is an empty cell.
    void add_row(std::span<const double> values);
    void commit() { file_.commit(); }

  private:
    OutputFile file_;
    std::string line_;
};

}  // namespace corda::figures
