#pragma once

#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/media/defs.hpp"
#include "corda/pipeline/film.hpp"

#pragma GCC visibility push(default)
namespace corda {

/// The poses of a film at some times: in one picture, or side by side.
struct FigureDef {
    /// In seconds, increasing, at least one; 0 .. world.duration_s.
    std::vector<double> times_s;
    /// 0: one picture of the film's size, in which the poses are the fainter the earlier they are, and the
    /// last is as in a still. Otherwise a contact sheet of that many columns, whose cells have the film's
    /// size.
    int columns = 0;
    // Of a contact sheet, at least what its cells take.
    int width_px = 0;
    int height_px = 0;
};

/// A contact sheet of the scene's picture size: gives `scene` the size of a cell, for a film of which
/// draw_figure() and write_figure() draw the sheet. `columns`: 0 chooses them. Throws corda::Error (kUsage)
/// if there is no room for so many cells.
[[nodiscard]] FigureDef contact_sheet(Scene& scene, std::vector<double> times_s, int columns = 0);

/// Throws corda::Error as Film::still(), and kUsage for a definition that is not what it is declared to be,
/// or poses of too many lines.
[[nodiscard]] Image draw_figure(const Film& film, const FigureDef& def, const OnProgress& on_progress = {});

/// Whether the ending of `path` is that of a figure: .png, .svg or .pdf.
[[nodiscard]] bool is_figure_path(const std::string& path);

/// Writes a figure; the ending of `path` chooses the format. As .svg and .pdf it has lines in place of
/// pixels, needs no OpenGL, and its size is that of its pixels in print; of the texts of `info` it has the
/// title. Returns the times of the pictures in which nothing is in view: one at most, but for a contact
/// sheet. Throws corda::Error: as draw_figure(), kIo, and kUsage for another ending.
std::vector<double> write_figure(const std::string& path, const Film& film, const FigureDef& def,
                                 const PngInfo& info = {}, const OutputOptions& options = {});

}  // namespace corda
#pragma GCC visibility pop
