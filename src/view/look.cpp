#include "corda/view/look.hpp"

namespace corda::view {
namespace {

/// The colours of M. Okabe and K. Ito, Color Universal Design (2008), that stand out from a dark ground, and
/// white.
Look dark() {
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

/// Those of them that stand out from white, the purple a little darker, black and a grey between them.
Look paper() {
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

}  // namespace

Look look_of(const StyleDef& style) {
    Look look = style.theme == Theme::kPaper ? paper() : dark();
    if (style.background) look.ground = *style.background;
    if (!style.palette.empty()) look.palette = style.palette;
    look.pinned = style.pinned_color.value_or(look.pinned);
    look.free = style.free_color.value_or(look.free);
    look.real_bar = style.real_bar_color.value_or(look.real_bar);
    look.imaginary_bar = style.imaginary_bar_color.value_or(look.imaginary_bar);
    return look;
}

Color text_color(const Look& look) {
    if (!look.ground.is_opaque()) return look.outline;
    const auto lightness = [](const Color& c) {
        return 299 * c.r + 587 * c.g + 114 * c.b;
    };  // Y', thousandths
    constexpr int kMiddle = 128'000;
    const bool is_light = lightness(look.ground.top) + lightness(look.ground.bottom) > 2 * kMiddle;
    return is_light ? Color{0x2a, 0x2f, 0x3a} : Color{0xd5, 0xdb, 0xe6};
}

}  // namespace corda::view
