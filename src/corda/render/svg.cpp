#include <fmt/format.h>

#include <iterator>
#include <span>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/markup.hpp"
#include "corda/core/text.hpp"
#include "corda/render/paint.hpp"
#include "corda/render/vector.hpp"
#include "corda/view/font.hpp"

namespace corda::render {
namespace {

constexpr std::string_view kHead =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<svg xmlns="http://www.w3.org/2000/svg" width="{:.6g}mm" height="{:.6g}mm" viewBox="0 0 {} {}">
<title>{}</title>
<g fill="none" stroke-linecap="round" stroke-linejoin="round">
)";

/// Rounds to a hundredth of a pixel, without trailing zeros.
std::string number(double value) {
    std::string text = fmt::format("{:.2f}", value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text == "-0" ? "0" : text;
}

std::string opaque_text(Color color) {
    color.a = 255;
    return color.text();
}

/// ` NAME="SHARE"`; empty if the colour is opaque.
std::string opacity(std::string_view name, const Color& color) {
    return color.a == 255 ? "" : fmt::format(R"( {}="{:.4g}")", name, color.a / 255.0);
}

/// `is_tinted`: gives each path its own colour.
void append_paths(const std::vector<Stroke>& strokes, bool is_tinted, std::string& text) {
    for (const Stroke& stroke : strokes) {
        const std::string color = is_tinted ? fmt::format(R"( stroke="{}")", stroke.color.text()) : "";
        fmt::format_to(std::back_inserter(text), R"(<path{}{} stroke-width="{}" d=")", color,
                       stroke.is_blunt ? R"( stroke-linecap="butt")" : "", number(stroke.width_px));
        for (const auto& line : stroke.lines) {
            for (std::size_t i = 0; i < line.size(); ++i)
                fmt::format_to(std::back_inserter(text), "{}{} {}",
                               i == 0   ? "M"
                               : i == 1 ? "L"
                                        : " ",
                               number(line[i].x), number(line[i].y));
        }
        text += "\"/>\n";
    }
}

class Svg : public VectorPage {
  public:
    explicit Svg(const PageDef& def) : def_(def) {
        text_ = fmt::format(fmt::runtime(kHead), def.width_mm, def.width_mm * def.height_px / def.width_px,
                            def.width_px, def.height_px, markup_text(printable(def.title)));
    }

    void draw(const view::DrawList& given, int x_px, int y_px) override {
        const view::DrawList list = in_even_layers(given);
        // A nested svg element clips its contents.
        text_ += fmt::format(R"(<svg x="{}" y="{}" width="{}" height="{}">)", x_px, y_px, list.width,
                             list.height) +
                 "\n";
        const std::string ground = draw_ground(list);
        std::vector<LayerText> layers;
        for (std::size_t l = 0; l < list.layers.size(); ++l) {
            check_cancelled();
            layers.push_back(text_of(list, list.layers[l], ground));
        }
        append_layers(layers, list);
        append_stamps(list);
        text_ += "</svg>\n";
    }

    [[nodiscard]] std::string finish() override { return std::move(text_) + "</g>\n</svg>\n"; }

  private:
    /// Returns the ground as a value of `stroke`.
    std::string draw_ground(const view::DrawList& list) {
        const auto [top, bottom] = straight_ends(list.ground);
        const bool is_gradient = top != bottom;
        std::string paint = opaque_text(top);
        if (is_gradient) {
            const std::string id = fmt::format("ground{}", ids_++);
            text_ += fmt::format(R"(<linearGradient id="{}" gradientUnits="userSpaceOnUse" )"
                                 R"(x1="0" y1="0" x2="0" y2="{}">)"
                                 R"(<stop stop-color="{}"{}/><stop offset="1" stop-color="{}"{}/>)"
                                 "</linearGradient>\n",
                                 id, list.height, opaque_text(top), opacity("stop-opacity", top),
                                 opaque_text(bottom), opacity("stop-opacity", bottom));
            paint = fmt::format("url(#{})", id);
        }
        if (top.a != 0 || bottom.a != 0)
            text_ += fmt::format(R"(<rect width="{}" height="{}" fill="{}"{}/>)", list.width, list.height,
                                 paint, is_gradient ? "" : opacity("fill-opacity", top)) +
                     "\n";
        return paint;
    }

