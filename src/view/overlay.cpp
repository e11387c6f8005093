#include "corda/view/overlay.hpp"

#include <algorithm>
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

void remove_last_character(std::string& utf8) {
    constexpr unsigned kFollowing = 2;  // the two first bits of a byte that goes on
    while (!utf8.empty() && static_cast<unsigned char>(utf8.back()) >> 6U == kFollowing) utf8.pop_back();
    if (!utf8.empty()) utf8.pop_back();
}

}  // namespace

double rounded_up(double value) {
    const std::string nearest = fmt::format("{:.1e}", value);
    const double half = 0.05 * power_of_10(std::stoi(nearest.substr(nearest.find('e') + 1)));
    return std::stod(std::stod(nearest) < value ? fmt::format("{:.1e}", value + half) : nearest);
}

std::string power_text(double value) {
    if (!(value > 0.0) || !std::isfinite(value)) return fmt::format("{}", value);
    const std::string digits = fmt::format("{:.1e}", rounded_up(value));
    const std::size_t e = digits.find('e');
    const int exponent = std::stoi(digits.substr(e + 1));
    std::string text = digits.substr(0, e) + "·10";
    if (exponent < 0) text += "⁻";
    constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    for (const char digit : std::to_string(std::abs(exponent))) text += kDigits[digit - '0'];
    return text;
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

Insets Overlay::insets() const {
    Insets insets;
    if (def_.method)
        insets.top_px = method_baseline_px() + (kDescent + kGap) * em_px_;
    else if (!def_.title.empty())
        insets.top_px = title_baseline_px() + (kDescent + kGap) * title_px();
    if (has_bottom()) insets.bottom_px = edge_px_ + (kAscent + kGap) * em_px_;
    // A tiny frame is for the picture.
    const double share = 0.5 * height_ / std::max(0.5 * height_, insets.top_px + insets.bottom_px);
    return {share * insets.top_px, share * insets.bottom_px};
}

std::string Overlay::time_text(double time_s) const {
    const std::string digits = fmt::format("{:.{}f}", time_s, decimals_);
    std::string text = "t = ";
    for (std::size_t i = digits.size(); i < time_digits_; ++i) text += kFigureSpace;
    return text + digits + " s";
}

void Overlay::draw(const Caption& caption, double pixels_per_metre, DrawList& list) {
    int left_px = edge_px_;
    int right_px = width_ - edge_px_;
    if (time_ && caption.time_s) left_px = write_bottom(time_text(*caption.time_s), left_px, right_px, list);
    if (scale_bar_) right_px = draw_scale_bar(pixels_per_metre, left_px, list);
    if (def_.energy && caption.time_s) {
        const std::string error = caption.energy_error ? power_text(*caption.energy_error) : "unknown";
        write_bottom("energy error " + error, left_px, right_px, list);
    }
    write_top(def_.title, title_baseline_px(), title_px(), color_, list);
    constexpr std::uint8_t kDim = 0xb0;
    if (def_.method)
        write_top(caption.method, method_baseline_px(), em_px_, {color_.r, color_.g, color_.b, kDim}, list);
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

void Overlay::write_top(std::string text, int baseline_px, int size_px, Color color, DrawList& list) {
    const int room_px = width_ - 2 * edge_px_;
    if (font_.width_px(text, size_px) > room_px) {
        const std::string mark = "…";
        while (!text.empty() && font_.width_px(text + mark, size_px) > room_px) remove_last_character(text);
        text = text.empty() ? "" : text + mark;
    }
    font_.write({edge_px_, baseline_px, size_px, color, std::move(text)}, list);
}

}  // namespace corda::view
