#include "corda/view/overlay_texts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "corda/view/legends.hpp"

namespace corda::view {
namespace {

// Sizes as shares of the em.
constexpr double kTitle = 1.4;
constexpr double kTitleLine = 1.3;    // of the title's
constexpr double kTallest = 1.1;      // above the baseline
constexpr double kMethodRoom = 20.0;  // next to the legend

/// Least share of the picture's width next to a legend in which a title is wrapped.
constexpr double kMinBeside = 0.5;
/// Of a title or a text.
constexpr std::size_t kMaxLines = 3;

struct Line {
    std::string text;
    int room_px = 0;
};

/// Breaks a text at spaces into a few lines, of which the last one may be too long.
std::vector<Line> wrapped(const Font& font, std::string text, int size_px,
                          const std::function<int(int line)>& room_px) {
    std::vector<Line> lines;
    for (;;) {
        const int room = room_px(static_cast<int>(lines.size()));
        std::size_t end = std::string::npos;
        if (font.width_px(text, size_px) > room && lines.size() + 1 < kMaxLines)
            for (std::size_t space = text.find(' ');
                 space != std::string::npos && font.width_px(text.substr(0, space), size_px) <= room;
                 space = text.find(' ', space + 1))
                end = space;
        lines.push_back({text.substr(0, end), room});
        if (end == std::string::npos) return lines;
        text.erase(0, end + 1);
    }
}

/// Size of a title of one line: smaller, down to the size of the other texts, if it would not fit.
int fitting_px(const TextArea& area, const Line& title, int title_px) {
    const int width_px = area.words.width_px(title.text, title_px);
    if (width_px <= title.room_px) return title_px;
    int size_px = std::max(area.em_px, rounded(static_cast<double>(title_px) * title.room_px / width_px));
    while (size_px > area.em_px && area.words.width_px(title.text, size_px) > title.room_px) --size_px;
    return size_px;
}

}  // namespace

Heading make_heading(const TextArea& area, const OverlayDef& def, int beside_end_px) {
    const int title_px = rounded(kTitle * area.em_px);
    const int line_px = rounded(kTitleLine * title_px);
    const int all_px = area.width_px - 2 * area.edge_px;
    const int beside_px = beside_end_px - area.edge_px;
    const int legend_px = legend_baseline_px(area);
    const int below_px = legend_px + rounded((kDescent + kGap) * area.em_px);
    const auto room_px = [&](int top_px) {
        return top_px >= legend_px + rounded(kDescent * area.em_px) ? all_px : beside_px;
    };
    const auto wrapped_title = [&](int top_px) {
        return wrapped(area.words, def.title, title_px,
                       [&](int line) { return room_px(top_px + line * line_px); });
    };
    const auto fits = [&](const Line& line, int size_px) {
        return area.words.width_px(line.text, size_px) <= line.room_px;
    };
    int top_px = area.edge_px;
    std::vector<Line> lines{{def.title, beside_px}};
    // A tiny frame is for the picture.
    if (area.side_px >= kMinSidePx && !fits(lines[0], area.em_px)) {
        const bool is_beside = beside_px >= kMinBeside * all_px;
        if (is_beside) lines = wrapped_title(top_px);
        if (!is_beside || !fits(lines.back(), title_px)) {
            if (beside_px < all_px) top_px = below_px;
            lines = {{def.title, all_px}};
            if (!fits(lines[0], area.em_px)) lines = wrapped_title(top_px);
        }
    }
    Heading heading;
    const int size_px = lines.size() == 1 ? fitting_px(area, lines[0], title_px) : title_px;
    int title_baseline_px = top_px + rounded(kAscent * title_px) - line_px;  // of its last line
    for (const Line& line : lines) {
        title_baseline_px += line_px;
        heading.title.push_back({area.edge_px, title_baseline_px, size_px, area.color,
                                 area.words.shortened(line.text, size_px, line.room_px)});
    }
    const int ascent_px = rounded(kAscent * area.em_px);
    heading.method_baseline_px =
        ascent_px +
        (def.title.empty() ? area.edge_px : title_baseline_px + rounded((kLine - kAscent) * area.em_px));
    if (beside_px < all_px && beside_px < kMethodRoom * area.em_px)
        heading.method_baseline_px = std::max(heading.method_baseline_px, below_px + ascent_px);
    heading.method_room_px = room_px(heading.method_baseline_px - ascent_px);
    if (def.method)
        heading.bottom_px = heading.method_baseline_px + (kDescent + kGap) * area.em_px;
    else if (!def.title.empty())
        heading.bottom_px = title_baseline_px + (kDescent + kGap) * title_px;
    return heading;
}

void draw_text(const TextArea& area, const OverlayTextDef& text, double time_s, DrawList& list) {
    const int em_px = text.size_px ? rounded(*text.size_px) : area.em_px;
    Color color = text.color.value_or(area.color);
    const double left_s = std::min(time_s - text.from_s, text.to_s.value_or(HUGE_VAL) - time_s);
    if (left_s < text.fade_s) color.a = static_cast<std::uint8_t>(rounded(color.a * left_s / text.fade_s));
    // One whose middle is in the picture stays apart from the plots.
    const bool is_apart =
        text.at.x * list.width <= area.width_px && text.at.y * list.height <= area.height_px;
    const int end_px = (is_apart ? area.width_px : list.width) - area.edge_px;
    const auto lines =
        wrapped(area.words, text.text, em_px, [&](int /*line*/) { return end_px - area.edge_px; });
    const int line_px = rounded(kLine * em_px);
    const int more_px = line_px * (static_cast<int>(lines.size()) - 1);
    const int highest_px = rounded(kTallest * em_px);
    const int bottom_px = (is_apart ? area.height_px : list.height) - rounded(kDescent * em_px);
    int y_px = rounded(text.at.y * list.height + 0.5 * kAscent * em_px) - more_px / 2;
    y_px = std::clamp(y_px, highest_px, std::max(highest_px, bottom_px - more_px));
    for (const Line& line : lines) {
        const std::string shown = area.words.shortened(line.text, em_px, line.room_px);
        const int width_px = area.words.width_px(shown, em_px);
        const int most_px = std::max(area.edge_px, end_px - width_px);
        const int x_px = std::clamp(rounded(text.at.x * list.width - 0.5 * width_px), area.edge_px, most_px);
        area.words.write({x_px, y_px, em_px, color, shown}, list);
        y_px += line_px;
    }
}

}  // namespace corda::view
