#pragma once

#include <optional>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/sim/defs.hpp"

#pragma GCC visibility push(default)
namespace corda {

/// Which particles get a marker.
enum class Markers { kNone, kPinned, kAll };

/// Which bars are drawn as lines of their own: real ones over the ropes and nets, imaginary ones behind them.
enum class Bars { kNone, kReal, kAll };

/// How a scene looks. Widths are in pixels of the output. The defaults grow with its height.
struct StyleDef {
    Color background{0x12, 0x16, 0x1f, 255};  ///< opaque
    /// Colours of the ropes and nets in turn. A body that has its own colour (BodyStyleDef) takes none of
    /// them.
    std::vector<Color> palette{{0xe8, 0xc0, 0x7d, 255}, {0x6f, 0xb7, 0xe9, 255}, {0xe5, 0x8f, 0x8f, 255},
                               {0x8f, 0xd1, 0x9e, 255}, {0xc3, 0xa6, 0xe8, 255}, {0xf0, 0xe3, 0x9a, 255}};
    std::optional<double> rope_width_px;  ///< 0.1 .. 1000; default height / 216, at least 1.5
    Markers markers = Markers::kPinned;
    std::optional<double>
        marker_radius_px;  ///< 0.1 .. 1000; default: a little more than half the line's width
    Color pinned_color{0xff, 0x5d, 0x5d, 255};
    Color free_color{0xf5, 0xf1, 0xe6, 255};
    Bars bars = Bars::kNone;
    std::optional<double> bar_width_px;  ///< 0.1 .. 1000; default a quarter of the rope's width, at least 1
    Color real_bar_color{0xff, 0xff, 0xff, 255};
    Color imaginary_bar_color{0x54, 0xd6, 0xc2, 0xb0};
};

/// What one rope or net overrides in the style.
struct BodyStyleDef {
    std::optional<Color> color;
    std::optional<double> width_px;  ///< 0.1 .. 1000; default: rope_width_px, half of it for a net
};

/// Where the camera looks. What is not given is fitted to the whole motion.
struct CameraDef {
    std::optional<Vec2> center_m;    ///< middle of the picture, in world coordinates; finite
    std::optional<double> height_m;  ///< height of the picture in metres, > 0 and finite
    double margin = 0.08;            ///< free border at each edge, as a share of the shorter side; 0 .. 0.45
};

}  // namespace corda
#pragma GCC visibility pop
