#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "corda/study/report.hpp"

namespace corda::study {

// What a report becomes. Each form is a function of the report alone, so that the same report gives the same
// bytes (pictures: for one version of gnuplot).

/// A table as CSV: a row of column keys, then the rows. Quoted as RFC 4180 section 2 says, but with LF; a
/// number has 17 significant digits and so comes back to the bit, a missing cell is empty.
[[nodiscard]] std::string csv_text(const Table& table);

/// The whole report as JSON, "schema": 1. A row is an object by column key; a missing cell, and a number that
/// JSON has not (infinite, NaN), is null.
[[nodiscard]] std::string json_text(const Report& report);

/// The whole report as GitHub-flavoured Markdown with aligned tables and short_number; a failed row says so
/// in its column of failures. Plots are linked as `<id>.svg`.
[[nodiscard]] std::string markdown_text(const Report& report);

/// Gives the SVG of a plot.
using SvgOf = std::function<std::string(const Plot&)>;

/// The whole report as one HTML page that needs nothing beside it: no script, no style sheet, no picture
/// file. It is well-formed XML too.
[[nodiscard]] std::string html_text(const Report& report, const SvgOf& svg_of);

/// The form of a picture; 1200 x 800 pixels.
enum class PlotFormat { kPng, kSvg };

/// What gnuplot is told to draw `plot` on its standard output. A point that cannot stand on a logarithmic
/// axis (not finite, not positive) is left out and breaks its line.
[[nodiscard]] std::string gnuplot_script(const Plot& plot, PlotFormat format);

/// The bytes of a plot's picture, drawn by gnuplot. Throws corda::Error (kIo) as check_gnuplot does, and with
/// gnuplot's own text where it fails.
[[nodiscard]] std::string draw_plot(const Plot& plot, PlotFormat format);

/// Throws corda::Error (kIo), naming the package, where gnuplot does not run: before hours of measuring.
void check_gnuplot();

/// Writes report.html, report.json, report.md, a `<id>.csv` a table, and `<id>.png` and `<id>.svg` a plot
/// into a folder, which is made where it is missing; returns the paths, report.html first. Nothing is written
/// before all of it is there, and each file gets its name only when it is whole. Files of other names stay.
/// Throws corda::Error: kIo, or kInternal for a report that breaks the rules of report.hpp (check_report).
std::vector<std::string> write_report(const Report& report, const std::string& folder);

/// Throws corda::Error (kInternal) where an id or a column key is no [a-z0-9_]+, where one stands twice, or
/// where a row has not one cell a column.
void check_report(const Report& report);

/// Whether the row says that its run failed: a text in the column kFailureKey (study.hpp).
[[nodiscard]] bool is_failed(const Table& table, std::size_t row);

/// Whether all cells of a column that are there are numbers, and one is.
[[nodiscard]] bool is_numeric(const Table& table, std::size_t column);

/// Whether readers are shown a column: one of failures only where there are some.
[[nodiscard]] bool is_for_people(const Table& table, std::size_t column);

/// A number for people: three significant digits, "1.23e-5" or "1230"; a whole number below a million in
/// full.
[[nodiscard]] std::string short_number(double value);

}  // namespace corda::study
