#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/core/rational.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/colors.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"
#include "corda/view/labels.hpp"
#include "corda/view/legends.hpp"
#include "corda/view/overlay_texts.hpp"
#include "corda/view/plot_panel.hpp"

namespace corda::view {

/// Texts of an overlay for one picture.
struct Caption {
    std::optional<double> time_s;  ///< std::nullopt: no time is shown
    std::optional<double> energy_error;
    std::string method;
    std::vector<LabelPlace> labels = {};
    std::optional<Energy> energy = {};  ///< shown if its error is not defined
};

/// The data of a whole motion that an overlay shows.
struct OverlayData {
    std::optional<ColorScale> scale = {};  ///< of the legend of colours
    ArrowScale arrows = {};
    double energy_scale_j = 0.0;  ///< of the energies of captions, which decides on their unit
    std::vector<BodyLabel> labels = {};
    std::span<const PlotData> plots = {};
    std::span<const Color> body_colors = {};
    Rational speed{1, 1};  ///< seconds of the scene per second of the video
};

/// Texts and scale bar at the edges of a picture, and the live plots. Time and energy are at the lower
/// left, the scale bar at the lower right, title and method at the upper left, the legend at the upper right,
/// above them if there is little room next to it. A long title or method is shortened; other items without
/// room are left out.
struct Overlay {
    OverlayDef def;
    TextArea area;
    bool has_time = true;
    bool has_scale_bar = true;
    int time_decimals = 2;
    double energy_scale_j = 0.0;
    std::string speed = {};  ///< next to the time; empty: that of the motion
    Heading heading = {};
    std::optional<ColorLegend> color_legend = {};
    std::optional<ArrowLegend> arrow_legend = {};
    std::vector<BodyLabel> labels = {};
    std::vector<PlotPanel> plots = {};  ///< the first ones of OverlayDef::plots; the others have no room
    Insets insets = {};                 ///< space that the camera must leave free
};

/// `interval_s`: frame interval, which sets the number of decimals of the time.
[[nodiscard]] Overlay make_overlay(const OverlayDef& def, const StyleDef& style, int width_px, int height_px,
                                   double interval_s, const OverlayData& data = {});

/// Adds the curves of the plots up to a time, and the arrow of the legend.
void draw_curves(const Overlay& overlay, double time_s, DrawList& list);

/// Adds the stamps of a picture with this camera scale.
void draw(const Overlay& overlay, const Caption& caption, double pixels_per_metre, DrawList& list);

/// "0.25" for each time, all with the same number of digits: enough to be exact, or at least to be distinct
/// if that takes many digits.
[[nodiscard]] std::vector<std::string> digits_of(std::span<const double> times_s);

/// "t = 1.20 s"
[[nodiscard]] std::string time_label(const std::string& digits, Language language);

}  // namespace corda::view
