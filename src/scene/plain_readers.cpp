// The tables whose keys stand for themselves: what the list of keys (keys.hpp) says is all there is to check.
#include <fmt/format.h>

#include "corda/core/image.hpp"
#include "corda/scene/rate.hpp"
#include "corda/scene/readers.hpp"
#include "corda/view/validate.hpp"

namespace corda::scene {

WorldDef read_world(const TableReader& world) {
    WorldDef def;
    if (const auto gravity = world.find("gravity")) {
        // 0 - g and not -g: no gravity is +0.
        def.gravity_m_s2 = gravity->is_list() ? gravity->as<Vec2>() : Vec2{0.0, 0.0 - gravity->as<double>()};
    }
    world.read("duration", def.duration_s);
    world.read("drag", def.drag_1_s);
    return def;
}

VideoDef read_video(const TableReader& video) {
    VideoDef def;
    if (const auto size = video.find("size")) {
        def.width_px = size->at(0).as<int>();
        def.height_px = size->at(1).as<int>();
        const std::int64_t pixels = std::int64_t{def.width_px} * def.height_px;
        if (pixels > kMaxPicturePx)
            size->add_problem(fmt::format("{} x {} are {} pixels, over the limit of {}; give a smaller size",
                                          def.width_px, def.height_px, pixels, kMaxPicturePx));
    }
    if (const auto fps = video.find("fps")) def.fps = FrameRate(std::get<Rational>(read_rate(fps->node())));
    video.read("shutter", def.shutter);
    video.read("subframes", def.subframes);
    video.read("codec", def.encoder.codec);
    video.read("preset", def.encoder.preset);
    video.read("crf", def.encoder.crf);
    video.read("pix", def.encoder.pix);
    video.read("threads", def.encoder.threads);
    video.read("jobs", def.encoder.jobs);
    return def;
}

StyleDef read_style(const TableReader& style) {
    StyleDef def;
    style.read("theme", def.theme);
    if (const auto ground = style.find("background")) {
        const bool is_pair = ground->is_list();
        def.background = Ground{(is_pair ? ground->at(0) : *ground).as<Color>(),
                                (is_pair ? ground->at(1) : *ground).as<Color>()};
    }
    if (const auto palette = style.find("palette")) {
        for (std::size_t i = 0; i < palette->size(); ++i) def.palette.push_back(palette->at(i).as<Color>());
    }
    style.read("color_by", def.color_by);
    style.read("rope_width_px", def.rope_width_px);
    style.read("net_width_px", def.net_width_px);
    style.read("payload", def.payload);
    style.read("supports", def.supports);
    style.read("halo", def.halo);
    style.read("trail_s", def.trail_s);
    style.read("markers", def.markers);
    style.read("marker_radius_px", def.marker_radius_px);
    style.read("pinned_color", def.pinned_color);
    style.read("free_color", def.free_color);
    style.read("bars", def.bars);
    style.read("bar_width_px", def.bar_width_px);
    style.read("real_bar_color", def.real_bar_color);
    style.read("imaginary_bar_color", def.imaginary_bar_color);
    return def;
}

OverlayDef read_overlay(const TableReader& overlay) {
    OverlayDef def;
    overlay.read("time", def.time);
    overlay.read("scale_bar", def.scale_bar);
    overlay.read("legend", def.legend);
    overlay.read("title", def.title);
    if (const std::string missing = view::missing_glyph(def.title); !missing.empty())
        overlay.find("title")->add_problem(missing);
    overlay.read("energy", def.energy);
    overlay.read("method", def.method);
    overlay.read("plot", def.plot);
    overlay.read("text_px", def.text_px);
    return def;
}

CameraDef read_camera(const TableReader& camera) {
    CameraDef def;
    camera.read("center", def.center_m);
    camera.read("height", def.height_m);
    camera.read("margin", def.margin);
    return def;
}

GoldenDef read_golden(const Sections& sections) {
    const TableReader& golden = sections.golden;
    GoldenDef def;
    if (!golden.is_given("at")) golden.add_missing("at");
    const auto times = golden.find("at");
    for (std::size_t i = 0; times && i < times->size(); ++i) {
        const double at_s = times->at(i).as<double>();
        if (!def.at_s.empty() && at_s <= def.at_s.back())
            times->at(i).add_problem(
                fmt::format("{} s after {} s; give times that increase", at_s, def.at_s.back()));
        def.at_s.push_back(at_s);
    }
    if (const auto size = golden.find("size")) {
        def.width_px = size->at(0).as<int>();
        def.height_px = size->at(1).as<int>();
        if (!is_picture_size(def.width_px, def.height_px))
            size->add_problem(fmt::format("over the limit of {} pixels; give a smaller size", kMaxPicturePx));
    }
    golden.read("max", def.max);
    golden.read("share", def.share);
    return def;
}

BodyStyleDef read_body_style(const TableReader& body, bool takes_link_colors) {
    BodyStyleDef def;
    if (const auto color = body.find("color"); color && color->is_list()) {
        for (std::size_t i = 0; i < color->size(); ++i) {
            def.link_colors.push_back(color->at(i).as<Color>());
            if (def.link_colors.back().a != def.link_colors.front().a)
                color->at(i).add_problem(
                    "another alpha than that of the first link; give all links the same");
        }
        if (!takes_link_colors)
            color->add_problem(
                "a list of colours is for links in turn; set style.color_by = \"link\", or give one colour");
    } else if (color) {
        def.color = color->as<Color>();
    }
    body.read("width_px", def.width_px);
    return def;
}

}  // namespace corda::scene
