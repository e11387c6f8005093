#pragma once

#include <map>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/figures/motion_summary.hpp"
#include "corda/pipeline/film.hpp"

namespace corda::figures {

/// The times of a report's drawings.
struct FigureTimes {
    std::vector<double> strobe_s;
    std::vector<double> stills_s;
    bool is_swing = false;  ///< the strobe shows the first swing
};

/// The times that were asked for, increasing, as far as the motion goes. Without any, the strobe has six from
/// the start to where the first followed particle first turns back in x, having moved a quarter of the way
/// that it does in all, or else to the end; and the stills are five from the start to the end. All of these
/// are frame times.
[[nodiscard]] FigureTimes find_figure_times(const Film& film, const MotionSummary& motion,
                                            const std::vector<double>& asked_s);

/// The look of a scene in print: its shape, a width in millimetres at report::kPrintPpi, letters of
/// 8 points and no live plot. What the scene says in pixels keeps its share of the width.
[[nodiscard]] Scene look_in_print(const Scene& scene, double width_mm);

/// Draws poses of one film at any width in print.
class Drawings {
  public:
    /// The film must outlive it.
    explicit Drawings(Film& film) : film_(&film) {}

    /// Writes the poses at some times in one picture; the ending of `path` is .svg, .png or .pdf. Throws as
    /// corda::write_figure().
    void write(const std::string& path, double width_mm, const std::vector<double>& times_s,
               const OutputOptions& options);
    /// Opens OpenGL, which PNGs are drawn with. Throws corda::Error (kNoGl).
    [[nodiscard]] GlInfo gl(double width_mm) { return look(width_mm).gl(); }

  private:
    [[nodiscard]] Film& look(double width_mm);

    Film* film_;
    std::map<double, Film> looks_;  ///< by width
};

}  // namespace corda::figures
