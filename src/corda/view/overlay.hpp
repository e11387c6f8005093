#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "corda/sim/simulation.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/colors.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"
#include "corda/view/font.hpp"
#include "corda/view/labels.hpp"
#include "corda/view/plot_panel.hpp"

namespace corda::view {

/// Texts of an overlay for one picture.
struct Caption {
    std::optional<double> time_s;  ///< std::nullopt: no time is shown
    std::optional<double> energy_error;
    std::string method;
    /// Where the particles of each label are: that next to it, and that from which its line comes.
    std::vector<std::pair<PixelPoint, PixelPoint>> labels = {};
    std::optional<Energy> energy = {};  ///< shown if its error is not defined; potentials since the start
};

/// Adds the points of a state to a caption.
void locate(std::span<const BodyLabel> labels, const State& state, const Camera& camera, Caption& caption);

/// A pose among several in one picture.
struct PoseTime {
    BodyLabel label;
    PixelPoint at;
    PixelPoint from;
    double opacity = 1.0;
};

/// Texts and scale bar at the edges of a picture, and the live plots. Time and energy are at the lower
/// left, the scale bar at the lower right, title and method at the upper left, the legend at the upper right,
/// above them if there is little room next to it. A long title or method is shortened; other items without
/// room are left out.
class Overlay {
  public:
    /// `interval_s`: frame interval, which sets the number of decimals of the time.
    Overlay(const OverlayDef& def, const StyleDef& style, int width, int height, double interval_s);

    /// Space that the camera must leave free.
    [[nodiscard]] Insets insets() const;
    /// Sets the scale of the legend; without a scale there is no legend.
    void set_scale(const ColorScale& scale) {
        scale_ = scale;
        lay_out_top();
    }
    /// Sets the scale of the energies of captions, which decides on their unit.
    void set_energy_scale(double scale_j) { energy_scale_j_ = scale_j; }
    /// Sets the scale of arrows and the size of the longest one; cut: some are larger.
    void set_arrows(double pixels_per_unit, double longest, bool is_cut);
    /// Sets the labels of bodies, and adds their extents for particles that stay within `motion`.
    void set_labels(std::vector<BodyLabel> labels, std::span<const MotionBounds> motion,
                    std::vector<Drawn>& drawn);
    [[nodiscard]] std::span<const BodyLabel> labels() const { return labels_; }
    /// Sets the data of the plots, of which those without room are left out; without data there are none.
    void set_plots(std::span<const PlotData> data, std::span<const Color> body_colors);
    /// The first ones of OverlayDef::plots; the others have no room.
    [[nodiscard]] std::span<const PlotPanel> plots() const { return plots_; }
    /// Adds the curves of the plot up to a time, and the arrow of the legend.
    void draw_curves(double time_s, DrawList& list) const;
    /// Adds the times of poses, unless the time is switched off: those of later poses first, each where it
    /// hides no other and is nearest to its own pose; one without such a place is left out.
    void draw_times(std::span<const PoseTime> poses, DrawList& list) const;
    /// Adds the stamps of a picture with this camera scale.
    void draw(const Caption& caption, double pixels_per_metre, DrawList& list) const;

  private:
    /// A line of a title or a text.
    struct TopLine {
        std::string text;
        int room_px = 0;
    };
    /// The legend of colours: its texts, its left end and the ends of its bar.
    struct Legend {
        std::string name, first, middle, last;
        int x_px = 0;
        int bar_x_px = 0;
        int bar_end_px = 0;
    };

    [[nodiscard]] bool has_bottom() const;
    [[nodiscard]] int title_px() const;
    /// Places title and method next to the legend, or below it.
    void lay_out_top();
    /// Breaks a text at spaces into a few lines, of which the last one may be too long.
    [[nodiscard]] std::vector<TopLine> wrapped(std::string text, int size_px,
                                               const std::function<int(int line)>& room_px) const;
    /// Breaks the title into lines; false if it has to be shortened.
    [[nodiscard]] bool wrap_title();
    /// Width of a line at the upper left whose upper edge is at `top_px`.
    [[nodiscard]] int room_px(int top_px) const;
    void draw_text(const OverlayTextDef& text, DrawList& list) const;
    /// The baselines from the upper edge; of the title's last line.
    [[nodiscard]] int title_baseline_px() const;
    [[nodiscard]] int title_line_px() const;
    /// Baseline of the legend's numbers.
    [[nodiscard]] int legend_baseline_px() const;
    /// Left aligned without padding: the same text at the same place in a film of any duration.
    [[nodiscard]] std::string time_text(double time_s) const;
    /// Writes a text at the left end of the lower baseline if it ends before `end_px`; returns where the next
    /// may begin, with room for the text `widest`.
    int write_bottom(const std::string& text, int x_px, int end_px, DrawList& list,
                     const std::string& widest = {}) const;
    /// The same for the scale bar, to the left of `right_px`; returns where it begins.
    int draw_scale_bar(double pixels_per_metre, int begin_px, int right_px, DrawList& list) const;
    /// Left end of the legend of arrows, at the lower right; the right edge of texts without one.
    [[nodiscard]] int arrow_x_px() const;
    [[nodiscard]] Legend lay_out_legend() const;
    void draw_legend(DrawList& list) const;
    /// The box of a label in the direction of its line, turned by an eighth turn `turns` times.
    [[nodiscard]] PixelRect label_box(const BodyLabel& label, PixelPoint at, PixelPoint from, int turns,
                                      double clear_px, const Font& font) const;
    void draw_label(const BodyLabel& label, PixelPoint at, PixelPoint from, DrawList& list) const;
    void draw_gradient(const PixelRect& bar, DrawList& list) const;
    /// Size of a title of one line: smaller, down to the size of the other texts, if it would not fit.
    int fitting_title_px() const;
    /// Writes a line at the left of an upper baseline, shortened at a separator.
    void write_top(const TopLine& line, std::string_view separator, int baseline_px, int size_px, Color color,
                   const Font& font, DrawList& list) const;

    OverlayDef def_;
    bool time_;
    bool scale_bar_;
    bool legend_;
    std::optional<ColorScale> scale_;
    double energy_scale_j_ = 0.0;
    std::vector<BodyLabel> labels_;
    Color color_;
    Arrows arrows_;
    Color arrow_color_;
    std::string arrow_text_;  ///< "2 m/s"; empty: no legend
    int arrow_text_px_ = 0;
    double arrow_px_ = 0.0;
    bool is_arrow_cut_ = false;
    Insets panel_;  ///< space taken by the plots
    int width_;     ///< width left by the plots
    int height_;
    int side_px_;  ///< the shorter one of the frame
    int em_px_;
    int edge_px_;          ///< from the edges of the frame to the texts
    int legend_x_px_ = 0;  ///< where the room next to the legend ends
    int title_top_px_ = 0;
    int method_baseline_px_ = 0;
    std::vector<TopLine> title_lines_;
    int decimals_ = 2;
    Font font_;   ///< of numbers and the program's words
    Font words_;  ///< of title, texts and labels
    std::vector<PlotPanel> plots_;
};

/// "0.25" for each time, all with the same number of digits: enough to be exact, or at least to be distinct
/// if that takes many digits.
[[nodiscard]] std::vector<std::string> digits_of(std::span<const double> times_s);

/// "t = 1.20 s"
[[nodiscard]] std::string time_label(const std::string& digits, Language language);

}  // namespace corda::view
