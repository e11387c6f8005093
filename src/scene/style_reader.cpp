#include <fmt/format.h>

#include <array>

#include "corda/scene/readers.hpp"

namespace corda::scene {
namespace {

constexpr std::string_view kWidthRemedy = "give a width in pixels, 0.1 .. 1000";

void read_background(const TableReader& style, Color& background) {
    const auto value = style.find("background");
    if (!value) return;
    const Color color = value->color();
    if (color.a != 255) {
        value->fail(fmt::format("\"{}\" is not opaque; leave out the last two digits", color.text()));
    }
    background = color;
}

void read_palette(const TableReader& style, std::vector<Color>& palette) {
    constexpr std::string_view kRemedy = "give a list of 1 .. 64 colours";
    constexpr std::size_t kMostColors = 64;
    const auto value = style.find("palette");
    if (!value) return;
    const std::size_t count = value->size(kRemedy);
    if (count == 0) value->fail(fmt::format("the list is empty; {}", kRemedy));
    if (count > kMostColors) {
        value->fail(fmt::format("{} colours are over the limit of {}; {}", count, kMostColors, kRemedy));
    }
    palette.clear();
    for (std::size_t i = 0; i < count; ++i) palette.push_back(value->at(i).color());
}

}  // namespace

view::StyleDef read_style(const TableReader& style) {
    // In the order of the enums.
    constexpr std::array<std::string_view, 3> kMarkers{"none", "pinned", "all"};
    constexpr std::array<std::string_view, 3> kBars{"none", "real", "all"};
    view::StyleDef def;
    read_background(style, def.background);
    read_palette(style, def.palette);
    style.read_number("rope_width_px", def.rope_width_px, kWidthPx, kWidthRemedy);
    if (const auto markers = style.find("markers")) {
        def.markers = static_cast<view::Markers>(markers->choice(kMarkers));
    }
    style.read_number("marker_radius_px", def.marker_radius_px, kWidthPx,
                      "give a radius in pixels, 0.1 .. 1000");
    style.read_color("pinned_color", def.pinned_color);
    style.read_color("free_color", def.free_color);
    if (const auto bars = style.find("bars")) def.bars = static_cast<view::Bars>(bars->choice(kBars));
    style.read_number("bar_width_px", def.bar_width_px, kWidthPx, kWidthRemedy);
    style.read_color("real_bar_color", def.real_bar_color);
    style.read_color("imaginary_bar_color", def.imaginary_bar_color);
    return def;
}

view::CameraDef read_camera(const TableReader& camera) {
    view::CameraDef def;
    if (const auto center = camera.find("center")) {
        def.center_m = center->pair(kCoordinate, "give a centre as [x, y] in m");
    }
    camera.read_number("height", def.height_m, {.low = 1e-9, .high = 4 * Limits::kCoordinateMetres},
                       "give a height in m, > 0");
    camera.read_number("margin", def.margin, {.low = 0.0, .high = 0.45},
                       "give a share of the picture, 0 .. 0.45");
    return def;
}

view::BodyStyleDef read_body_style(const TableReader& rope) {
    view::BodyStyleDef def;
    if (const auto color = rope.find("color")) def.color = color->color();
    rope.read_number("width_px", def.width_px, kWidthPx, kWidthRemedy);
    return def;
}

}  // namespace corda::scene
