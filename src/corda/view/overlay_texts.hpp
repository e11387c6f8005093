#pragma once

#include <vector>

#include "corda/core/image.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"
#include "corda/view/font.hpp"

namespace corda::view {

/// Smallest shorter side of a frame that has overlays by default.
inline constexpr int kMinSidePx = 160;

/// The part of a picture that the plots leave, with the size, colour and fonts of its texts.
struct TextArea {
    int width_px;
    int height_px;
    int side_px;  ///< the shorter one of the frame
    int em_px;
    int edge_px;  ///< from the edges of the frame to the texts
    Color color;
    Language language;
    Font font;   ///< of numbers and the program's words
    Font words;  ///< of title, texts and labels
};

/// Title and method at the upper left, next to the legend of colours or below it.
struct Heading {
    std::vector<Text> title = {};  ///< its lines
    int method_baseline_px = 0;
    int method_room_px = 0;
    double bottom_px = 0.0;  ///< where the free space below begins; 0 if there is no heading
};

/// Breaks and shortens the title. `beside_end_px`: where the room next to the legend ends.
[[nodiscard]] Heading make_heading(const TextArea& area, const OverlayDef& def, int beside_end_px);

/// Adds a text in the picture at a time at which it shows, in several lines if it is long.
void draw_text(const TextArea& area, const OverlayTextDef& text, double time_s, DrawList& list);

}  // namespace corda::view
