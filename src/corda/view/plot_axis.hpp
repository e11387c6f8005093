#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"
#include "corda/view/font.hpp"

namespace corda::view {

/// The smallest and the largest of some values; without any, `low` is above `high`.
struct ValueRange {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    /// NaN does not count.
    void include(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    [[nodiscard]] double extent() const { return std::max(0.0, high - low); }
    /// The largest absolute value.
    [[nodiscard]] double largest() const {
        return low > high ? 0.0 : std::max(std::abs(low), std::abs(high));
    }
    /// Widened about its middle to an extent.
    [[nodiscard]] ValueRange widened(double to) const {
        const double more = std::max(0.0, 0.5 * (to - extent()));
        return {low - more, high + more};
    }
};

/// One axis of a plot: the map from values to pixels, and its labels.
struct PlotAxis {
    struct Label {
        std::string text;
        int at_px = 0;  ///< along the axis
    };

    double low = 0.0;  ///< ends; those of a logarithmic axis are powers of 10: -3 is 0.001
    double high = 1.0;
    int low_px = 0;
    int high_px = 0;
    bool is_log = false;
    bool is_given = false;  ///< the ends are: they stay, except those of a logarithmic axis
    std::string title = {};
    double unit = 1.0;  ///< divisor of the labels' numbers
    std::vector<Label> labels = {};
    Language language = Language::kEnglish;  ///< of the decimal sign

    [[nodiscard]] double px(double value) const;
    /// Moves the ends outwards to values that have labels, at most `most_steps` steps apart, if they may be
    /// moved.
    void extend_to_labels(int most_steps);
    /// Sets the labels: round values, at most `most` steps of them, with given ends if they divide that.
    void set_labels(int most);
    /// Sets the labels of a horizontal axis, at most `most` steps, so that they are `gap_px` apart.
    void set_labels_apart(int most, int gap_px, int em_px, const Font& font);
};

/// The box of a plot between two axes.
struct PlotBox {
    PixelRect box;
    PlotAxis x;
    PlotAxis y;
    int em_px = 0;
    int line_px = 1;

    /// Distance of the baseline of the x axis's title from the box.
    [[nodiscard]] int title_px() const;
    /// Adds a line at each label to the last layer.
    void add_grid(DrawList& list) const;
    /// Adds the axes with their ticks and labels, and the title of the x axis.
    void draw_axes(Color line, Color text, DrawList& list, const Font& font) const;
};

// Shares of the em.
inline constexpr double kTickLength = 0.25;

/// True if an axis of that extent has steps.
[[nodiscard]] bool can_be_divided(double extent);

/// The points of a curve that its picture needs, by index and in order. If x never falls: the first, highest,
/// lowest and last point in each column of pixels; otherwise those that are half a pixel apart.
[[nodiscard]] std::vector<std::size_t> visible_points(const std::vector<PixelPoint>& points);

}  // namespace corda::view
