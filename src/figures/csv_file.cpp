#include "corda/figures/csv_file.hpp"

#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace corda::figures {

CsvFile::CsvFile(const std::string& path, const OutputOptions& options, const std::vector<std::string>& keys)
    : file_(path, options) {
    file_.write(fmt::format("{}\n", fmt::join(keys, ",")));
}

void CsvFile::add_row(std::span<const double> values) {
    line_.clear();
    for (const double value : values) {
        if (!std::isnan(value)) fmt::format_to(std::back_inserter(line_), "{:.17g}", value);
        line_ += ',';
    }
    line_.back() = '\n';
    file_.write(line_);
}

}  // namespace corda::figures
