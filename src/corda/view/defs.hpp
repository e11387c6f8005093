#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

#pragma GCC visibility push(default)
namespace corda {

/// Default colours of a scene: for screens with a dark ground, or for white paper.
enum class Theme { kDark, kPaper };

/// Background: one colour, or an even gradient from the top of the picture to the bottom.
struct Ground {
    Color top;
    Color bottom;

    /// True if nothing behind the picture shows through.
    [[nodiscard]] bool is_opaque() const { return top.a == 255 && bottom.a == 255; }

    friend bool operator==(const Ground&, const Ground&) = default;
};

/// From `low` up to `high`, which is larger.
struct Interval {
    double low = 0.0;
    double high = 0.0;

    friend bool operator==(const Interval&, const Interval&) = default;
};

/// Which particles get a marker.
enum class Markers { kNone, kPinned, kAll };

/// Bars drawn as separate lines: real ones over the ropes and nets, imaginary ones behind them.
enum class Bars { kNone, kReal, kAll };

/// Meaning of the colours of ropes and nets: the body; a quantity of each link, on a scale for the whole
/// motion; or the colours that a body gives to its links (BodyStyleDef::link_colors).
enum class ColorBy { kBody, kTension, kSpeed, kStrain, kLink };

/// The quantity shown; std::nullopt if none.
[[nodiscard]] constexpr std::optional<Quantity> quantity_of(ColorBy by) {
    switch (by) {
        case ColorBy::kTension:
            return Quantity::kTension;
        case ColorBy::kSpeed:
            return Quantity::kSpeed;
        case ColorBy::kStrain:
            return Quantity::kStrain;
        case ColorBy::kBody:
        case ColorBy::kLink:
            break;
    }
    return std::nullopt;
}

/// The arrows at particles: their velocities, the pulls of their links, or their weights. One scale for the
/// whole motion.
enum class Arrows { kNone, kVelocity, kTension, kWeight };

/// Style of a scene. Widths are in output pixels; their defaults grow with the shorter side. Fields that are
/// not given come from the theme.
struct StyleDef {
    std::optional<Theme> theme;  ///< default: kDark
    std::optional<Ground> background;
    /// Colours of the ropes and nets in turn, and between which the gradients of merged ones are mixed,
    /// except those with a colour of their own (BodyStyleDef). Empty: the theme's.
    std::vector<Color> palette;
    ColorBy color_by = ColorBy::kBody;
    /// The scale of colours, in N, m/s or as a strain, -1e12 .. 1e12; default: from the whole motion.
    std::optional<Interval> color_range;
    Arrows arrows = Arrows::kNone;
    /// Pixels per m/s or N, 1e-12 .. 1e12; default: from the largest arrows.
    std::optional<double> arrow_scale_px;
    std::optional<double> rope_width_px;  ///< 0.1 .. 1000; default: side / 120, at least 2
    std::optional<double> net_width_px;   ///< 0.1 .. 1000; default: half of a rope's, at least 2
    bool payload = true;  ///< draw payloads, and the masses of ropes of up to 3 links, as balls
    std::optional<double> payload_radius_m;  ///< 1e-9 .. 1e9, of all balls; default: by mass, in the picture
    bool supports = true;  ///< draw plates at pinned particles, or rings if something rises above them
    bool halo = true;      ///< leave a gap around each body in the bodies behind it
    double trail_s = 0.0;  ///< 0 .. 3600: how long the path of a particle remains; 0: no trail
    /// Particles of each rope and net, from its end if negative, whose paths are drawn; empty: the free end
    /// of each rope.
    std::vector<int> trail_of;
    Markers markers = Markers::kNone;
    /// 0.1 .. 1000; default: a little more than half the line's width
    std::optional<double> marker_radius_px;
    std::optional<Color> pinned_color;
    std::optional<Color> free_color;
    Bars bars = Bars::kNone;
    std::optional<double> bar_width_px;  ///< 0.1 .. 1000; default a quarter of the rope's width, at least 1
    std::optional<Color> real_bar_color;
    std::optional<Color> imaginary_bar_color;
};

/// Where a label is: above the first pinned particle, or at the free end.
enum class LabelAt { kPin, kEnd };

/// Style overrides of one rope or net.
struct BodyStyleDef {
    std::optional<Color> color;
    /// Colours of its links in turn, for ColorBy::kLink, with the alpha of the first; empty: `color`.
    std::vector<Color> link_colors;
    std::optional<double> width_px;      ///< 0.1 .. 1000; default: rope_width_px, or net_width_px for a net
    std::optional<double> end_width_px;  ///< of a rope's last link, if width_px is of its first; 0.1 .. 1000
    /// Drawn in one layer with the body before it: without a halo between them, and in a gradient of the
    /// palette, or of the theme's, along such a row, except bodies with a colour of their own.
    bool merged = false;
    std::string label;  ///< its name; empty: none
    /// Where the label is; default: at the pin, unless several bodies with labels share it.
    std::optional<LabelAt> label_at;
};

/// Content of a live plot: the energies over time; of the ropes that turn about one pin, the angle of the tip
/// over time, or its angular velocity against it; the distance of the tips of ropes 0 and 1 over time, on a
/// logarithmic axis; the position of the first tip over time.
enum class LivePlot { kEnergy, kAngle, kPhase, kDivergence, kTip };

/// Where the potential energy is 0: at the start, or where it is lowest during the motion.
enum class EnergyZero { kStart, kLowest };

/// Ranges of the value axes of live plots, in J, degrees, rad/s, m and m, -1e12 .. 1e12; default: from the
/// whole motion. That of angles is the one of the phase plot's horizontal axis too; the ends of a
/// logarithmic axis, > 0, are rounded to powers of 10.
struct PlotRangesDef {
    std::array<std::optional<Interval>, 5> of;  ///< in the order of LivePlot
};

/// The language of words and the decimal sign in pictures and reports.
enum class Language { kEnglish, kGerman, kPortuguese, kSpanish, kFrench };

/// A text in the picture.
struct OverlayTextDef {
    std::string text;                 ///< as OverlayDef::title
    Vec2 at{0.5, 0.5};                ///< its middle, as shares of the picture from its upper left; 0 .. 1
    double from_s = 0.0;              ///< >= 0: from when on it shows
    std::optional<double> to_s = {};  ///< and before when, later than from_s; default: to the end
    double fade_s = 0.0;  ///< >= 0: how long it takes to appear, and to disappear if to_s is given
    std::optional<double> size_px = {};  ///< 4 .. 400; default: OverlayDef::text_px
    std::optional<Color> color = {};     ///< default: the theme's
};

/// Texts and plots at the edges of a picture.
struct OverlayDef {
    /// The time; default: on an opaque ground, if the shorter side has at least 160 px.
    std::optional<bool> time;
    std::optional<bool> scale_bar;  ///< a length of 1, 2 or 5 times a power of 10; default: as `time`
    std::optional<bool> legend;     ///< the scales of style.color_by and style.arrows; default: as `time`
    std::string title;              ///< UTF-8, of characters that the font has; empty: none
    /// File with the font of title, texts and labels, from the scene's folder (Scene::source), or from the
    /// working directory; empty: DejaVu Sans.
    std::string font;
    bool energy = false;          ///< the error of the energy (Figures::energy_error)
    bool method = false;          ///< the methods, and their error estimate
    std::vector<LivePlot> plots;  ///< each once; a frame without room for all shows the first ones
    PlotRangesDef plot_range;
    EnergyZero energy_zero = EnergyZero::kStart;  ///< of energies that plots and texts show
    Language language = Language::kEnglish;
    std::vector<OverlayTextDef> texts;  ///< not in a picture of several poses
    /// 4 .. 400: the size of the text at the edges; default: grows with the shorter side
    std::optional<double> text_px;
};

/// Camera position at one time. Fields that are not given are those of the CameraDef.
struct CameraKeyDef {
    double time_s = 0.0;  ///< >= 0
    std::optional<Vec2> center_m = {};
    std::optional<double> height_m = {};
};

/// Camera position. Fields that are not given are fitted to the whole motion.
struct CameraDef {
    static constexpr int kTip = -1;

    std::optional<Vec2> center_m = {};    ///< middle of the picture, in world coordinates; -1e9 .. 1e9
    std::optional<double> height_m = {};  ///< height of the picture in metres, 1e-9 .. 4e9
    double margin = 0.08;  ///< free border at each edge, as a share of the shorter side; 0 .. 0.45
    /// Followed body, whose smoothed centre of mass is the middle of the picture in place of center_m: the
    /// index of a rope or net, ropes first; or kTip, the free end of the first rope that has one. The height
    /// is fitted to the bodies about it.
    std::optional<int> follow = {};
    /// The camera moves smoothly from key to key, without overshoot; times increase. Not with `follow`.
    std::vector<CameraKeyDef> path = {};

    [[nodiscard]] bool moves() const { return follow || !path.empty(); }
};

}  // namespace corda
#pragma GCC visibility pop
