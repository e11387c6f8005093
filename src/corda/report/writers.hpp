#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "corda/report/report.hpp"

namespace corda::report {

// The forms of a report. Each is a function of the report alone: the same report gives the same bytes. Texts
// may be any bytes: control characters and bytes that are not UTF-8 become their numbers (see core/text.hpp).

/// A table as CSV: a row of column keys, then the rows. Quoted as in section 2 of RFC 4180, but with LF, and
/// in UTF-8 (see core/text.hpp); a number has 17 significant digits, so that reading it gives the same bits.
[[nodiscard]] std::string csv_text(const Table& table);

/// Gives the SVG of a plot or a picture by its id.
using SvgOf = std::function<std::string(const std::string& id)>;

/// The whole report as one HTML page without scripts: it needs no other file, and only links to those of
/// figures with a caption. It is also well-formed XML.
[[nodiscard]] std::string html_text(const Report& report, const SvgOf& svg_of);

enum class PlotFormat { kPng, kSvg, kPdf };

/// "png", "svg" or "pdf".
[[nodiscard]] const char* ending(PlotFormat format);

/// The name of a figure's file without ending: `<id>_<width>mm`, or `<id>` if the report has a single width.
[[nodiscard]] std::string file_stem(const std::string& id, int width_mm, const std::vector<int>& widths_mm);

/// The file of a plot of that width in print, with letters of 8 points. A point that an axis cannot show (not
/// finite, or not positive on a logarithmic axis) is left out and breaks its line.
[[nodiscard]] std::string draw_plot(const Plot& plot, PlotFormat format, int width_mm);

/// Whether the row has a reason in the failure column.
[[nodiscard]] bool is_failed(const Table& table, std::size_t row);

/// A number for people: three significant digits, e.g. "1.23e-5" or "1230"; whole numbers below a million in
/// full.
[[nodiscard]] std::string short_number(double value);

}  // namespace corda::report
