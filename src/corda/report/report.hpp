#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "corda/view/defs.hpp"

namespace corda::report {

/// Pixels per inch of figures in print.
inline constexpr double kPrintPpi = 300.0;
/// Widths of figures in print: a column and a page of a journal, in mm.
inline constexpr int kColumnMm = 85;
inline constexpr int kPageMm = 170;

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
    std::string note;                        ///< one or two sentences below it; may be empty
    Language language = Language::kEnglish;  ///< of the decimal sign on the page

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
    static constexpr std::size_t kLooks = 8;  ///< colours

    std::string name;
    std::vector<std::pair<double, double>> points;
    /// The least and the largest y of each point, drawn as a bar; empty: there are none.
    std::vector<std::pair<double, double>> spreads = {};
    /// Its colour and marker, so that a subject looks the same in all plots; default: its place among the
    /// lines that are not context.
    std::optional<std::size_t> look = {};
    bool is_context = false;  ///< grey and thin, behind the others, with one entry for all such in the key
    std::string color = {};   ///< "#rrggbb" in place of that of its look
    /// kBoth of a plot without markers: a line.
    enum class Form { kBoth, kPoints, kLine };
    Form form = Form::kBoth;

    void add(double x, double y, const std::pair<double, double>& spread) {
        points.emplace_back(x, y);
        spreads.push_back(spread);
    }
};

/// A line plot.
struct Plot {
    std::string
        id;  ///< file name without ending: [a-z0-9_]+, unique among the plots and pictures of a Report
    std::string title;  ///< stands over it, unless it has a caption; readers who cannot see it hear it
    std::string x_title;
    std::string y_title;
    bool log_x = true;
    bool log_y = true;
    std::vector<Series> series;
    std::string context_name = {};           ///< of all lines that are context
    std::string caption = {};                ///< stands below it on the page, with a number; may be empty
    std::string data = {};                   ///< name of the file with its numbers, for the page; empty: none
    bool has_markers = true;                 ///< false: lines without a marker at each point
    bool has_equal_scales = false;           ///< a unit is as long along x as along y: for paths
    double height_per_width = 0.6;           ///< of the box, unless it has equal scales
    Language language = Language::kEnglish;  ///< of the decimal sign of its labels
};

/// A drawing that is made elsewhere.
struct Picture {
    std::string id;       ///< as that of a Plot
    std::string title;    ///< what it shows, for readers who cannot see it
    std::string caption;  ///< stands below it on the page, with a number
    /// Writes it, `width_mm` wide, to a path whose ending is .svg, .png or .pdf. Throws what it likes.
    std::function<void(const std::string& path, double width_mm)> write;
    bool is_small = false;     ///< stands beside its small neighbours on the page
    bool is_on_white = false;  ///< like plots: a dark page shows it inverted
};

/// One subject: what the figures show, and the figures.
struct Chapter {
    std::string title;
    std::vector<std::string> paragraphs = {};  ///< plain text
    std::vector<Table> tables = {};
    std::vector<Plot> plots = {};
    std::string summary = {};  ///< what it found, in a sentence: the report opens with those; may be empty
    std::vector<Picture> pictures = {};  ///< before the plots
};

/// Chapters of tables and figures, and what they were measured on.
struct Report {
    std::string title;
    /// Machine, build and options as pairs of a name and a value. Without dates, so that the same figures
    /// give the same files.
    std::vector<std::pair<std::string, std::string>> setting;
    std::vector<Chapter> chapters;
    std::string setting_title = "Setting";
    /// Widths of its figures in print, in mm, increasing, at least one: each has the files
    /// `<id>_<width>mm.svg`, .png (at kPrintPpi) and .pdf per width, and the page shows the widest, of small
    /// pictures the narrowest. A single width is not in the names.
    std::vector<int> widths_mm = {kPageMm};
};

}  // namespace corda::report
