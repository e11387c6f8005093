#include <fmt/format.h>

#include <algorithm>

#include "corda/core/image.hpp"
#include "corda/media/format/format.hpp"
#include "corda/scene/rows.hpp"

namespace corda::scene {
namespace {

/// A picture size, in two members.
template <class Def>
Binding size_field() {
    return custom_field<Def>(
        [](const Value& value, Def& def) {
            if (value.is_list()) {
                def.width_px = value.at(0).as<int>();
                def.height_px = value.at(1).as<int>();
                return;
            }
            const auto named = std::ranges::find_if(
                kNamedSizes,
                [name = value.as<std::string_view>()](const NamedSize& size) { return size.name == name; });
            def.width_px = named->width_px;
            def.height_px = named->height_px;
        },
        [](const Def& def) {
            return toml_text(std::vector<int>{def.width_px, def.height_px});
        });
}

Type picture_size() {
    Type size = pair("[width, height]", {.low = 1, .high = kMaxSidePx});
    size.kind = Kind::kInteger;
    for (const NamedSize& named : kNamedSizes) size.names.push_back(named.name);
    return size;
}

template <class T>
Binding encoder(T EncoderDef::*member) {
    return field_at<VideoDef>([member](auto& def) -> auto& { return def.encoder.*member; });
}

std::vector<Key> video_keys() {
    const std::vector<std::string_view> presets = media::preset_names();
    static const std::string size_note =
        fmt::format("even for a video in 4:2:0; {} pixels in all at most", kMaxPicturePx);
    return {
        {"video", "size", picture_size(), "px", size_field<VideoDef>(), "the size of the picture", size_note},
        {"video", "fps", of(Kind::kFraction, {.low = 1e-3, .high = 1e5}), "1/s", field(&VideoDef::fps),
         "the frames per second", "up to three decimals; 29.97 is \"30000/1001\""},
        {"video", "speed", of(Kind::kFraction, {.low = 1e-6, .high = 1e6}), "", field(&VideoDef::speed),
         "the seconds of the scene per second of the video",
         "\"1/4\" is slow motion; times, plots and the shutter are those of the scene"},
        {"video", "shutter", number({.low = 0.0, .high = 1.0}), "", field(&VideoDef::shutter),
         "how long a frame is exposed, as a share of the time from frame to frame",
         "for motion blur in videos; the exposure is centred on the frame's time"},
        {"video", "subframes", integer(2, VideoDef::kMaxSubframes), "", field(&VideoDef::subframes),
         "the number of pictures that a blurred frame is the mean of"},
        {"video", "loop", integer(0, VideoDef::kMaxLoop), "", field(&VideoDef::loop),
         "how often a .gif plays", "0: for ever; only for a .gif"},
        {"video", "hold", number({.low = 0.0, .high = VideoDef::kMaxHoldS}), "s", field(&VideoDef::hold_s),
         "how long the last picture stays at the end of a video", "not of a sequence of pictures"},
        {"video", "codec", one_of(media::codec_names()), "",
         otherwise("the ending's", encoder(&EncoderDef::codec)), "the encoder",
         "h264, h265, av1, vp9 and so on stand for libav's names"},
        {"video", "preset", one_of({presets.begin(), presets.end()}), "",
         otherwise("the encoder's", encoder(&EncoderDef::preset)),
         "how long the encoder searches for a smaller file",
         "words of H.264 and H.265; AV1 and VP9 count from 0, the slowest; the others have none"},
        {"video", "crf", integer(1, EncoderDef::kMaxCrf), "",
         otherwise("the encoder's", encoder(&EncoderDef::crf)),
         "the constant rate factor (H.264, H.265: up to 51)", "1 is the best"},
        {"video", "pix", one_of({"auto", "420", "444", "rgba"}), "", encoder(&EncoderDef::pix),
         "how pixels are stored",
         "444 sharpens coloured edges; browsers and QuickTime do not play it in H.264"},
        {"video", "threads", integer(1, EncoderDef::kMaxThreads), "", encoder(&EncoderDef::threads),
         "the number of threads of the encoder", "the bytes depend on it"},
        {"video", "jobs", integer(0, EncoderDef::kMaxThreads), "", encoder(&EncoderDef::jobs),
         "the number of threads that draw frames", "0: one per core; the bytes do not depend on it"},
    };
}

std::vector<Key> style_keys() {
    Type particles = list(Kind::kInteger, 1);
    particles.range = {.low = -kMaxParticles, .high = kMaxParticles - 1};
    const Type boolean = of(Kind::kBoolean);
    const auto of_theme = [](const Binding& binding) { return otherwise("the theme's", binding); };
    return {
        {"style", "theme", one_of({"dark", "paper"}), "",
         with_default(toml_text("dark"), field(&StyleDef::theme)), "the colours",
         "every one below overrides it"},
        {"style", "background", or_pair(of(Kind::kColor), "[top, bottom]"), "",
         of_theme(field(&StyleDef::background)), "the background",
         "with alpha for .png, .svg, .pdf and videos with alpha"},
        {"style", "palette", list(Kind::kColor, 1), "", of_theme(field(&StyleDef::palette)),
         "the colours that ropes, then nets take in turn", "those that are merged, as copies, in a gradient"},
        {"style", "color_by", one_of({"body", "tension", "speed", "strain", "link"}), "",
         field(&StyleDef::color_by), "what colours tell",
         "tension, speed and strain of each link by one scale for the whole film; link: the list in color"},
        {"style", "color_range", pair("[low, high]", kValue), "N or m/s",
         otherwise("from the whole motion", field(&StyleDef::color_range)),
         "the ends of the scale of colours",
         "a strain is a bare number; values beyond have the colours of the ends"},
        {"style", "arrows", one_of({"none", "velocity", "tension", "weight"}), "", field(&StyleDef::arrows),
         "arrows at particles", "one scale for the whole film; a rope or net of many particles has some"},
        {"style", "arrow_scale", number({.low = 1e-12, .high = 1e12}), "px",
         otherwise("from the largest arrows", field(&StyleDef::arrow_scale_px)),
         "the length of an arrow per m/s or N", "arrows longer than half of the shorter side are cut"},
        {"style", "rope_width_px", number(kWidthPx), "px",
         otherwise("shorter side / 120, at least 2", field(&StyleDef::rope_width_px)), "the width of ropes"},
        {"style", "net_width_px", number(kWidthPx), "px",
         otherwise("half of ropes, at least 2", field(&StyleDef::net_width_px)),
         "the width of the threads of nets"},
        {"style", "payload", boolean, "", field(&StyleDef::payload), "payloads are balls",
         "and so is every mass of ropes of up to 3 links"},
        {"style", "payload_radius", number({.low = 1e-9, .high = 1e9}), "m",
         otherwise("by the mass, as a share of the picture", field(&StyleDef::payload_radius_m)),
         "the radius of these balls", "they are at least a little wider than the rope"},
        {"style", "supports", boolean, "", field(&StyleDef::supports), "pinned particles hang from plates",
         "from rings if something rises above them"},
        {"style", "halo", boolean, "", field(&StyleDef::halo), "a gap parts crossing bodies"},
        {"style", "trail_s", number({.low = 0.0, .high = 3600.0}), "s", field(&StyleDef::trail_s),
         "the time for which the path of a particle stays", "it fades; 0: not at all"},
        {"style", "trail_of", particles, "",
         otherwise("the free end of each rope", field(&StyleDef::trail_of)),
         "the indices of the particles with a path, in each rope and net",
         "negative ones count from the end"},
    };
}

std::vector<Key> marker_and_bar_keys() {
    const Type color = of(Kind::kColor);
    const auto of_theme = [](const Binding& binding) { return otherwise("the theme's", binding); };
    return {
        {"style", "markers", one_of({"none", "pinned", "all"}), "", field(&StyleDef::markers),
         "the particles with a marker"},
        {"style", "marker_radius_px", number(kWidthPx), "px",
         otherwise("grows with the width of the rope", field(&StyleDef::marker_radius_px)),
         "the radius of markers"},
        {"style", "pinned_color", color, "", of_theme(field(&StyleDef::pinned_color)),
         "the markers of pinned particles"},
        {"style", "free_color", color, "", of_theme(field(&StyleDef::free_color)),
         "the markers of free particles"},
        {"style", "bars", one_of({"none", "real", "all"}), "", field(&StyleDef::bars),
         "the bars that are drawn apart"},
        {"style", "bar_width_px", number(kWidthPx), "px",
         otherwise("a quarter of the width of ropes", field(&StyleDef::bar_width_px)), "the width of bars"},
        {"style", "real_bar_color", color, "", of_theme(field(&StyleDef::real_bar_color)),
         "the bars between neighbours"},
        {"style", "imaginary_bar_color", color, "", of_theme(field(&StyleDef::imaginary_bar_color)),
         "the longer bars"},
    };
}

Type live_plots() {
    Type type = list(Kind::kChoice, 0);
    type.choices = {"energy", "angle", "phase", "divergence", "tip"};
    return type;
}

std::vector<Key> overlay_keys() {
    const Type boolean = of(Kind::kBoolean);
    const auto if_large = [](std::optional<bool> OverlayDef::*member) {
        return otherwise("true on an opaque background, from a shorter side of 160 px on", field(member));
    };
    return {
        {"overlay", "time", boolean, "", if_large(&OverlayDef::time), "the time, at the lower left"},
        {"overlay", "scale_bar", boolean, "", if_large(&OverlayDef::scale_bar),
         "a scale bar, at the lower right"},
        {"overlay", "legend", boolean, "", if_large(&OverlayDef::legend),
         "the scales of style.color_by, at the upper right, and of style.arrows, at the lower right"},
        {"overlay", "title", of(Kind::kText), "", field(&OverlayDef::title), "the title, at the upper left",
         "in up to three lines; shortened if it is too long"},
        {"overlay", "font", of(Kind::kText), "", field(&OverlayDef::font),
         "the font of title, texts and labels: a .ttf or .otf file",
         "relative to the scene's folder; DejaVu Sans without it"},
        {"overlay", "energy", boolean, "", field(&OverlayDef::energy),
         "the error of the energy, next to the time", "left out if there is no room"},
        {"overlay", "method", boolean, "", field(&OverlayDef::method),
         "the method and its error estimate, below the title"},
        {"overlay", "plots", live_plots(), "", field(&OverlayDef::plots), "live plots next to the picture",
         "over time: energies, angles of ropes, distance of the tips of ropes 0 and 1, x and y of the first "
         "tip; phase: angular velocity against angle"},
        {"overlay", "plot_range", of(Kind::kTable), "", none(),
         "plot_range = { energy = [-10.0, 10.0], angle = [-90.0, 90.0] }",
         "the ends of the value axes of plots; curves are cut there"},
        {"overlay", "energy_zero", one_of({"start", "lowest"}), "", field(&OverlayDef::energy_zero),
         "where the potential energy of plots and texts is 0",
         "at the start, or where it is lowest during the motion"},
        {"overlay", "language", one_of({"en", "de", "pt", "es", "fr"}), "", field(&OverlayDef::language),
         "the language of words and the decimal sign", "in plots and reports too"},
        {"overlay", "texts", of(Kind::kTables), "", none(),
         "texts = [{ text = \"released\", at = [0.5, 0.1], from = 0.0, to = 1.5 }]",
         "texts in the picture, for a time each"},
        {"overlay", "text_px", number({.low = 4.0, .high = 400.0}), "px",
         otherwise("shorter side / 40, at least readable", field(&OverlayDef::text_px)),
         "the size of the words at the edges", "and of those of plots, as far as they have room"},
    };
}

std::vector<Key> plot_range_keys() {
    const auto row = [](LivePlot plot, const char* name, const char* unit, const char* meaning,
                        const char* note = "") {
        const bool is_log = plot == LivePlot::kDivergence;
        return Key{"overlay.plot_range",
                   name,
                   pair("[low, high]", is_log ? Range{.low = 1e-100, .high = kValue.high} : kValue),
                   unit,
                   otherwise("from the whole motion", field_at<PlotRangesDef>([plot](auto& def) -> auto& {
                                 return def.of[static_cast<std::size_t>(plot)];
                             })),
                   meaning,
                   note};
    };
    return {
        row(LivePlot::kEnergy, "energy", "J", "the energies"),
        row(LivePlot::kAngle, "angle", "degrees", "the angles", "those of the plot phase too"),
        row(LivePlot::kPhase, "phase", "rad/s", "the angular velocities"),
        row(LivePlot::kDivergence, "divergence", "m", "the distances", "rounded outwards to powers of 10"),
        row(LivePlot::kTip, "tip", "m", "the positions")};
}

std::vector<Key> overlay_text_keys() {
    const std::string_view section = "overlay.texts";
    return {
        {section, "text", of(Kind::kText), "", required(field(&OverlayTextDef::text)), "the text"},
        {section, "at", pair("[x, y]", {.low = 0.0, .high = 1.0}), "", field(&OverlayTextDef::at),
         "the place of its middle", "shares of the picture, from its upper left"},
        {section, "from", number(kFrom0), "s", field(&OverlayTextDef::from_s), "when it appears"},
        {section, "to", number(kFrom0), "s", otherwise("the end", field(&OverlayTextDef::to_s)),
         "when it disappears"},
        {section, "fade", number(kFrom0), "s", field(&OverlayTextDef::fade_s),
         "how long it takes to appear, and before `to` to disappear"},
        {section, "size", number({.low = 4.0, .high = 400.0}), "px",
         otherwise("overlay.text_px", field(&OverlayTextDef::size_px)), "the size of its letters"},
        {section, "color", of(Kind::kColor), "", otherwise("the theme's", field(&OverlayTextDef::color)),
         "the colour"},
    };
}

/// The word for the free end of a rope, or an index.
Binding followed() {
    return custom_field<CameraDef>(
        [](const Value& value, CameraDef& def) {
            def.follow = value.node().is_string() ? CameraDef::kTip : value.as<int>();
        },
        [](const CameraDef& def) -> std::string {
            if (!def.follow) return "";
            return *def.follow == CameraDef::kTip ? toml_text("tip") : toml_text(*def.follow);
        });
}

std::vector<Key> camera_keys() {
    Type follow = integer(0, 2 * kMaxParticles);
    follow.names = {"tip"};
    const auto fitted = [](const Binding& binding) { return otherwise("fits the whole motion", binding); };
    return {
        {"camera", "center", pair("[x, y]", kCoordinate), "m", fitted(field(&CameraDef::center_m)),
         "the position in the middle of the picture"},
        {"camera", "height", number({.low = 1e-9, .high = 4 * Limits::kCoordinateMetres}), "m",
         fitted(field(&CameraDef::height_m)), "the height of the picture"},
        {"camera", "margin", number({.low = 0.0, .high = 0.45}), "", field(&CameraDef::margin),
         "the share of the shorter side left free at each edge"},
        {"camera", "follow", follow, "", otherwise("the camera stays", followed()),
         "the index of the rope or net that stays in the middle", "nets after ropes; in place of center"},
        {"camera", "path", of(Kind::kTables), "", none(),
         "path = [{ t = 0.0, height = 3.0 }, { t = 2.0, center = [1.0, -1.0], height = 1.0 }]",
         "the camera moves smoothly from key to key"},
    };
}

std::vector<Key> camera_path_keys() {
    const std::string_view section = "camera.path";
    return {
        {section, "t", number(kFrom0), "s", required(field(&CameraKeyDef::time_s)), "the time of the key"},
        {section, "center", pair("[x, y]", kCoordinate), "m",
         otherwise("camera.center", field(&CameraKeyDef::center_m)),
         "the position in the middle of the picture"},
        {section, "height", number({.low = 1e-9, .high = 4 * Limits::kCoordinateMetres}), "m",
         otherwise("camera.height", field(&CameraKeyDef::height_m)), "the height of the picture"},
    };
}

std::vector<Key> golden_keys() {
    Type times = list(Kind::kNumber, 1);
    times.range = kFrom0;
    const auto limit = [](const char* name, double low, double high, auto member, const char* meaning,
                          const char* note) {
        return Key{"golden",
                   name,
                   number({.low = low, .high = high}),
                   "",
                   otherwise("no limit; without any, only equal pictures pass", field(member)),
                   meaning,
                   note};
    };
    return {
        {"golden", "at", times, "s", required(field(&GoldenDef::at_s)), "the times of the pictures",
         "increasing, none after world.duration"},
        {"golden", "size", picture_size(), "px", size_field<GoldenDef>(), "the size of the pictures",
         "widths in px stay as they are, as with --size"},
        limit("max", 0.0, 255.0, &GoldenDef::max, "the largest difference of a channel that passes", ""),
        limit("mean", 0.0, 255.0, &GoldenDef::mean, "the mean difference of all channels that passes", ""),
        limit("share", 0.0, 1.0, &GoldenDef::share, "the share of differing pixels that passes",
              "given without golden.max it bounds the share alone"),
        {"golden", "mask", of(Kind::kText), "", field(&GoldenDef::mask),
         "a PNG of this size whose black pixels are not compared", "relative to the scene's folder"},
    };
}

}  // namespace

std::vector<Key> picture_rows() {
    std::vector<Key> rows;
    for (const std::vector<Key>& part :
         {video_keys(), style_keys(), marker_and_bar_keys(), overlay_keys(), plot_range_keys(),
          overlay_text_keys(), camera_keys(), camera_path_keys(), golden_keys()})
        rows.insert(rows.end(), part.begin(), part.end());
    return rows;
}

}  // namespace corda::scene
