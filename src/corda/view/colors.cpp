#include "corda/view/colors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace corda::view {
namespace {

/// The colours of M. Okabe and K. Ito, Color Universal Design (2008), that stand out from a dark ground, and
/// white.
ThemeColors dark() {
    return {.ground = {{0x0e, 0x13, 0x20}, {0x1b, 0x24, 0x38}},
            .palette = {{0xe6, 0x9f, 0x00},
                        {0x56, 0xb4, 0xe9},
                        {0xf0, 0xe4, 0x42},
                        {0xcc, 0x79, 0xa7},
                        {0x00, 0x9e, 0x73},
                        {0xff, 0xff, 0xff}},
            .support = {0x8a, 0x93, 0xa6},
            .outline = {0xf4, 0xf1, 0xe8},
            .pinned = {0xff, 0x5d, 0x5d},
            .free = {0xf5, 0xf1, 0xe6},
            .real_bar = {0xff, 0xff, 0xff},
            .imaginary_bar = {0x54, 0xd6, 0xc2, 0xb0}};
}

/// Those of the same colours that stand out from white, the purple darkened, with black and a grey.
ThemeColors paper() {
    return {.ground = {{0xff, 0xff, 0xff}, {0xff, 0xff, 0xff}},
            .palette = {{0x00, 0x72, 0xb2},
                        {0xd5, 0x5e, 0x00},
                        {0x00, 0x00, 0x00},
                        {0x00, 0x9e, 0x73},
                        {0xca, 0x77, 0xa6},
                        {0x6c, 0x6c, 0x6c}},
            .support = {0x3a, 0x42, 0x52},
            .outline = {0x1c, 0x1f, 0x26},
            .pinned = {0xb0, 0x1c, 0x1c},
            .free = {0x30, 0x34, 0x3c},
            .real_bar = {0x1c, 0x1f, 0x26},
            .imaginary_bar = {0x1f, 0x9c, 0x8c, 0xb0}};
}

using Colors = std::array<Color, 9>;

constexpr Colors colors_of(const std::array<std::uint32_t, 9>& rgb) {
    Colors colors{};
    for (std::size_t i = 0; i < rgb.size(); ++i) {
        const auto part = [&](unsigned shift) { return static_cast<std::uint8_t>(rgb[i] >> shift); };
        colors[i] = {part(16), part(8), part(0)};
    }
    return colors;
}

// Our own, in B. Ottosson's colour space Oklab (2020): even steps of lightness, so that the colour-blind can
// read them, away from that of the theme's ground.

/// Lightness 0.64 to 0.95, violet, blue, green, yellow.
constexpr Colors kDark =
    colors_of({0x9074e9, 0x6791ff, 0x2faef7, 0x30c4dd, 0x2ed7c7, 0x34eaa7, 0x95f081, 0xcef368, 0xfff466});
/// 0.61 to 0.27, ochre, red, purple.
constexpr Colors kPaper =
    colors_of({0x9b8100, 0x9d6c01, 0x9c5601, 0x9b3d00, 0x9d0a00, 0x87012a, 0x710038, 0x57004b, 0x3a0056});
/// 0.90 and 0.88, 0.60 in the middle: blue, grey, orange.
constexpr Colors kDarkAboutZero =
    colors_of({0xb1e8fe, 0x65d6ff, 0x45bde7, 0x57a2be, 0x808080, 0xb78c5a, 0xdb9d4f, 0xfdae47, 0xfece96});
/// 0.33 and 0.38, 0.61 in the middle: blue, grey, brown.
constexpr Colors kPaperAboutZero =
    colors_of({0x002b81, 0x073da2, 0x2b57a9, 0x4e6da9, 0x838383, 0xa45c49, 0xa23b22, 0x932200, 0x791b01});

constexpr double kRare = 1.0 / 50.0;
constexpr double kFarBeyond = 2.0;
/// A scale extends below 0 if values do by more than this share of its end.
constexpr double kBelowZero = 0.02;
/// Smallest end of a scale; less is rounding.
constexpr double kMinEnd = 1e-12;
constexpr double kMinStrain = 1e-9;
/// Values that are less than this share of a given scale beyond its ends are not beyond them.
constexpr double kMinBeyond = 1e-6;

/// True if the background is light.
bool is_light(const StyleDef& style) {
    const Color text = text_color(theme_colors(style));
    return text.g < 128;
}

void set_ends(const Interval& range, const sim::Histogram& histogram, ColorScale& scale) {
    scale.low = range.low;
    scale.high = range.high;
    const double beyond = kMinBeyond * (scale.high - scale.low);
    scale.is_cut_low = histogram.least() < scale.low - beyond;
    scale.is_cut_high = histogram.largest() > scale.high + beyond;
}

void fit_ends(const sim::Histogram& histogram, ColorScale& scale) {
    double end = 1.0;
    const double smallest = scale.quantity == Quantity::kStrain ? kMinStrain : kMinEnd;
    if (!histogram.empty() && std::max(-histogram.least(), histogram.largest()) > smallest) {
        const double largest = std::max(-histogram.least(), histogram.largest());
        const double usual = histogram.size_exceeded_by(kRare);
        scale.is_cut_high = usual > smallest && largest > kFarBeyond * usual;
        end = std::min(scale.is_cut_high ? usual : largest, 1e300);
    }
    scale.high = rounded_end(end);
    if (!histogram.empty() && histogram.least() < -kBelowZero * scale.high) scale.low = -scale.high;
    scale.is_cut_low = scale.is_cut_high && scale.low < 0.0;
}

}  // namespace