    /// A group: opacity applies to the union of its strokes.
    static void append_group(std::string_view paint, const Color& color, const std::vector<Stroke>& strokes,
                             bool is_tinted, std::string& layers) {
        layers += fmt::format(R"(<g stroke="{}"{}>)", paint, opacity("opacity", color)) + "\n";
        append_paths(strokes, is_tinted, layers);
        layers += "</g>\n";
    }

    struct LayerText {
        std::string lines;
        std::string halo_id;  ///< id of the shape that it cuts out of the layers below; empty: none
    };

    LayerText text_of(const view::DrawList& list, const view::Layer& layer, const std::string& ground) {
        const LayerStrokes strokes = strokes_of(list, layer);
        LayerText text;
        if (!strokes.halos.empty() && list.ground.is_opaque()) {
            append_group(ground, layer.color, strokes.halos, false, text.lines);
        } else if (!strokes.halos.empty()) {
            text.halo_id = fmt::format("halo{}", ids_++);
            text_ += fmt::format("<defs><g id=\"{}\">\n", text.halo_id);
            append_group("#000", layer.color, strokes.halos, false, text_);
            text_ += "</g></defs>\n";
        }
        if (!strokes.lines.empty())
            append_group(opaque_text(layer.color), layer.color, strokes.lines, layer.is_tinted, text.lines);
        return text;
    }

    /// Appends layers, each of which cuts its halo out of all layers below. The lower half is drawn through a
    /// mask of the halos of the upper half, recursively in both, so groups nest only log2(n) deep: viewers
    /// fail at some hundred levels.
    void append_layers(std::span<const LayerText> layers, const view::DrawList& list) {
        if (layers.empty()) return;
        if (layers.size() == 1) {
            text_ += layers.front().lines;
            return;
        }
        const auto lower = layers.first(layers.size() / 2);
        const auto upper = layers.subspan(lower.size());
        std::string halos;
        for (const LayerText& layer : upper) {
            if (!layer.halo_id.empty()) halos += fmt::format("<use href=\"#{}\"/>\n", layer.halo_id);
        }
        if (!halos.empty()) {
            const std::string id = fmt::format("mask{}", ids_++);
            text_ +=
                fmt::format(R"(<mask id="{}" maskUnits="userSpaceOnUse" x="0" y="0" width="{}" height="{}">)"
                            R"(<rect width="{}" height="{}" fill="#fff"/>)"
                            "\n{}</mask>\n<g mask=\"url(#{})\">\n",
                            id, list.width, list.height, list.width, list.height, halos, id);
        }
        append_layers(lower, list);
        if (!halos.empty()) text_ += "</g>\n";
        append_layers(upper, list);
    }

    void append_stamps(const view::DrawList& list) {
        const auto out = std::back_inserter(text_);
        for (const view::Stamp& stamp : boxes_of(list)) {
            fmt::format_to(out, R"(<rect x="{}" y="{}" width="{}" height="{}" fill="{}"{}/>)", stamp.box.x0,
                           stamp.box.y0, stamp.box.width(), stamp.box.height(), opaque_text(stamp.color),
                           opacity("fill-opacity", stamp.color));
            text_ += "\n";
        }
        for (const view::Text& text : list.texts) {
            // textLength gives a substitute font the same width. Without support for it, a centred text
            // errs equally on both sides.
            const int width_px = font_.width_px(text.utf8, text.size_px);
            std::string families = "DejaVu Sans";
            for (const view::FallbackFont* const font : view::fallback_fonts({text.utf8}))
                families += ", " + markup_text(font->family);
            fmt::format_to(out,
                           R"(<text x="{}" y="{}" text-anchor="middle" textLength="{}" )"
                           R"(font-family="{}, sans-serif" font-size="{}" fill="{}"{} )"
                           R"(xml:space="preserve">{}</text>)",
                           number(text.x_px + 0.5 * width_px), text.y_px, width_px, families, text.size_px,
                           opaque_text(text.color), opacity("fill-opacity", text.color),
                           markup_text(printable(text.utf8)));
            text_ += "\n";
        }
    }

    PageDef def_;
    view::Font font_;
    std::string text_;
    int ids_ = 0;
};

}  // namespace

std::unique_ptr<VectorPage> make_svg(const PageDef& def) {
    return std::make_unique<Svg>(def);
}

}  // namespace corda::render
