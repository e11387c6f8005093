#pragma once

#include <string>
#include <utility>
#include <vector>

#include "corda/sweep/sweep.hpp"

namespace corda::figures {

/// The titles of the axes y and x of the plot "Y:X", with units. Throws corda::Error (kUsage) unless a sweep
/// has these columns.
std::pair<std::string, std::string> sweep_plot_titles(const sweep::SweepDef& sweep,
                                                      const std::string& columns);

/// Writes the plot "Y:X" of the finished samples of a sweep as `<folder>/<y>-<x>` .svg, .pdf, .png and .csv.
/// X and Y are columns of metadata.csv that hold numbers: a figure of the summary, or a varied key, of which
/// the part after the last dot is enough. A few choices of other keys are drawn apart. The period of a point
/// pendulum (by the elliptic integral) or of small oscillations of a hanging rope (R4) is drawn with the
/// measured one. Returns the paths. Throws corda::Error: kUsage for a column that does not exist, or if no
/// sample has both; kIo.
std::vector<std::string> write_sweep_plot(const sweep::SweepDef& sweep, const std::string& folder,
                                          const std::string& columns);

/// Writes the contact sheet `<folder>/sheet.png` of at most 36 samples, evenly spaced over the sweep: poses
/// of each with its number and its parameters. Returns the path. Needs no OpenGL.
std::string write_sweep_sheet(const sweep::SweepDef& sweep, const std::string& folder);

}  // namespace corda::figures