double rounded_end(double value) {
    // One of them is 1, so that the result is rounded once.
    double power = 1.0;
    double inverse = 1.0;
    while (10.0 * power <= value) power *= 10.0;
    while (power / inverse > value) inverse *= 10.0;
    for (const double digit : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0}) {
        if (digit * power / inverse >= value) return digit * power / inverse;
    }
    return 10.0 * power / inverse;
}

ThemeColors theme_colors(const StyleDef& style) {
    ThemeColors theme = style.theme == Theme::kPaper ? paper() : dark();
    if (style.background) theme.ground = *style.background;
    if (!style.palette.empty()) theme.palette = style.palette;
    theme.pinned = style.pinned_color.value_or(theme.pinned);
    theme.free = style.free_color.value_or(theme.free);
    theme.real_bar = style.real_bar_color.value_or(theme.real_bar);
    theme.imaginary_bar = style.imaginary_bar_color.value_or(theme.imaginary_bar);
    return theme;
}

Color text_color(const ThemeColors& theme) {
    if (!theme.ground.is_opaque()) return theme.outline;
    const auto lightness = [](const Color& c) {
        return 299 * c.r + 587 * c.g + 114 * c.b;
    };  // Y', thousandths
    constexpr int kMiddle = 128'000;
    const bool is_light = lightness(theme.ground.top) + lightness(theme.ground.bottom) > 2 * kMiddle;
    return is_light ? Color{0x2a, 0x2f, 0x3a} : Color{0xd5, 0xdb, 0xe6};
}

Color arrow_color(const StyleDef& style) {
    return is_light(style) ? Color{0xa8, 0x12, 0x6e} : Color{0x7a, 0xf0, 0xb4};
}

Color ColorScale::color(double value) const {
    if (std::isnan(value)) return unknown;
    return mixed_color(colors, std::clamp((value - low) / (high - low), 0.0, 1.0));
}

Color mixed_color(std::span<const Color> colors, double share) {
    if (colors.size() == 1) return colors.front();
    const double place = share * static_cast<double>(colors.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(place), colors.size() - 2);
    // In 1/32 of the way, so that neighbours in a smooth picture often share one.
    const long part = std::lround(32.0 * (place - static_cast<double>(i)));
    const auto mixed = [&](int a, int b) {
        return static_cast<std::uint8_t>((a * (32 - part) + b * part + 16) / 32);
    };
    const Color& a = colors[i];
    const Color& b = colors[i + 1];
    return {mixed(a.r, b.r), mixed(a.g, b.g), mixed(a.b, b.b), mixed(a.a, b.a)};
}

ColorScale scale_of(Quantity quantity, const sim::Histogram& histogram, const StyleDef& style) {
    ColorScale scale;
    scale.quantity = quantity;
    scale.unknown = theme_colors(style).support;
    if (style.color_range)
        set_ends(*style.color_range, histogram, scale);
    else
        fit_ends(histogram, scale);
    const bool is_about_zero = scale.low == -scale.high;
    if (is_light(style))
        scale.colors = is_about_zero ? kPaperAboutZero : kPaper;
    else
        scale.colors = is_about_zero ? kDarkAboutZero : kDark;
    return scale;
}

double pose_opacity(std::size_t k, std::size_t count) {
    constexpr double kFirst = 0.2;
    constexpr double kSecondLast = 0.65;
    if (k + 1 == count) return 1.0;
    const double age = count < 3 ? 1.0 : static_cast<double>(k) / static_cast<double>(count - 2);
    return kFirst + (kSecondLast - kFirst) * age;
}

}  // namespace corda::view
