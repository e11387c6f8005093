#include "corda/view/overlay.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "corda/view/look.hpp"

namespace corda::view {
namespace {

// Sizes as shares of the frame's shorter side.
constexpr double kEm = 1.0 / 40.0;
constexpr double kSmallEm = 1.0 / 16.0;  // of frames in which kEm is too small to read
constexpr double kEdge = 0.03;
constexpr double kBarLength = 0.3;
constexpr double kBarWidth = 1.0 / 400.0;

constexpr double kReadableEmPx = 12.0;
constexpr double kSmallestEmPx = 7.0;

// Sizes as shares of the em.
constexpr double kTitle = 1.4;
constexpr double kEdgePerEm = 0.45;
constexpr double kAscent = 0.76;   // of DejaVu's capitals
constexpr double kDescent = 0.24;  // below the baseline
constexpr double kLine = 1.5;      // from a baseline to the next
constexpr double kGap = 0.4;       // between a text and what the camera shows
constexpr double kTick = 0.4;      // at the ends of the scale bar
constexpr double kLegendHeight = 0.6;
constexpr double kLegendTick = 0.2;
constexpr int kGradientStepPx = 2;

/// In frames whose shorter side is less, overlays are in the way.
constexpr int kSmallestSidePx = 160;

constexpr double kBarPerWidth = 0.2;
constexpr int kMostDecimals = 9;

/// U+2007, as wide as a digit.
constexpr const char* kFigureSpace = "\u2007";

int rounded(double px) {
    return static_cast<int>(std::lround(px));
}

int em_of(int side_px) {
    return rounded(std::max({kEm * side_px, std::min(kReadableEmPx, kSmallEm * side_px), kSmallestEmPx}));
}

/// 10 to that power, rounded once.
double power_of_10(int exponent) {
    double power = 1.0;
    for (int i = 0; i < std::abs(exponent); ++i) power *= 10.0;
    return exponent < 0 ? 1.0 / power : power;
}

/// Where the character that begins at byte `i` of a UTF-8 text ends.
std::size_t end_of_character(std::string_view utf8, std::size_t i) {
    constexpr unsigned kFollowing = 2;  // the two first bits of a byte that goes on
    do ++i;
    while (i < utf8.size() && static_cast<unsigned char>(utf8[i]) >> 6U == kFollowing);
    return i;
}

}  // namespace

std::string time_text(const std::string& digits) {
    return "t = " + digits + " s";
}

double rounded_up(double value) {
    if (!(value > 0.0) || !std::isfinite(value)) return value;
    // std::stod would take a comma in some countries.
    const auto number = [](const std::string& text) {
        double parsed = 0.0;
        std::from_chars(text.data(), text.data() + text.size(), parsed);
        return parsed;
    };
    const std::string nearest = fmt::format("{:.1e}", value);
    const double half = 0.05 * power_of_10(std::stoi(nearest.substr(nearest.find('e') + 1)));
    return number(number(nearest) < value ? fmt::format("{:.1e}", value + half) : nearest);
}

namespace {

/// "10⁻¹²"
std::string power_of_10_text(int exponent) {
    std::string text = exponent < 0 ? "10⁻" : "10";
    constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    for (const char digit : std::to_string(std::abs(exponent))) text += kDigits[digit - '0'];
    return text;
}

/// The exponent of the largest power of 1000 that is not above.
int thousands_below(double value) {
    int exponent = 0;
    while (exponent > -300 && power_of_10(exponent) > value * (1.0 + 1e-9)) exponent -= 3;
    while (exponent < 300 && power_of_10(exponent + 3) <= value) exponent += 3;
    return exponent;
}

/// "k" for 3; empty if there is none.
std::string prefix_of(int exponent) {
    constexpr const char* kPrefixes[] = {"n", "µ", "m", "", "k", "M", "G", "T"};
    return exponent < -9 || exponent > 12 ? "" : kPrefixes[exponent / 3 + 3];
}

}  // namespace

std::string power_text(double value) {
    if (!(value > 0.0) || !std::isfinite(value)) return fmt::format("{}", value);
    const std::string digits = fmt::format("{:.1e}", rounded_up(value));
    const std::size_t e = digits.find('e');
    return digits.substr(0, e) + "·" + power_of_10_text(std::stoi(digits.substr(e + 1)));
}

ScaleTitle title_of(const ColorScale& scale) {
    constexpr double kFewestDecimals = 0.01;
    constexpr double kMostDigits = 1e4;
    const double shortest = scale.quantity == Quantity::kStrain ? kFewestDecimals : 10.0 * kFewestDecimals;
    const bool is_plain = scale.high >= shortest * (1.0 - 1e-9) && scale.high < kMostDigits;
    const int exponent = is_plain ? 0 : thousands_below(scale.high);
    const std::string power = power_of_10_text(exponent);
    if (scale.quantity == Quantity::kStrain)
        return {exponent == 0 ? "strain" : fmt::format("strain ({})", power), power_of_10(exponent)};
    const bool is_tension = scale.quantity == Quantity::kTension;
    const std::string prefix = prefix_of(exponent);
    const std::string factor = exponent != 0 && prefix.empty() ? power + " " : "";
    return {fmt::format("{} ({}{}{})", is_tension ? "tension" : "speed", factor, prefix,
                        is_tension ? "N" : "m/s"),
            power_of_10(exponent)};
}

std::string length_text(int digit, int exponent) {
    const auto [unit, power] = exponent >= 3    ? std::pair{"km", 3}
                               : exponent >= 0  ? std::pair{"m", 0}
                               : exponent >= -2 ? std::pair{"cm", -2}
                               : exponent >= -3 ? std::pair{"mm", -3}
                               : exponent >= -6 ? std::pair{"µm", -6}
                                                : std::pair{"nm", -9};
    const int rest = exponent - power;
    return fmt::format("{} {}", rest < 0 ? digit / power_of_10(-rest) : digit * power_of_10(rest), unit);
}

Overlay::Overlay(const OverlayDef& def, const StyleDef& style, int width, int height, double interval_s,
                 double end_s)
    : def_(def), width_(width), height_(height) {
    const int side_px = std::min(width, height);
    const Look look = look_of(style);
    const bool by_default = side_px >= kSmallestSidePx && look.ground.is_opaque();
    time_ = def.time.value_or(by_default);
    scale_bar_ = def.scale_bar.value_or(by_default);
    legend_ = quantity_of(style.color_by) && def.legend.value_or(by_default);
    color_ = text_color(look);
    em_px_ = em_of(side_px);
    edge_px_ = rounded(std::max(kEdge * side_px, kEdgePerEm * em_px_));
    while (decimals_ < kMostDecimals && interval_s * power_of_10(decimals_) < 1.0) ++decimals_;
    time_digits_ = fmt::format("{:.{}f}", std::max(0.0, end_s - interval_s), decimals_).size();
}

int Overlay::title_px() const {
    return rounded(kTitle * em_px_);
}

int Overlay::title_baseline_px() const {
    return edge_px_ + rounded(kAscent * title_px());
}

int Overlay::method_baseline_px() const {
    return def_.title.empty() ? edge_px_ + rounded(kAscent * em_px_)
                              : title_baseline_px() + rounded(kLine * em_px_);
}

int Overlay::legend_baseline_px() const {
    return edge_px_ + rounded((2.0 * kAscent + kLegendTick + kGap) * em_px_);
}

Insets Overlay::insets() const {
    Insets insets;
    if (def_.method)
        insets.top_px = method_baseline_px() + (kDescent + kGap) * em_px_;
    else if (!def_.title.empty())
        insets.top_px = title_baseline_px() + (kDescent + kGap) * title_px();
    if (legend_) insets.top_px = std::max(insets.top_px, legend_baseline_px() + (kDescent + kGap) * em_px_);
    if (has_bottom()) insets.bottom_px = edge_px_ + (kAscent + kGap) * em_px_;
    // A tiny frame is for the picture.
    const double share = 0.5 * height_ / std::max(0.5 * height_, insets.top_px + insets.bottom_px);
    return {share * insets.top_px, share * insets.bottom_px};
}

std::string Overlay::wide_time_text(double time_s) const {
    std::string digits = fmt::format("{:.{}f}", time_s, decimals_);
    while (digits.size() < time_digits_) digits.insert(0, 1, ' ');
    std::string text;
    for (const char digit : digits) text += digit == ' ' ? kFigureSpace : std::string(1, digit);
    return time_text(text);
}

void Overlay::draw(const Caption& caption, double pixels_per_metre, DrawList& list) {
    int left_px = edge_px_;
    int right_px = width_ - edge_px_;
    if (time_ && caption.time_s)
        left_px = write_bottom(wide_time_text(*caption.time_s), left_px, right_px, list);
    if (scale_bar_) right_px = draw_scale_bar(pixels_per_metre, left_px, list);
    if (def_.energy && caption.time_s) {
        const std::string error = caption.energy_error ? power_text(*caption.energy_error) : "unknown";
        write_bottom("energy error " + error, left_px, right_px, list);
    }
    const int end_px = legend_ && scale_ ? draw_legend(list) : width_ - edge_px_;
    write_top(def_.title, end_px, title_baseline_px(), title_px(), color_, list);
    constexpr std::uint8_t kDim = 0xb0;
    if (def_.method)
        write_top(caption.method, end_px, method_baseline_px(), em_px_, {color_.r, color_.g, color_.b, kDim},
                  list);
}

int Overlay::write_bottom(const std::string& text, int x_px, int end_px, DrawList& list) {
    const int text_end_px = x_px + font_.width_px(text, em_px_);
    if (text_end_px > end_px) return x_px;
    font_.write({x_px, height_ - edge_px_, em_px_, color_, text}, list);
    return text_end_px + rounded(kLine * em_px_);
}

int Overlay::draw_scale_bar(double pixels_per_metre, int begin_px, DrawList& list) {
    const int right_px = width_ - edge_px_;
    const double longest_px = std::min(kBarPerWidth * width_, kBarLength * std::min(width_, height_));
    const double longest_m = longest_px / pixels_per_metre;
    if (!std::isnormal(longest_m)) return right_px;
    int exponent = static_cast<int>(std::floor(std::log10(longest_m)));
    // log10 may be off by one next to a power of 10.
    if (power_of_10(exponent + 1) <= longest_m) ++exponent;
    if (power_of_10(exponent) > longest_m) --exponent;
    int digit = 1;
    for (const int larger : {2, 5})
        if (larger * power_of_10(exponent) <= longest_m) digit = larger;
    const int length_px = std::max(1, rounded(digit * power_of_10(exponent) * pixels_per_metre));
    const std::string text = length_text(digit, exponent);
    const int gap_px = rounded(kGap * em_px_);
    const int text_px = right_px - length_px - gap_px - font_.width_px(text, em_px_);
    if (text_px < begin_px) return right_px;
    const int baseline_px = height_ - edge_px_;
    font_.write({text_px, baseline_px, em_px_, color_, text}, list);
    const int line_px = std::max(1, rounded(kBarWidth * std::min(width_, height_)));
    const int tick_px = std::max(line_px + 1, rounded(kTick * em_px_));
    const int left_px = right_px - length_px;
    list.add_box({left_px, baseline_px - line_px, right_px, baseline_px}, color_);
    list.add_box({left_px, baseline_px - tick_px, left_px + line_px, baseline_px - line_px}, color_);
    list.add_box({right_px - line_px, baseline_px - tick_px, right_px, baseline_px - line_px}, color_);
    return text_px - rounded(kLine * em_px_);
}

int Overlay::draw_legend(DrawList& list) {
    const ScaleTitle title = title_of(*scale_);
    const auto number = [&](double value) { return fmt::format("{:g}", value / title.unit + 0.0); };
    const std::string beyond = scale_->is_cut ? "≥ " : "";
    const bool goes_below = scale_->low < 0.0;
    const std::string first =
        goes_below ? (scale_->is_cut ? "≤ −" : "−") + number(-scale_->low) : number(0.0);
    const std::string last = beyond + number(scale_->high);
    const auto half_px = [&](const std::string& text) { return font_.width_px(text, em_px_) / 2; };
    const int bar_px = rounded(kBarLength * std::min(width_, height_));
    const int bar_end_px = width_ - edge_px_ - half_px(last);
    const int bar_px0 = bar_end_px - bar_px;
    const int title_end_px = bar_px0 - rounded(kGap * em_px_);
    const int title_x_px = title_end_px - font_.width_px(title.text, em_px_);
    if (title_x_px < edge_px_) return width_ - edge_px_;
    const int baseline_px = edge_px_ + rounded(kAscent * em_px_);
    font_.write({title_x_px, baseline_px, em_px_, color_, title.text}, list);
    const int height_px = rounded(kLegendHeight * em_px_);
    const int top_px = baseline_px - (rounded(kAscent * em_px_) + height_px) / 2;
    draw_gradient({bar_px0, top_px, bar_end_px, top_px + height_px}, list);
    const int line_px = std::max(1, rounded(kBarWidth * std::min(width_, height_)));
    const auto add_tick = [&](int x_px, const std::string& text) {
        const int tick_end_px = top_px + height_px + std::max(1, rounded(kLegendTick * em_px_));
        list.add_box({x_px, top_px + height_px, x_px + line_px, tick_end_px}, color_);
        font_.write({x_px + line_px / 2 - half_px(text), legend_baseline_px(), em_px_, color_, text}, list);
    };
    add_tick(bar_px0, first);
    const std::string middle = number(0.5 * (scale_->low + scale_->high));
    const int taken_px = std::max(half_px(first), half_px(last)) + half_px(middle) + rounded(kGap * em_px_);
    if (taken_px <= bar_px / 2) add_tick((bar_px0 + bar_end_px - line_px) / 2, middle);
    add_tick(bar_end_px - line_px, last);
    return title_x_px - rounded(kLine * em_px_);
}

void Overlay::draw_gradient(const PixelRect& bar, DrawList& list) const {
    for (int x = bar.x0; x < bar.x1; x += kGradientStepPx) {
        const int end = std::min(x + kGradientStepPx, bar.x1);
        const double share = (0.5 * (x + end) - bar.x0) / bar.width();
        list.add_box({x, bar.y0, end, bar.y1},
                     scale_->color(scale_->low + share * (scale_->high - scale_->low)));
    }
}

void Overlay::write_top(std::string text, int end_px, int baseline_px, int size_px, Color color,
                        DrawList& list) {
    const int room_px = end_px - edge_px_;
    if (font_.width_px(text, size_px) > room_px) {
        const std::string mark = "…";
        int end = font_.width_px(mark, size_px);
        std::size_t kept = 0;
        for (std::size_t next = 0; next < text.size(); kept = next) {
            next = end_of_character(text, next);
            end += font_.width_px(std::string_view(text).substr(kept, next - kept), size_px);
            if (end > room_px) break;
        }
        text = kept == 0 ? "" : text.substr(0, kept) + mark;
    }
    font_.write({edge_px_, baseline_px, size_px, color, std::move(text)}, list);
}

}  // namespace corda::view
