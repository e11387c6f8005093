#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace corda::report {

/// A cell of a table: empty, a number or a text.
using Cell = std::variant<std::monostate, double, std::string>;

/// A cell with a number, or an empty one if there is none or it is NaN.
[[nodiscard]] inline Cell cell_of(const std::optional<double>& value) {
    return value && !std::isnan(*value) ? Cell(*value) : Cell();
}

/// A column of a table.
struct Column {
    std::string key;    ///< in CSV and JSON: snake_case with its unit, e.g. "error_rms_over_length"
    std::string title;  ///< for people, with its unit, e.g. "RMS error / L"
};

/// Key of the column that says why a row failed. Every writer shows a row with a text in it as failed.
inline constexpr std::string_view kFailureKey = "failure";

/// That column.
[[nodiscard]] inline Column failure_column() {
    return {std::string(kFailureKey), "failed because"};
}

/// Rows of figures. Every row has one cell per column.
struct Table {
    std::string id;  ///< file name without ending: [a-z0-9_]+, unique among the tables of a Report
    std::string title;
    std::vector<Column> columns;
    std::vector<std::vector<Cell>> rows;
    std::string note;  ///< one or two sentences below it; may be empty

    /// Adds a row. Cells left out at its end are empty.
    void add(std::vector<Cell> cells) {
        cells.resize(columns.size());
        rows.push_back(std::move(cells));
    }
    /// Adds a row that failed: the cells that are known and, in the last column, the reason.
    void add_failed(std::vector<Cell> cells, const std::string& reason) {
        add(std::move(cells));
        rows.back().back() = reason;
    }
};

/// One line of a plot: points in the order in which they are joined.
struct Series {
    /// Lines that differ by colour and marker; more repeat them with dashes.
    static constexpr std::size_t kLooks = 8;

    std::string name;
    std::vector<std::pair<double, double>> points;
    /// The least and the largest y of each point, drawn as a bar; empty: there are none.
    std::vector<std::pair<double, double>> spreads = {};
    /// Its colour and marker, 0 .. kLooks - 1, so that a subject looks the same in all plots; default: its
    /// place among the lines that are not context.
    std::optional<std::size_t> look = {};
    bool is_context = false;  ///< grey and thin, behind the others, with one entry for all such in the key

    void add(double x, double y, const std::pair<double, double>& spread) {
        points.emplace_back(x, y);
        spreads.push_back(spread);
    }
};

/// A line plot.
struct Plot {
    std::string id;  ///< file name without ending: [a-z0-9_]+, unique among the plots of a Report
    std::string title;
    std::string x_title;
    std::string y_title;
    bool log_x = true;
    bool log_y = true;
    std::vector<Series> series;
    std::string context_name = {};  ///< of all lines that are context
};

/// One subject: what the figures show, and the figures.
struct Chapter {
    std::string title;
    std::vector<std::string> paragraphs;  ///< plain text
    std::vector<Table> tables;
    std::vector<Plot> plots;
    std::string summary = {};  ///< what it found, in a sentence: the report opens with those; may be empty
};

/// Chapters of tables and plots, and what they were measured on.
struct Report {
    std::string title;
    /// Machine, build and options as pairs of a name and a value. Without dates, so that the same figures
    /// give the same files.
    std::vector<std::pair<std::string, std::string>> setting;
    std::vector<Chapter> chapters;
};

}  // namespace corda::report
