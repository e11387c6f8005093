#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace corda::study {

/// A cell of a table: a number, a text, or nothing where a figure does not exist.
using Cell = std::variant<std::monostate, double, std::string>;

/// A number, or nothing.
[[nodiscard]] inline Cell cell_of(const std::optional<double>& value) {
    return value ? Cell(*value) : Cell();
}

/// A column of a table.
struct Column {
    std::string key;    ///< of CSV and JSON: snake_case with its unit, "error_rms_over_length"
    std::string title;  ///< for people, with its unit: "RMS error / L"
};

/// Rows of figures. Every row has one cell a column.
struct Table {
    std::string id;  ///< file name without ending: [a-z0-9_]+, unique in a Report
    std::string title;
    std::vector<Column> columns;
    std::vector<std::vector<Cell>> rows;
    std::string note;  ///< one or two sentences below it; may be empty
};

/// Points of one kind in a plot, in the order in which they are joined.
struct Series {
    std::string name;
    std::vector<std::pair<double, double>> points;
};

/// A line plot.
struct Plot {
    std::string id;  ///< as of a Table, unique among plots
    std::string title;
    std::string x_title;
    std::string y_title;
    bool log_x = true;
    bool log_y = true;
    std::vector<Series> series;
};

/// One subject: what was asked, the figures, what they show.
struct Chapter {
    std::string title;
    std::vector<std::string> paragraphs;  ///< plain text
    std::vector<Table> tables;
    std::vector<Plot> plots;
};

/// A whole study.
struct Report {
    std::string title;
    /// What it was measured on and how: pairs of a name and a value (processor, compiler, options,
    /// date-free).
    std::vector<std::pair<std::string, std::string>> setting;
    std::vector<Chapter> chapters;
};

}  // namespace corda::study
