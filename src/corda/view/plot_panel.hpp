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

struct CurvePoint {
    double time_s = 0.0;
    double x = 0.0;
    double y = 0.0;
};

/// Data of a live plot.
struct PlotData {
    /// Colours of quantities, in all films: that of texts, or one of the theme's, of which 0 is a rope's.
    enum class Hue { kText, kKinetic, kY, kPotential, kX };
    struct Curve {
        std::string name = {};  ///< empty: none is shown
        Hue hue = Hue::kText;
        std::optional<std::size_t> body = {};  ///< whose colour it has instead
        /// In order of time, at least one; all have the same times. NaN is a gap.
        std::vector<CurvePoint> points = {};
    };
    /// Title of an axis, the unit of its values (see title_of()), and the minimum extent.
    struct AxisName {
        std::string text;
        std::string unit;
        double least_extent = 0.0;
        std::string symbol = {};             ///< in place of a text that is too long
        bool is_log = false;                 ///< all values are above 0
        std::optional<Interval> range = {};  ///< the ends of the axis, if they are given
    };

    AxisName x;
    AxisName y;
    /// End of the x axis if x is the time; 0 otherwise.
    double end_s = 0.0;
    std::vector<Curve> curves;               ///< at least one, the first in front
    Language language = Language::kEnglish;  ///< that all texts are in
};

/// The parts of a frame: the upper left one for the picture, and the panels of the live plots, in a column to
/// the right of it if the frame is wider than high, otherwise in a row below; in two columns or rows if their
/// texts would be too small in one. A frame without room for all plots has panels for the first ones.
/// `text_px`: the size of their texts as far as there is room for it; without it, one that grows with the
/// frame.
struct PlotLayout {
    int width_px = 0;   ///< of the picture
    int height_px = 0;  ///< of the picture
    int em_px = 0;      ///< of the plots' texts
    std::vector<PixelRect> panels = {};
};
[[nodiscard]] PlotLayout lay_out_plots(std::size_t count, int width_px, int height_px,
                                       std::optional<double> text_px = {});

/// The place of a plot in a frame, and its colours and fonts.
struct PlotPlace {
    const StyleDef& style;
    PixelRect frame;
    PixelRect panel;  ///< see PlotLayout
    int em_px = 0;    ///< see PlotLayout
    std::span<const Color> body_colors;
    const Font& font;
    const Font& words;       ///< of the names of curves
    int least_label_px = 0;  ///< minimum width of the labels of the y axis
    bool is_one_of_several = false;
};

/// A plot of the whole motion whose curves grow with time.
class PlotPanel {
  public:
    /// Fits the axes to the data. The parts of `place` need not outlive it.
    PlotPanel(const PlotData& data, const PlotPlace& place);

    /// Width of the labels of the y axis: panels above each other have the same.
    [[nodiscard]] int label_px() const { return label_px_; }
    [[nodiscard]] const PixelRect& panel() const { return panel_; }
    /// False if the panel has no room for the plot.
    [[nodiscard]] bool has_room() const { return has_room_; }
    /// The names of curves for which the plot has no room.
    [[nodiscard]] std::vector<std::string> nameless() const;
    /// Adds the curves up to a time, between points by straight lines.
    void draw_curves(double time_s, DrawList& list) const;
    /// Adds the parts that do not change.
    void draw_axes(DrawList& list, const Font& font, const Font& words) const;

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

    /// Fills in the titles and the ranges of the axes.
    void start_axes(const PlotData& data, const Font& font);
    /// Places the names in rows, smaller ones if that shows them all; those of one plot of several in one row
    /// if the smallest fit in it.
    void place_names(const Font& font, bool is_one_of_several);
    /// Places names of size `name_em_px_`; false if there is no room for all in so many rows.
    [[nodiscard]] bool add_names(const Font& font, int most_rows);
    /// Height that titles and names leave to the box.
    [[nodiscard]] int room_px() const;
    /// Height of the title and the names above the box.
    [[nodiscard]] int above_px() const;
    /// Places the box and finds the labels; false if there is no room.
    [[nodiscard]] bool place_box(bool is_over_time, int least_label_px, const Font& font);
    /// Fills in the points of a curve in the placed box.
    void place_points(PixelCurve& curve) const;
    /// Adds the part of a line, or dot, that is in the box, if ends of axes are given.
    void add_clipped(PixelPoint a, PixelPoint b, double radius_px, DrawList& list) const;

    int width_px_;
    int height_px_;
    PixelRect panel_;
    int label_px_ = 0;
    int edge_px_ = 0;  ///< from the edges of the frame to texts
    Color text_color_;
    bool has_room_ = true;
    bool is_shown_ = false;
    PlotBox plot_;
    std::vector<PixelCurve> curves_;
    std::vector<Name> names_;
    int name_rows_ = 0;
    int name_em_px_ = 0;
};

}  // namespace corda::view
