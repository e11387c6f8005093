#include <fmt/format.h>

#include <iterator>

#include "corda/core/basics.hpp"
#include "corda/core/text.hpp"
#include "corda/render/ground.hpp"
#include "corda/render/strokes.hpp"
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

std::string xml_text(std::string_view text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '&')
            escaped += "&amp;";
        else if (c == '<')
            escaped += "&lt;";
        else if (c == '>')  // of "]]>"
            escaped += "&gt;";
        else
            escaped += c;
    }
    return escaped;
}

/// To a hundredth of a pixel, without zeros that mean nothing.
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

/// ` NAME="SHARE"`; nothing for all.
std::string opacity(std::string_view name, const Color& color) {
    return color.a == 255 ? "" : fmt::format(R"( {}="{:.4g}")", name, color.a / 255.0);
}

void append_paths(const std::vector<Stroke>& strokes, std::string& text) {
    for (const Stroke& stroke : strokes) {
        fmt::format_to(std::back_inserter(text), R"(<path stroke-width="{}" d=")", number(stroke.width_px));
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
                            def.width_px, def.height_px, xml_text(def.title));
    }

    void draw(const view::DrawList& list, int x_px, int y_px) override {
        // An svg element in another one cuts off what is outside of it.
        text_ += fmt::format(R"(<svg x="{}" y="{}" width="{}" height="{}">)", x_px, y_px, list.width,
                             list.height) +
                 "\n";
        const std::string ground = draw_ground(list);
        std::string layers;
        for (std::size_t l = 0; l < list.layers.size(); ++l) {
            report_progress(def_.on_progress, static_cast<std::int64_t>(l),
                            static_cast<std::int64_t>(list.layers.size()));
            const view::Layer& layer = list.layers[l];
            const LayerStrokes strokes = strokes_of(list, layer);
            if (!strokes.halos.empty()) {
                if (list.ground.is_opaque())
                    append_group(ground, layer.color, strokes.halos, layers);
                else
                    cut_out(list, layer.color, strokes.halos, layers);
            }
            if (!strokes.lines.empty())
                append_group(opaque_text(layer.color), layer.color, strokes.lines, layers);
        }
        text_ += layers;
        append_stamps(list);
        text_ += "</svg>\n";
    }

    [[nodiscard]] std::string finish() override { return std::move(text_) + "</g>\n</svg>\n"; }

  private:
    /// Returns the paint of the ground.
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

    /// A group is united before its opacity counts.
    static void append_group(std::string_view paint, const Color& color, const std::vector<Stroke>& strokes,
                             std::string& layers) {
        layers += fmt::format(R"(<g stroke="{}"{}>)", paint, opacity("opacity", color)) + "\n";
        append_paths(strokes, layers);
        layers += "</g>\n";
    }

    /// Removes what is below halos.
    void cut_out(const view::DrawList& list, const Color& color, const std::vector<Stroke>& halos,
                 std::string& layers) {
        const std::string id = fmt::format("halo{}", ids_++);
        std::string mask =
            fmt::format(R"(<mask id="{}" maskUnits="userSpaceOnUse" x="0" y="0" width="{}" height="{}">)"
                        R"(<rect width="{}" height="{}" fill="#fff"/>)",
                        id, list.width, list.height, list.width, list.height);
        append_group("#000", color, halos, mask);
        layers = mask + fmt::format("</mask>\n<g mask=\"url(#{})\">\n", id) + layers + "</g>\n";
    }

    void append_stamps(const view::DrawList& list) {
        const auto out = std::back_inserter(text_);
        for (const view::Stamp& stamp : list.stamps) {
            if (stamp.first_coverage != view::Stamp::kSolid) continue;
            fmt::format_to(out, R"(<rect x="{}" y="{}" width="{}" height="{}" fill="{}"{}/>)", stamp.box.x0,
                           stamp.box.y0, stamp.box.width(), stamp.box.height(), opaque_text(stamp.color),
                           opacity("fill-opacity", stamp.color));
            text_ += "\n";
        }
        for (const view::Text& text : list.texts) {
            // Another font, if a reader does not have this one, takes as much room; one that does not know
            // textLength errs to both sides alike.
            const int width_px = font_.width_px(text.utf8, text.size_px);
            fmt::format_to(out,
                           R"(<text x="{}" y="{}" text-anchor="middle" textLength="{}" )"
                           R"(font-family="DejaVu Sans, sans-serif" font-size="{}" fill="{}"{} )"
                           R"(xml:space="preserve">{}</text>)",
                           number(text.x_px + 0.5 * width_px), text.y_px, width_px, text.size_px,
                           opaque_text(text.color), opacity("fill-opacity", text.color),
                           xml_text(printable(text.utf8)));
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
