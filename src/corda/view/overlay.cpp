#include "corda/view/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "corda/view/colors.hpp"
#include "corda/view/font.hpp"
#include "corda/view/number_text.hpp"
#include "corda/view/words.hpp"

namespace corda::view {
namespace {

// Sizes as shares of the frame's shorter side.
constexpr double kBarLength = 0.3;
constexpr double kBarWidth = 1.0 / 400.0;

// Sizes as shares of the em.
constexpr double kTitle = 1.4;
constexpr double kTitleLine = 1.3;  // of the title's
constexpr double kTick = 0.4;       // at the ends of the scale bar
constexpr double kLegendHeight = 0.6;
constexpr double kLegendTick = 0.2;
constexpr double kTallest = 1.1;      // above the baseline
constexpr double kMethodRoom = 20.0;  // next to the legend
constexpr int kGradientStepPx = 2;

/// The share of the picture's width that a label takes at most, and the em that it may always take.
constexpr double kMaxLabel = 0.3;
constexpr double kShortLabel = 6.0;

/// Least share of the picture's width next to a legend in which a title is wrapped.
constexpr double kMinBeside = 0.5;
/// Of a title or a text.
constexpr std::size_t kMaxLines = 3;

/// Smallest shorter side of a frame that has overlays by default.
constexpr int kMinSidePx = 160;

constexpr double kBarPerWidth = 0.2;
constexpr int kMaxDecimals = 9;

/// Texts to the right of the time leave room for this one, so that they keep their places until 100 s.
constexpr double kTwoDigitsS = 10.0;

/// "kinetic 1.25 J, potential −0.75 J", with a unit and decimals that depend on the scale alone.
std::string energy_text(const Energy& energy, double scale_j, Language language) {
    const NumberTitle title = title_of("", "J", scale_j);  // " (kJ)"
    const double scale = scale_j / title.unit;
    const int decimals = scale >= 100.0 ? 0 : scale >= 10.0 ? 1 : 2;
    const auto text = [&](double energy_j) {
        const std::string digits = fmt::format("{:.{}f}", std::abs(energy_j) / title.unit, decimals);
        const bool is_negative = energy_j < 0.0 && digits.find_first_of("123456789") != std::string::npos;
        return (is_negative ? "−" : "") + localized(digits, language) + " " +
               title.text.substr(2, title.text.size() - 3);
    };
    return fmt::format("{} {}, {} {}", translated("kinetic", language), text(energy.kinetic_j),
                       translated("potential", language), text(energy.potential_j()));
}

/// A text at the lower edge, to the right of the time.
struct BottomText {
    bool (*is_shown)(const OverlayDef& def);
    std::string (*text)(const Caption& caption, double energy_scale_j, Language language);
};
constexpr BottomText kBottomTexts[] = {
    {[](const OverlayDef& def) { return def.energy; },
     [](const Caption& caption, double energy_scale_j, Language language) {
         if (caption.energy_error)
             return localized(translated("energy error", language) + " " + power_text(*caption.energy_error),
                              language);
         return caption.energy ? energy_text(*caption.energy, energy_scale_j, language) : "";
     }},
};

}  // namespace

void locate(std::span<const BodyLabel> labels, const State& state, const Camera& camera, Caption& caption) {
    for (const BodyLabel& label : labels)
        caption.labels.emplace_back(camera.at(state, label.particle), camera.at(state, label.from));
}

std::vector<std::string> digits_of(std::span<const double> times_s) {
    constexpr int kFewDigits = 3;
    std::vector<std::string> all;
    double steps_1_s = 1.0;  // of the last digit
    for (int digits = 1; digits <= kMaxDecimals; ++digits) {
        all.clear();
        bool is_exact = true;
        steps_1_s *= 10.0;
        for (const double time_s : times_s) {
            all.push_back(fmt::format("{:.{}f}", time_s, digits));
            is_exact &= std::abs(std::round(time_s * steps_1_s) / steps_1_s - time_s) < 1e-9;
        }
        const bool are_apart = std::ranges::adjacent_find(all) == all.end();
        if (is_exact || (digits >= kFewDigits && are_apart)) break;
    }
    return all;
}

std::string time_label(const std::string& digits, Language language) {
    return "t = " + localized(digits, language) + " s";
}

Overlay::Overlay(const OverlayDef& def, const StyleDef& style, int width, int height, double interval_s)
    : def_(def),
      arrows_(style.arrows),
      arrow_color_(arrow_color(style)),
      side_px_(std::min(width, height)),
      em_px_(def.text_px ? rounded(*def.text_px) : em_of(width, height)),
      edge_px_(edge_of(side_px_, em_px_)),
      words_(def.font) {
    const PlotLayout layout = lay_out_plots(def.plots.size(), width, height);
    width_ = layout.width_px;
    height_ = layout.height_px;
    for (const PixelRect& panel : layout.panels)
        plots_.emplace_back(style, width, height, panel, layout.em_px);
    panel_.right_panel_px = width - width_;
    panel_.bottom_panel_px = height - height_;
    const Look look = look_of(style);
    const bool by_default = side_px_ >= kMinSidePx && look.ground.is_opaque();
    time_ = def.time.value_or(by_default);
    scale_bar_ = def.scale_bar.value_or(by_default);
    const bool has_legends = def.legend.value_or(by_default);
    legend_ = quantity_of(style.color_by) && has_legends;
    if (!has_legends) arrows_ = Arrows::kNone;
    color_ = text_color(look);
    lay_out_top();
    while (decimals_ < kMaxDecimals && interval_s * power_of_10(decimals_) < 1.0) ++decimals_;
}

void Overlay::set_plots(std::span<const PlotData> data, std::span<const Color> body_colors) {
    for (std::size_t i = 0; i < plots_.size(); ++i)
        plots_[i].set_data(data[i], body_colors, 0, font_, words_);
    std::map<int, int> widest_px;  // by the left edge of panels above each other
    for (const PlotPanel& plot : plots_)
        widest_px[plot.panel().x0] = std::max(widest_px[plot.panel().x0], plot.label_px());
    for (std::size_t i = 0; i < plots_.size(); ++i)
        plots_[i].set_data(data[i], body_colors, widest_px[plots_[i].panel().x0], font_, words_);
}

bool Overlay::has_bottom() const {
    return time_ || scale_bar_ || arrows_ != Arrows::kNone ||
           std::any_of(std::begin(kBottomTexts), std::end(kBottomTexts),
                       [this](const BottomText& item) { return item.is_shown(def_); });
}

int Overlay::title_px() const {
    return rounded(kTitle * em_px_);
}

int Overlay::title_line_px() const {
    return rounded(kTitleLine * title_px());
}

int Overlay::title_baseline_px() const {
    const auto more = static_cast<int>(title_lines_.size()) - 1;
    return title_top_px_ + rounded(kAscent * title_px()) + more * title_line_px();
}

int Overlay::room_px(int top_px) const {
    const bool is_below = top_px >= legend_baseline_px() + rounded(kDescent * em_px_);
    return (is_below ? width_ - edge_px_ : legend_x_px_) - edge_px_;
}

std::vector<Overlay::TopLine> Overlay::wrapped(std::string text, int size_px,
                                               const std::function<int(int line)>& room_px) const {
    std::vector<TopLine> lines;
    for (;;) {
        const int room = room_px(static_cast<int>(lines.size()));
        std::size_t end = std::string::npos;
        if (words_.width_px(text, size_px) > room && lines.size() + 1 < kMaxLines)
            for (std::size_t space = text.find(' ');
                 space != std::string::npos && words_.width_px(text.substr(0, space), size_px) <= room;
                 space = text.find(' ', space + 1))
                end = space;
        lines.push_back({text.substr(0, end), room});
        if (end == std::string::npos) return lines;
        text.erase(0, end + 1);
    }
}

bool Overlay::wrap_title() {
    title_lines_ = wrapped(def_.title, title_px(),
                           [this](int line) { return room_px(title_top_px_ + line * title_line_px()); });
    return words_.width_px(title_lines_.back().text, title_px()) <= title_lines_.back().room_px;
}

void Overlay::lay_out_top() {
    const int all_px = width_ - 2 * edge_px_;
    legend_x_px_ = width_ - edge_px_;
    if (legend_ && scale_) {
        const Legend legend = lay_out_legend();
        if (legend.x_px >= edge_px_) legend_x_px_ = legend.x_px - rounded(kLine * em_px_);
    }
    const int beside_px = legend_x_px_ - edge_px_;
    const int below_px = legend_baseline_px() + rounded((kDescent + kGap) * em_px_);
    title_top_px_ = edge_px_;
    title_lines_ = {{def_.title, beside_px}};
    const auto is_one_line = [&] { return words_.width_px(def_.title, em_px_) <= title_lines_[0].room_px; };
    // A tiny frame is for the picture.
    if (side_px_ >= kMinSidePx && !is_one_line() && (beside_px < kMinBeside * all_px || !wrap_title())) {
        if (beside_px < all_px) title_top_px_ = below_px;
        title_lines_ = {{def_.title, all_px}};
        if (!is_one_line()) static_cast<void>(wrap_title());
    }
    method_baseline_px_ =
        (def_.title.empty() ? edge_px_ : title_baseline_px() + rounded((kLine - kAscent) * em_px_)) +
        rounded(kAscent * em_px_);
    if (beside_px < all_px && beside_px < kMethodRoom * em_px_)
        method_baseline_px_ = std::max(method_baseline_px_, below_px + rounded(kAscent * em_px_));
}

void Overlay::draw_text(const OverlayTextDef& text, DrawList& list) const {
    // One whose middle is in the picture stays apart from the plots.
    const bool is_apart = text.at.x * list.width <= width_ && text.at.y * list.height <= height_;
    const int end_px = (is_apart ? width_ : list.width) - edge_px_;
    const auto lines = wrapped(text.text, em_px_, [&](int /*line*/) { return end_px - edge_px_; });
    const int line_px = rounded(kLine * em_px_);
    const int more_px = line_px * (static_cast<int>(lines.size()) - 1);
    const int highest_px = rounded(kTallest * em_px_);
    const int bottom_px = (is_apart ? height_ : list.height) - rounded(kDescent * em_px_);
    int y_px = rounded(text.at.y * list.height + 0.5 * kAscent * em_px_) - more_px / 2;
    y_px = std::clamp(y_px, highest_px, std::max(highest_px, bottom_px - more_px));
    for (const TopLine& line : lines) {
        const std::string shown = words_.shortened(line.text, em_px_, line.room_px);
        const int width_px = words_.width_px(shown, em_px_);
        const int most_px = std::max(edge_px_, end_px - width_px);
        const int x_px = std::clamp(rounded(text.at.x * list.width - 0.5 * width_px), edge_px_, most_px);
        words_.write({x_px, y_px, em_px_, color_, shown}, list);
        y_px += line_px;
    }
}

int Overlay::legend_baseline_px() const {
    return edge_px_ + rounded((2.0 * kAscent + kLegendTick + kGap) * em_px_);
}

Insets Overlay::insets() const {
    Insets insets = panel_;
    if (def_.method)
        insets.top_px = method_baseline_px_ + (kDescent + kGap) * em_px_;
    else if (!def_.title.empty())
        insets.top_px = title_baseline_px() + (kDescent + kGap) * title_px();
    if (legend_) insets.top_px = std::max(insets.top_px, legend_baseline_px() + (kDescent + kGap) * em_px_);
    if (has_bottom()) insets.bottom_px = edge_px_ + (kAscent + kGap) * em_px_;
    // A tiny frame is for the picture.
    const double share = 0.5 * height_ / std::max(0.5 * height_, insets.top_px + insets.bottom_px);
    insets.top_px *= share;
    insets.bottom_px *= share;
    return insets;
}

void Overlay::set_labels(std::vector<BodyLabel> labels, std::span<const MotionBounds> motion,
                         std::vector<Drawn>& drawn) {
    labels_ = std::move(labels);
    const int most_px = rounded(std::max(kMaxLabel * width_, kShortLabel * em_px_));
    for (BodyLabel& label : labels_) {
        label.text = words_.shortened(std::move(label.text), em_px_, most_px);
        const double width_px = words_.width_px(label.text, em_px_);
        const double clear_px = label.clear_px + (kGap + label.row * kLine) * em_px_;
        Drawn text;
        text.bounds = motion[label.particle];
        text.up_px = clear_px + kAscent * em_px_;
        const bool is_above = label.from == label.particle;
        text.left_px = text.right_px = is_above ? 0.5 * width_px : clear_px + width_px;
        if (!is_above) text.down_px = text.up_px;
        drawn.push_back(text);
    }
}

void Overlay::set_arrows(double pixels_per_unit, double longest, bool is_cut) {
    arrow_text_.clear();
    if (arrows_ == Arrows::kNone || !std::isnormal(longest)) return;
    is_arrow_cut_ = is_cut;
    const double value = is_cut ? longest : round_number_below(longest).value();
    arrow_text_ = (is_cut ? "≥ " : "") +
                  localized(quantity_text(value, arrows_ == Arrows::kVelocity ? "m/s" : "N"), def_.language);
    arrow_text_px_ = font_.width_px(arrow_text_, em_px_);
    arrow_px_ = value * pixels_per_unit;
    const int time_px = time_ ? font_.width_px(time_text(kTwoDigitsS), em_px_) + rounded(kLine * em_px_) : 0;
    if (arrow_x_px() < edge_px_ + time_px) arrow_text_.clear();
}

int Overlay::arrow_x_px() const {
    const int end_px = width_ - edge_px_;
    return arrow_text_.empty() ? end_px
                               : end_px - rounded(arrow_px_) - rounded(kGap * em_px_) - arrow_text_px_;
}

void Overlay::draw_curves(double time_s, DrawList& list) const {
    for (const PlotPanel& plot : plots_) plot.draw_curves(time_s, list);
    if (arrow_text_.empty()) return;
    list.add_layer(arrow_color_);
    list.layers.back().is_note = true;
    const double end_px = width_ - edge_px_;
    const double y_px = height_ - edge_px_ - 0.5 * kAscent * em_px_;
    add_arrow({end_px - arrow_px_, y_px}, {end_px, y_px}, side_px_, false, is_arrow_cut_, list);
}

PixelRect Overlay::label_box(const BodyLabel& label, PixelPoint at, PixelPoint from, int turns,
                             double clear_px, const Font& font) const {
    PixelPoint along{at.x - from.x, at.y - from.y};
    const double length = sim::length(along.x, along.y);
    along = length > 0.0 ? PixelPoint{along.x / length, along.y / length} : PixelPoint{0.0, -1.0};
    constexpr double kHalfRoot = 0.70710678118654752;
    for (int i = 0; i < turns; ++i)
        along = {kHalfRoot * (along.x - along.y), kHalfRoot * (along.x + along.y)};
    const int width_px = font.width_px(label.text, em_px_);
    const double middle_px = at.x + along.x * (clear_px + 0.5 * width_px);
    const double baseline_px = at.y + along.y * clear_px + 0.5 * (1.0 + along.y) * kAscent * em_px_;
    // Beyond the frame, pixels may be more than an int holds.
    if (!(std::abs(middle_px) < width_ + width_px && std::abs(baseline_px) < height_ + em_px_)) return {};
    const int x_px = rounded(middle_px - 0.5 * width_px);
    return {x_px, rounded(baseline_px) - rounded(kAscent * em_px_), x_px + width_px, rounded(baseline_px)};
}

void Overlay::draw_label(const BodyLabel& label, PixelPoint at, PixelPoint from, DrawList& list) const {
    const double clear_px = label.clear_px + (kGap + label.row * kLine) * em_px_;
    const PixelRect box = label_box(label, at, from, 0, clear_px, words_);
    if (!box.empty()) words_.write({box.x0, box.y1, em_px_, color_, label.text}, list);
}

void Overlay::draw_times(std::span<const PoseTime> poses, DrawList& list) const {
    if (!time_) return;
    constexpr int kTurns[] = {0, 1, 7, 2, 6, 3, 5, 4};
    constexpr double kFaintest = 0.6;
    const int gap_px = rounded(kGap * em_px_);
    std::vector<PixelRect> taken{{0, height_ - edge_px_ - em_px_, width_, height_}};
    for (auto pose = poses.rbegin(); pose != poses.rend(); ++pose) {
        const auto distance_px = [](const PixelRect& box, const PoseTime& to) {  // from its ball
            const double x_px = std::clamp<double>(to.at.x, box.x0, box.x1) - to.at.x;
            const double y_px = std::clamp<double>(to.at.y, box.y0, box.y1) - to.at.y;
            return sim::length(x_px, y_px) - to.label.clear_px;
        };
        const auto is_clear = [&](const PixelRect& box) {  // whose time it is
            return std::ranges::all_of(poses, [&](const PoseTime& other) {
                return &other == &*pose || distance_px(box, other) > distance_px(box, *pose) + gap_px;
            });
        };
        const auto is_free = [&](const PixelRect& box) {
            const PixelRect around{box.x0 - gap_px, box.y0 - gap_px, box.x1 + gap_px, box.y1 + gap_px};
            return !box.empty() && around.intersected({0, 0, width_, height_}) == around &&
                   std::ranges::all_of(
                       taken, [&](const PixelRect& other) { return around.intersected(other).empty(); });
        };
        for (int i = 0; i < 16; ++i) {  // near, then farther away
            const double clear_px = pose->label.clear_px + gap_px + (i < 8 ? 0.0 : kLine * em_px_);
            const PixelRect box =
                label_box(pose->label, pose->at, pose->from, kTurns[i % 8], clear_px, font_);
            if (!is_free(box) || !is_clear(box)) continue;
            Color color = color_;
            color.a = static_cast<std::uint8_t>(std::lround(255.0 * std::max(kFaintest, pose->opacity)));
            font_.write({box.x0, box.y1, em_px_, color, pose->label.text}, list);
            taken.push_back(box);
            break;
        }
    }
}

std::string Overlay::time_text(double time_s) const {
    return time_label(fmt::format("{:.{}f}", time_s, decimals_), def_.language);
}

void Overlay::draw(const Caption& caption, double pixels_per_metre, DrawList& list) const {
    for (const PlotPanel& plot : plots_) plot.draw_axes(list, font_, words_);
    for (std::size_t i = 0; i < caption.labels.size(); ++i)
        draw_label(labels_[i], caption.labels[i].first, caption.labels[i].second, list);
    int left_px = edge_px_;
    int right_px = width_ - edge_px_;
    if (!arrow_text_.empty()) {
        font_.write({arrow_x_px(), height_ - edge_px_, em_px_, color_, arrow_text_}, list);
        right_px = arrow_x_px() - rounded(kLine * em_px_);
    }
    if (time_ && caption.time_s)
        left_px = write_bottom(time_text(*caption.time_s), left_px, right_px, list, time_text(kTwoDigitsS));
    if (scale_bar_) right_px = draw_scale_bar(pixels_per_metre, left_px, right_px, list);
    for (const BottomText& item : kBottomTexts) {
        if (item.is_shown(def_) && caption.time_s)
            left_px =
                write_bottom(item.text(caption, energy_scale_j_, def_.language), left_px, right_px, list);
    }
    if (legend_ && scale_) draw_legend(list);
    const int title_size_px = title_lines_.size() == 1 ? fitting_title_px() : title_px();
    for (std::size_t i = 0; i < title_lines_.size(); ++i) {
        const auto below = static_cast<int>(title_lines_.size() - 1 - i);
        write_top(title_lines_[i], " ", title_baseline_px() - below * title_line_px(), title_size_px, color_,
                  words_, list);
    }
    for (const OverlayTextDef& text : def_.texts) {
        const double time_s = caption.time_s.value_or(-1.0);
        if (time_s >= text.from_s && time_s < text.to_s.value_or(HUGE_VAL)) draw_text(text, list);
    }
    constexpr std::uint8_t kDim = 0xb0;
    if (def_.method)
        write_top({caption.method, room_px(method_baseline_px_ - rounded(kAscent * em_px_))}, ", ",
                  method_baseline_px_, em_px_, {color_.r, color_.g, color_.b, kDim}, font_, list);
}

int Overlay::fitting_title_px() const {
    const int room_px = title_lines_[0].room_px;
    int size_px = title_px();
    const int width_px = words_.width_px(def_.title, size_px);
    if (width_px <= room_px) return size_px;
    size_px = std::max(em_px_, rounded(static_cast<double>(size_px) * room_px / width_px));
    while (size_px > em_px_ && words_.width_px(def_.title, size_px) > room_px) --size_px;
    return size_px;
}

int Overlay::write_bottom(const std::string& text, int x_px, int end_px, DrawList& list,
                          const std::string& widest) const {
    const int width_px = font_.width_px(text, em_px_);
    if (x_px + width_px > end_px) return x_px;
    font_.write({x_px, height_ - edge_px_, em_px_, color_, text}, list);
    return x_px + std::max(width_px, font_.width_px(widest, em_px_)) + rounded(kLine * em_px_);
}

int Overlay::draw_scale_bar(double pixels_per_metre, int begin_px, int right_px, DrawList& list) const {
    const double longest_px = std::min(kBarPerWidth * width_, kBarLength * side_px_);
    const double longest_m = longest_px / pixels_per_metre;
    if (!std::isnormal(longest_m)) return right_px;
    const RoundNumber number = round_number_below(longest_m);
    const int length_px = std::max(1, rounded(number.value() * pixels_per_metre));
    const std::string text = localized(length_text(number.digit, number.exponent), def_.language);
    const int gap_px = rounded(kGap * em_px_);
    const int text_px = right_px - length_px - gap_px - font_.width_px(text, em_px_);
    if (text_px < begin_px) return right_px;
    const int baseline_px = height_ - edge_px_;
    font_.write({text_px, baseline_px, em_px_, color_, text}, list);
    const int line_px = std::max(1, rounded(kBarWidth * side_px_));
    const int tick_px = std::max(line_px + 1, rounded(kTick * em_px_));
    const int left_px = right_px - length_px;
    list.add_box({left_px, baseline_px - line_px, right_px, baseline_px}, color_);
    list.add_box({left_px, baseline_px - tick_px, left_px + line_px, baseline_px - line_px}, color_);
    list.add_box({right_px - line_px, baseline_px - tick_px, right_px, baseline_px - line_px}, color_);
    return text_px - rounded(kLine * em_px_);
}

Overlay::Legend Overlay::lay_out_legend() const {
    const NumberTitle title = title_of(*scale_);
    const auto number = [&](double value) {
        return localized(display_number(value / title.unit), def_.language);
    };
    Legend legend;
    legend.name = translated(title.text, def_.language);
    legend.first = (scale_->is_cut && scale_->low < 0.0 ? "≤ " : "") + number(scale_->low);
    legend.middle = number(0.5 * (scale_->low + scale_->high));
    legend.last = (scale_->is_cut ? "≥ " : "") + number(scale_->high);
    legend.bar_end_px = width_ - edge_px_ - font_.width_px(legend.last, em_px_) / 2;
    legend.bar_x_px = legend.bar_end_px - rounded(kBarLength * side_px_);
    legend.x_px = legend.bar_x_px - rounded(kGap * em_px_) - font_.width_px(legend.name, em_px_);
    return legend;
}

void Overlay::draw_legend(DrawList& list) const {
    const auto [name, first, middle, last, x_px, bar_px0, bar_end_px] = lay_out_legend();
    if (x_px < edge_px_) return;
    const auto half_px = [this](const std::string& text) { return font_.width_px(text, em_px_) / 2; };
    const int bar_px = bar_end_px - bar_px0;
    const int baseline_px = edge_px_ + rounded(kAscent * em_px_);
    font_.write({x_px, baseline_px, em_px_, color_, name}, list);
    const int height_px = rounded(kLegendHeight * em_px_);
    const int top_px = baseline_px - (rounded(kAscent * em_px_) + height_px) / 2;
    draw_gradient({bar_px0, top_px, bar_end_px, top_px + height_px}, list);
    const int line_px = std::max(1, rounded(kBarWidth * side_px_));
    const auto add_tick = [&](int tick_x_px, const std::string& text) {
        const int tick_end_px = top_px + height_px + std::max(1, rounded(kLegendTick * em_px_));
        list.add_box({tick_x_px, top_px + height_px, tick_x_px + line_px, tick_end_px}, color_);
        font_.write({tick_x_px + line_px / 2 - half_px(text), legend_baseline_px(), em_px_, color_, text},
                    list);
    };
    add_tick(bar_px0, first);
    const int taken_px = std::max(half_px(first), half_px(last)) + half_px(middle) + rounded(kGap * em_px_);
    if (taken_px <= bar_px / 2) add_tick((bar_px0 + bar_end_px - line_px) / 2, middle);
    add_tick(bar_end_px - line_px, last);
}

void Overlay::draw_gradient(const PixelRect& bar, DrawList& list) const {
    for (int x = bar.x0; x < bar.x1; x += kGradientStepPx) {
        const int end = std::min(x + kGradientStepPx, bar.x1);
        const double share = (0.5 * (x + end) - bar.x0) / bar.width();
        list.add_box({x, bar.y0, end, bar.y1},
                     scale_->color(scale_->low + share * (scale_->high - scale_->low)));
    }
}

void Overlay::write_top(const TopLine& line, std::string_view separator, int baseline_px, int size_px,
                        Color color, const Font& font, DrawList& list) const {
    font.write(
        {edge_px_, baseline_px, size_px, color, font.shortened(line.text, size_px, line.room_px, separator)},
        list);
}

}  // namespace corda::view
