#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"
#include "corda/view/font.hpp"
#include "corda/view/plot_axis.hpp"

namespace corda::view {

/// A point of a curve at one time.
struct CurvePoint {
    double time_s = 0.0;
    double x = 0.0;
    double y = 0.0;
};

/// Data of a live plot.
struct PlotData {
    struct Curve {
        std::string name;  ///< empty: none is shown
        std::vector<CurvePoint> points =
            {};  ///< in order of time, at least one; all curves have the same times
    };
    /// Title of an axis, the unit of its values, which takes a prefix, and the minimum extent.
    struct AxisName {
        std::string text;
        std::string unit;
        double least_extent = 0.0;
    };

    AxisName x;
    AxisName y;
    /// End of the x axis if x is the time; 0 otherwise.
    double end_s = 0.0;
    std::vector<Curve> curves;  ///< 1 .. 3, the first in front
    /// The body of the curves; std::nullopt: all bodies.
    std::optional<std::size_t> body = {};
};

/// Size of the upper left part of a frame that a live plot leaves to the picture.
struct Room {
    int width_px = 0;
    int height_px = 0;
};
[[nodiscard]] Room room_beside(LivePlot plot, int width_px, int height_px);

/// A plot of the whole motion whose curves grow with time: to the right of the picture if the frame is wider
/// than high, otherwise below. Small frames have none.
class PlotPanel {
  public:
    PlotPanel(const StyleDef& style, int width_px, int height_px);

    /// Sets the data and fits the axes to them. Nothing is drawn before the first call. If the data belong to
    /// a body, the first curve has its colour; the other curves have colours that no body has.
    void set_data(const PlotData& data, std::span<const Color> body_colors, Font& font);
    /// Adds the curves up to a time, between points by straight lines.
    void draw_curves(double time_s, DrawList& list) const;
    /// Adds the parts that do not change.
    void draw_axes(DrawList& list, Font& font) const;

  private:
    struct PixelCurve {
        std::string name;
        Color color;
        std::vector<PixelPoint> points;  ///< without indistinguishable ones
        std::vector<double> times_s;     ///< times of the points
        std::vector<CurvePoint> samples;

        /// The point at a time, interpolated.
        [[nodiscard]] CurvePoint at(double time_s) const;
    };
    struct Name {
        std::string text;
        Color color;
        int x_px = 0;
        int row = 0;
    };

    [[nodiscard]] std::vector<Color> choose_colors(const PlotData& data,
                                                   std::span<const Color> body_colors) const;
    void place_names(const PixelRect& panel, Font& font);
    /// Places the box and finds the labels; false if there is no room.
    [[nodiscard]] bool place_box(const PixelRect& panel, bool is_over_time, Font& font);

    int width_px_;
    int height_px_;
    bool is_beside_;   ///< to the right of the picture
    int edge_px_ = 0;  ///< from the edges of the frame to texts
    Color text_color_;
    std::vector<Color> palette_;
    bool is_shown_ = false;
    PlotBox plot_;
    std::vector<PixelCurve> curves_;
    std::vector<Name> names_;
    int name_rows_ = 0;
};

}  // namespace corda::view
