#include "corda/core/csv.hpp"
#include "corda/report/writers.hpp"

namespace corda::report {

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

}  // namespace corda::report
