#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "corda/core/text.hpp"
#include "corda/report/report.hpp"

namespace corda::report {

// The forms of a report. Each is a function of the report alone: the same report gives the same bytes
// (pictures: with the same version of gnuplot). Texts may be any bytes: where nothing else is said, control
// characters and bytes that are not UTF-8 become their numbers (see core/text.hpp).

/// A table as CSV: a row of column keys, then the rows. Quoted as in section 2 of RFC 4180, but with LF, and
/// in UTF-8 (see core/text.hpp); a number has 17 significant digits, so that reading it gives the same bits.
[[nodiscard]] std::string csv_text(const Table& table);

/// The whole report as JSON, "schema": 1. A row is an object by column key; an empty cell is null, and so
/// is a number that JSON does not have (infinite, NaN). Only bytes that are not UTF-8 become numbers.
[[nodiscard]] std::string json_text(const Report& report);

/// The whole report as GitHub-flavoured Markdown with aligned tables and short numbers; a failed row says so
/// in its failure column. Figures are linked as files in the same folder.
[[nodiscard]] std::string markdown_text(const Report& report);

/// Gives the SVG of a plot or a picture by its id.
using SvgOf = std::function<std::string(const std::string& id)>;

/// The whole report as one HTML page without scripts, style sheets or pictures of its own: it needs no other
/// file, and only links to those of figures with a caption. It is also well-formed XML.
[[nodiscard]] std::string html_text(const Report& report, const SvgOf& svg_of);

/// The format of a plot's picture.
enum class PlotFormat { kPng, kSvg, kPdf };

/// "png", "svg" or "pdf".
[[nodiscard]] const char* ending(PlotFormat format);

/// The name of a figure's file without ending: `<id>`, or `<id>_<width>mm`.
[[nodiscard]] std::string file_stem(const std::string& id, std::optional<int> width_mm);

/// The script with which gnuplot draws `plot` to its standard output: so wide in print, with letters of 8
/// points and at kPrintPpi, or 1200 pixels or 170 mm wide. A point that an axis cannot show (not finite, or
/// not positive on a logarithmic axis) is left out and breaks its line.
[[nodiscard]] std::string gnuplot_script(const Plot& plot, PlotFormat format,
                                         std::optional<int> width_mm = {});

/// The bytes of a plot's picture, drawn by gnuplot. Throws corda::Error (kIo): see check_gnuplot, and with
/// gnuplot's own text if it fails.
[[nodiscard]] std::string draw_plot(const Plot& plot, PlotFormat format, std::optional<int> width_mm = {});

/// Throws corda::Error (kIo), naming the package, if gnuplot does not run. Call it before a report's figures
/// are computed, so that they are not computed in vain.
void check_gnuplot();

/// Throws corda::Error (kInternal) if an id or a column key is not [a-z0-9_]+ or occurs twice, or if a row
/// does not have one cell per column.
void check_report(const Report& report);

/// Whether the row has a reason in the failure column.
[[nodiscard]] bool is_failed(const Table& table, std::size_t row);

/// Whether a column has numbers and no texts.
[[nodiscard]] bool is_numeric(const Table& table, std::size_t column);

/// Whether people are shown a column: the failure column only if a row failed.
[[nodiscard]] bool is_for_people(const Table& table, std::size_t column);

/// Puts `to` in the place of every `from`, which is not empty.
void replace_all(std::string& text, std::string_view from, std::string_view to);

/// A number for people: three significant digits, e.g. "1.23e-5" or "1230"; whole numbers below a million in
/// full.
[[nodiscard]] std::string short_number(double value);

/// Puts a fixed time in the place of that at which cairo made a PDF, so that it has the same bytes at any
/// time. What cairo 1.18 compresses, the date among it, becomes plain: compressed, its length would depend on
/// the date.
void forget_time(std::string& pdf);

/// Makes every text in a value of nlohmann's JSON UTF-8 (see core/text.hpp), which is all that JSON can hold:
/// names of files can have any bytes.
template <typename Json>
void make_utf8(Json& json) {
    if (json.is_string()) json = utf8(json.template get_ref<const std::string&>());
    if (!json.is_structured()) return;
    for (Json& value : json) make_utf8(value);
}

/// Exit status and output of a finished program.
struct ChildResult {
    int exit_code = -1;  ///< 128 + the number of the signal if one ended it
    std::string out;
    std::string err;
};

/// Runs a program found in PATH with `input` on its standard input, and waits for it. No shell is involved.
/// Its time zone is UTC. It does not outlive this process or the calling thread. Throws corda::Error if it
/// cannot be started: kTemporary for want of processes or memory, else kIo, which ends with `hint`.
[[nodiscard]] ChildResult run_child(const std::vector<std::string>& command, const std::string& input,
                                    const std::string& hint);

}  // namespace corda::report
