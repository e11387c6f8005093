#pragma once

#include <string>
#include <vector>

#include "corda/figures/motion_summary.hpp"
#include "corda/report/report.hpp"
#include "corda/scene/scene.hpp"
#include "corda/view/plot_axis.hpp"

namespace corda::figures {

/// A curve before its units are known.
struct Curve {
    std::string name;
    CurvePoints points;
    std::string color = {};  ///< see report::Series
};

/// The range of the finite values of a coordinate.
[[nodiscard]] view::ValueRange range_of(const std::vector<Curve>& curves, double view::CurvePoint::*value);

/// The quantity of an axis, and the unit of its values, which takes a prefix; "": bare numbers, "rad": as it
/// is.
struct AxisDef {
    std::string text;
    std::string unit;
};

/// A plot of curves without markers whose axes have units with the prefixes that suit their values. The time
/// is in seconds.
[[nodiscard]] report::Plot make_plot(const std::string& id, const std::string& title, const AxisDef& x,
                                     const AxisDef& y, const std::vector<Curve>& curves);

/// A curve per body, of the colour that it has in pictures; the only one needs no name.
[[nodiscard]] std::vector<Curve> curves_of(const Scene& scene, const System& system,
                                           const MotionSummary& motion, CurvePoints BodyCurves::*curve);

/// "4 more bodies are not shown." as a sentence; empty if all are.
[[nodiscard]] std::string left_out_text(const System& system, const MotionSummary& motion);

/// "1.23 kN", "0.345 m/s": three digits, and a prefix if the number is large or small. `unit` takes one;
/// without a unit: "0.012", "3.1·10⁻¹²".
[[nodiscard]] std::string quantity_text(double value, const std::string& unit);

/// "1.25 s"
[[nodiscard]] std::string time_text(double time_s);

/// Whether lines of a colour can be seen on white: a contrast of 2 or more, as WCAG 2.1 defines it.
[[nodiscard]] bool shows_on_white(Color color);

/// Gives a scene that names no theme the paper theme, unless its own ground is dark, or one of its own
/// colours of ropes and nets does not show on white.
void prefer_paper(Scene& scene);

/// The colour of each body in pictures as "#rrggbb", for its curves; all empty, for the colours of plots, if
/// two are the same or one does not show on white. `bodies`: of the system, ascending.
[[nodiscard]] std::vector<std::string> curve_colors(const Scene& scene,
                                                    const std::vector<std::size_t>& bodies);

}  // namespace corda::figures
