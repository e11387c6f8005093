#include "corda/scene/keys.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <type_traits>

#include "corda/core/image.hpp"
#include "corda/media/format/format.hpp"
#include "corda/scene/readers.hpp"

namespace corda::scene {
namespace {

using Words = std::vector<std::string_view>;

constexpr Range kAny{};
constexpr Range kAbove0{.low = 0.0, .low_open = true};
constexpr Range kFrom0{.low = 0.0};
constexpr Range kCoordinate{.low = -Limits::kCoordinateMetres, .high = Limits::kCoordinateMetres};
constexpr Range kDistance{.low = kMinBarMetres, .high = Limits::kCoordinateMetres};
constexpr Range kLength{.low = kMinBarMetres, .high = 4 * Limits::kCoordinateMetres};
constexpr Range kMass{.low = 1e-12, .high = 1e12};
constexpr Range kWidthPx{.low = 0.1, .high = 1000.0};
constexpr double kMaxParticles = Limits::kParticles;

Type of(Kind kind, const Range& range = kAny) {
    return {.kind = kind, .range = range};
}

Type number(const Range& range = kAny) {
    return of(Kind::kNumber, range);
}

Type integer(double low, double high) {
    return {.kind = Kind::kInteger, .range = {.low = low, .high = high}};
}

Type one_of(Words words, Kind kind = Kind::kChoice) {
    return {.kind = kind, .choices = std::move(words)};
}

Type pair(std::string_view words, const Range& range) {
    return {.forms = kPair, .range = range, .pair = words};
}

/// One value, or a pair.
Type or_pair(Type type, std::string_view words) {
    type.forms |= kPair;
    type.pair = words;
    return type;
}

/// What `type` is, or a list of that.
Type or_list(Type type, std::string_view words) {
    type.forms |= type.forms == kPair ? kPairs : kList;
    type.list = words;
    return type;
}

Type list(Kind kind, std::size_t least) {
    return {.kind = kind, .forms = kList, .list = "a list", .least_entries = least};
}

Type pairs(Kind kind, std::string_view words, std::size_t least, const Range& range = kAny) {
    return {.kind = kind, .forms = kPairs, .range = range, .pair = words, .least_entries = least};
}

std::string toml_of(bool value) {
    return value ? "true" : "false";
}

std::string toml_of(const std::string& value) {
    return fmt::format("\"{}\"", value);
}

std::string toml_of(Vec2 value) {
    return fmt::format("[{}, {}]", number_text(value.x), number_text(value.y));
}

template <class T>
requires std::is_arithmetic_v<T> std::string toml_of(T value) {
    return number_text(static_cast<double>(value));
}

template <class T>
std::string toml_of(const std::vector<T>& values) {
    std::vector<std::string> texts;
    for (const T& value : values) texts.push_back(toml_of(value));
    return fmt::format("[{}]", fmt::join(texts, ", "));
}

template <class T>
Default at(const T& value) {
    return {.toml = toml_of(value)};
}

/// The default of a choice whose words are in the order of an enum.
template <class E>
Default at(const Words& words, E value) {
    return at(std::string(words.at(static_cast<std::size_t>(value))));
}

Default otherwise(std::string_view words) {
    return {.words = words};
}

Default required() {
    return {.required = true};
}

Default none() {
    return {};
}

std::vector<Key> root_keys() {
    const Type table = of(Kind::kTable);
    const Type tables = of(Kind::kTables);
    return {
        {"", "schema", one_of({"1"}, Kind::kInteger), "", required(), "the version of this list of keys"},
        {"", "world", table, "", none(), "what acts on every body, and for how long"},
        {"", "rope", tables, "", none(), "a chain of particles", "a scene has at least one rope or net"},
        {"", "net", tables, "", none(), "particles and bars in any graph"},
        {"", "solver", table, "", none(), "how the motion is computed"},
        {"", "video", table, "", none(), "picture size, frame rate and encoder"},
        {"", "style", table, "", none(), "how it looks"},
        {"", "overlay", table, "", none(), "words, a scale bar and a plot beside the picture"},
        {"", "camera", table, "", none(), "where the camera looks"},
        {"", "golden", table, "", none(), "which pictures `corda golden` keeps and compares"},
    };
}

std::vector<Key> world_keys() {
    const WorldDef def;
    return {
        {"world", "gravity", or_pair(number(), "[gx, gy]"), "m/s2", at(-def.gravity_m_s2.y),
         "the gravity, downwards"},
        {"world", "duration", number(kAbove0), "s", at(def.duration_s), "the duration",
         "a video has the frames that start before it"},
        {"world", "drag", number(kFrom0), "1/s", at(def.drag_1_s), "the drag",
         "velocities decay by exp(-drag t)"},
    };
}

/// `keys` and those that ropes and nets have in common.
std::vector<Key> body_keys(std::string_view section, std::vector<Key> keys, std::string_view width) {
    const Type mass = or_list(number(kMass), "a list with one per particle");
    const Type velocity = or_list(pair("[vx, vy]", kAny), "a list with one such pair per particle");
    Type color = or_list(of(Kind::kColor), "a list with one per link, in turn");
    color.least_entries = 1;
    const std::vector<Key> common{
        {section, "points", pairs(Kind::kNumber, "[x, y]", 2, kCoordinate), "m", none(),
         "the positions of the particles"},
        {section, "origin", pair("[x, y]", kCoordinate), "m", otherwise("points are in the world"),
         "the position that points are relative to", "only for points"},
        {section, "mass", mass, "kg", at(kDefaultMassKg), "the mass of a particle"},
        {section, "velocity", velocity, "m/s", at(Vec2{}), "the velocity of the particles at the start",
         "what bars of fixed length cannot follow is left out, with a warning"},
        {section, "compliance", number({.low = 0.0, .high = 1e6}), "1/N", at(MaterialDef{}.compliance_1_n),
         "the strain per newton of tension, 1/(E A)", "at 0 all lengths are kept"},
        {section, "color", color, "", otherwise("the next of style.palette"), "the colour",
         "a list: of its links in turn, with style.color_by = \"link\""},
        {section, "width_px", number(kWidthPx), "px", otherwise(width), "the width"},
    };
    keys.insert(keys.end(), common.begin(), common.end());
    return keys;
}

std::vector<Key> rope_shapes() {
    return {
        {"rope", "line", of(Kind::kTable), "", none(),
         "line = { particles = 40, from = [0.0, 0.0], step = [0.0, -1.0] }",
         "exactly one of line, hang and points"},
        {"rope", "hang", of(Kind::kTable), "", none(),
         "hang = { links = 20, length = 1.0, angle_deg = 45.0 }"},
    };
}

std::vector<Key> rope_keys() {
    const RopeDef def;
    const Type boolean = of(Kind::kBoolean);
    return {
        {"rope", "payload", number({.low = 0.0, .high = kMass.high}), "kg", at(def.payload_kg),
         "the mass added to the last particle"},
        {"rope", "pinned", list(Kind::kInteger, 0), "", at(def.pinned),
         "the indices of the particles that never move", "-1 is the last, [] a free rope"},
        {"rope", "closed", boolean, "", at(def.closed), "the last point is tied to the first",
         "only for points, at least 3"},
        {"rope", "string", boolean, "", at(def.material.is_string), "links pull and never push",
         "without compliance they come taut plastically"},
        {"rope", "bending", number({.low = 0.0, .high = 1e12}), "N m2", at(def.bending_n_m2),
         "the bending stiffness E I", "not for a string"},
        {"rope", "link_length", or_list(number(kLength), "a list with one per link"), "m",
         otherwise("the distance at the start"), "the length of a link at rest",
         "needs compliance or string; a string that is too short for its points starts pulled in towards the "
         "pin"},
    };
}

std::vector<Key> rope_shape_keys() {
    const Type from = pair("[x, y]", kCoordinate);
    const std::string_view first = "the position of the first particle";
    return {
        {"rope.line", "particles", integer(2, kMaxParticles), "", required(), "the number of particles"},
        {"rope.line", "from", from, "m", at(Vec2{}), first},
        {"rope.line", "step", pair("[dx, dy]", kCoordinate), "m", required(),
         "the way from one particle to the next"},
        {"rope.hang", "links", integer(1, kMaxParticles - 1), "", required(), "the number of links",
         "one less than particles"},
        {"rope.hang", "length", number(kAbove0), "m", required(), "the length of the whole rope"},
        {"rope.hang", "angle_deg", number(), "degrees", at(0),
         "the angle from straight down, positive to +x"},
        {"rope.hang", "from", from, "m", at(Vec2{}), first},
    };
}

std::vector<Key> net_shapes() {
    return {
        {"net", "grid", of(Kind::kTable), "", none(), "grid = { columns = 40, rows = 30, spacing = 0.1 }",
         "exactly one of grid and points"},
    };
}

std::vector<Key> net_keys() {
    Type pinned = list(Kind::kInteger, 0);
    pinned.forms |= kPairs;
    pinned.pair = "[column, row]";
    const Type boolean = of(Kind::kBoolean);
    return {
        {"net", "bars", pairs(Kind::kInteger, "[a, b]", 1), "", none(), "the particles that each bar joins",
         "required with points; -1 is the last particle"},
        {"net", "pinned", pinned, "", otherwise("the upper corners of a grid, [0] of points"),
         "the indices of the particles that never move", "-1 is the last; a grid also takes [column, row]"},
        {"net", "string", boolean, "", at(MaterialDef{}.is_string), "bars pull and never push",
         "needs compliance"},
        {"net.grid", "columns", integer(1, kMaxParticles), "", required(), "the number of particles in a row",
         "indices go row by row from the upper left"},
        {"net.grid", "rows", integer(1, kMaxParticles), "", required(), "the number of rows"},
        {"net.grid", "from", pair("[x, y]", kCoordinate), "m", at(Vec2{}),
         "the position of the upper left particle"},
        {"net.grid", "spacing", or_pair(number(kDistance), "[dx, dy]"), "m", required(),
         "the distance from one particle to the next"},
        {"net.grid", "diagonals", boolean, "", at(kDefaultDiagonals),
         "two imaginary bars cross in each cell"},
    };
}

/// The orders of `rattle`.
Words order_words() {
    static const std::vector<std::string> words = [] {
        std::vector<std::string> texts;
        for (const int order : RattleDef::kOrders) texts.push_back(std::to_string(order));
        return texts;
    }();
    return {words.begin(), words.end()};
}

/// The keys of the methods that a scene names.
std::vector<Key> method_keys(std::string_view section) {
    const Words exact{ExactDef::kName};
    const Words rattle{RattleDef::kName};
    const Words relaxation{RelaxationDef::kName};
    const Words stepped{RattleDef::kName, RelaxationDef::kName};
    constexpr Range kTolerance{.low = ExactDef::kMinTolerance, .high = ExactDef::kMaxTolerance};
    const RelaxationDef def;
    return {
        {section, "tolerance", number(kTolerance), "", at(ExactDef{}.tolerance),
         "the position error relative to the length of the rope", "", exact},
        {section, "order", one_of(order_words(), Kind::kInteger), "", at(RattleDef{}.order), "the order", "",
         rattle},
        {section, "step", number({.low = 1e-9}), "s", otherwise("one frame; rattle: a stable part of one"),
         "the step", "", stepped},
        {section, "reach", integer(1, kMaxParticles), "", at(kDefaultReach), "the reach",
         "ropes have bars to the next 1..reach particles", relaxation,
         ": bars to farther particles make a straight rope a rigid rod, and its equations singular"},
        {section, "sweeps", integer(1, 1e6), "", at(def.sweeps),
         "the number of passes over all bars per step", "", relaxation},
        {section, "delta", number({.low = 0.0, .high = 1.0, .high_open = true}), "", at(def.delta),
         "the share of the velocity lost per step", "", relaxation, ", or give world.drag"},
        {section, "force", pair("[fx, fy]", kAny), "N", otherwise("the weight"),
         "the force on every particle", "in place of gravity: a light particle accelerates more", relaxation,
         ", or give world.gravity"},
    };
}

std::vector<Key> solver_keys() {
    const Words methods(kMethodNames.begin(), kMethodNames.end());
    const Words automatic{AutoDef::kName};
    std::vector<Key> keys{
        {"solver", "method", one_of(methods), "", at(methods, SolverDef{}.index()), "the method"},
        {"solver", "tolerance_px", number(kAbove0), "px", at(AutoDef{}.tolerance_px),
         "the bound of the displayed position error", "", automatic},
    };
    const std::vector<Key> named = method_keys("solver");
    keys.insert(keys.end(), named.begin(), named.end());
    keys.push_back({"solver", "bodies", of(Kind::kTables), "", none(), "bodies that another method moves",
                    "solver.method moves the rest"});
    return keys;
}

std::vector<Key> solver_bodies_keys() {
    const std::string_view section = "solver.bodies";
    const Type indices = list(Kind::kInteger, 0);
    const Words methods(kMethodNames.begin() + 1, kMethodNames.end());  // all but auto
    std::vector<Key> keys{
        {section, "ropes", indices, "", at(std::vector<int>{}), "the indices of [[rope]] tables",
         "from 0; -1 is the last"},
        {section, "nets", indices, "", at(std::vector<int>{}), "the indices of [[net]] tables",
         "from 0; -1 is the last"},
        {section, "method", one_of(methods), "", required(), "the method of these bodies"},
    };
    const std::vector<Key> named = method_keys(section);
    keys.insert(keys.end(), named.begin(), named.end());
    return keys;
}

std::vector<Key> video_keys() {
    const VideoDef def;
    const std::vector<std::string_view> presets = media::preset_names();
    const Words pix{"auto", "420", "444", "rgba"};
    Type size = pair("[width, height]", {.low = 1, .high = kMaxSidePx});
    size.kind = Kind::kInteger;
    static const std::string size_note =
        fmt::format("even for a video in 4:2:0; {} pixels in all at most", kMaxPicturePx);
    return {
        {"video", "size", size, "px", at(std::vector<int>{def.width_px, def.height_px}),
         "the size of the picture", size_note},
        {"video", "fps", of(Kind::kFrameRate, {.low = 1e-3, .high = 1e5}), "1/s",
         Default{.toml = def.fps.rational().text()}, "the frames per second",
         "up to three decimals; 29.97 is \"30000/1001\""},
        {"video", "shutter", number({.low = 0.0, .high = 1.0}), "", at(def.shutter),
         "how long a frame is exposed, as a share of the time from frame to frame",
         "for motion blur in videos; the exposure is centred on the frame's time"},
        {"video", "subframes", integer(2, VideoDef::kMaxSubframes), "", at(def.subframes),
         "the number of pictures that a blurred frame is the mean of"},
        {"video", "codec", one_of(media::codec_names()), "", otherwise("the ending's"), "the encoder",
         "h264, h265, av1, vp9 and so on stand for libav's names"},
        {"video", "preset", one_of({presets.begin(), presets.end()}), "", otherwise("the encoder's"),
         "how long the encoder searches for a smaller file",
         "words of H.264 and H.265; AV1 and VP9 count from 0, the slowest; the others have none"},
        {"video", "crf", integer(1, EncoderDef::kMaxCrf), "", otherwise("the encoder's"),
         "the constant rate factor", "1 is the best; up to 51 of H.264 and H.265"},
        {"video", "pix", one_of(pix), "", at(pix, def.encoder.pix), "how pixels are stored",
         "444 sharpens coloured edges; browsers and QuickTime refuse H.264 so"},
        {"video", "threads", integer(1, EncoderDef::kMaxThreads), "", at(def.encoder.threads),
         "the number of threads of each encoder", "the bytes depend on it"},
        {"video", "jobs", integer(0, EncoderDef::kMaxThreads), "", at(def.encoder.jobs),
         "how many chunks of the video are made at a time", "0: one per core; the bytes do not depend on it"},
    };
}

std::vector<Key> style_keys() {
    const StyleDef def;
    const Type boolean = of(Kind::kBoolean);
    const Type color = of(Kind::kColor);
    const Words themes{"dark", "paper"};
    const Words color_by{"body", "tension", "speed", "strain", "link"};
    const Words markers{"none", "pinned", "all"};
    const Words bars{"none", "real", "all"};
    const Default of_theme = otherwise("the theme's");
    return {
        {"style", "theme", one_of(themes), "", at(themes, Theme::kDark), "the colours",
         "every one below overrides it"},
        {"style", "background", or_pair(of(Kind::kColor), "[top, bottom]"), "", of_theme, "the background",
         "with alpha for .png, .svg, .pdf and videos with alpha"},
        {"style", "palette", list(Kind::kColor, 1), "", of_theme,
         "the colours that ropes, then nets take in turn"},
        {"style", "color_by", one_of(color_by), "", at(color_by, def.color_by), "what colours tell",
         "tension, speed and strain of each link by one scale for the whole film; link: the list in color"},
        {"style", "rope_width_px", number(kWidthPx), "px", otherwise("shorter side / 120, at least 2"),
         "the width of ropes"},
        {"style", "net_width_px", number(kWidthPx), "px", otherwise("half of ropes, at least 2"),
         "the width of the threads of nets"},
        {"style", "payload", boolean, "", at(def.payload), "payloads are balls",
         "and so is every mass of ropes of up to 3 links"},
        {"style", "supports", boolean, "", at(def.supports), "pinned particles hang from plates",
         "from rings if something rises above them"},
        {"style", "halo", boolean, "", at(def.halo), "a gap parts crossing bodies"},
        {"style", "trail_s", number({.low = 0.0, .high = 3600.0}), "s", at(def.trail_s),
         "the time for which the path of the free end of a rope stays", "it fades; 0: not at all"},
        {"style", "markers", one_of(markers), "", at(markers, def.markers), "the particles with a marker"},
        {"style", "marker_radius_px", number(kWidthPx), "px", otherwise("grows with the width of the rope"),
         "the radius of markers"},
        {"style", "pinned_color", color, "", of_theme, "the markers of pinned particles"},
        {"style", "free_color", color, "", of_theme, "the markers of free particles"},
        {"style", "bars", one_of(bars), "", at(bars, def.bars), "the bars that are drawn apart"},
        {"style", "bar_width_px", number(kWidthPx), "px", otherwise("a quarter of the width of ropes"),
         "the width of bars"},
        {"style", "real_bar_color", color, "", of_theme, "the bars between neighbours"},
        {"style", "imaginary_bar_color", color, "", of_theme, "the longer bars"},
    };
}

std::vector<Key> overlay_keys() {
    const OverlayDef def;
    const Type boolean = of(Kind::kBoolean);
    const Words plots{"none", "energy", "tip", "phase"};
    const Default if_large = otherwise("true on an opaque background, from a shorter side of 160 px on");
    return {
        {"overlay", "time", boolean, "", if_large, "the time, at the lower left"},
        {"overlay", "scale_bar", boolean, "", if_large, "a scale bar, at the lower right"},
        {"overlay", "legend", boolean, "", if_large, "the scale of style.color_by, at the upper right"},
        {"overlay", "title", of(Kind::kText), "", at(def.title), "the title, at the upper left",
         "shortened if it is too long"},
        {"overlay", "energy", boolean, "", at(def.energy), "the error of the energy, beside the time",
         "left out if there is no room"},
        {"overlay", "method", boolean, "", at(def.method),
         "the method and the bound of the displayed error, below the title"},
        {"overlay", "plot", one_of(plots), "", at(plots, def.plot), "a live plot beside the picture",
         "kinetic, potential and total energy; x and y of the first free end; its vx against x"},
        {"overlay", "text_px", number({.low = 4.0, .high = 400.0}), "px",
         otherwise("shorter side / 40, at least readable"), "the size of the words at the edges"},
    };
}

std::vector<Key> camera_keys() {
    return {
        {"camera", "center", pair("[x, y]", kCoordinate), "m", otherwise("fits the whole motion"),
         "the position in the middle of the picture"},
        {"camera", "height", number({.low = 1e-9, .high = 4 * Limits::kCoordinateMetres}), "m",
         otherwise("fits the whole motion"), "the height of the picture"},
        {"camera", "margin", number({.low = 0.0, .high = 0.45}), "", at(CameraDef{}.margin),
         "the share of the shorter side left free at each edge"},
    };
}

std::vector<Key> golden_keys() {
    const GoldenDef def;
    Type size = pair("[width, height]", {.low = 1, .high = kMaxSidePx});
    size.kind = Kind::kInteger;
    Type times = list(Kind::kNumber, 1);
    times.range = kFrom0;
    const Default exact = otherwise("only equal pictures pass");
    return {
        {"golden", "at", times, "s", required(), "the times of the pictures",
         "increasing, none after world.duration"},
        {"golden", "size", size, "px", at(std::vector<int>{def.width_px, def.height_px}),
         "the size of the pictures"},
        {"golden", "max", number({.low = 0.0, .high = 255.0}), "", exact,
         "the largest difference of a channel that passes"},
        {"golden", "share", number({.low = 0.0, .high = 1.0}), "", exact,
         "the share of differing pixels that passes", "given without golden.max it bounds the share alone"},
    };
}

}  // namespace

const std::vector<Key>& all_keys() {
    static const std::vector<Key> keys = [] {
        std::vector<Key> all;
        for (const std::vector<Key>& part :
             {root_keys(), world_keys(), body_keys("rope", rope_shapes(), "style.rope_width_px"), rope_keys(),
              rope_shape_keys(), body_keys("net", net_shapes(), "style.net_width_px"), net_keys(),
              solver_keys(), solver_bodies_keys(), video_keys(), style_keys(), overlay_keys(), camera_keys(),
              golden_keys()}) {
            all.insert(all.end(), part.begin(), part.end());
        }
        return all;
    }();
    return keys;
}

const Key* find_key(std::string_view section, std::string_view name) {
    const auto& keys = all_keys();
    const auto found = std::find_if(
        keys.begin(), keys.end(), [&](const Key& key) { return key.section == section && key.name == name; });
    return found == keys.end() ? nullptr : &*found;
}

const Key* key_of_section(std::string_view section) {
    const std::size_t dot = section.rfind('.');
    if (dot == std::string_view::npos) return find_key("", section);
    return find_key(section.substr(0, dot), section.substr(dot + 1));
}

std::vector<std::string_view> keys_of(std::string_view section) {
    std::vector<std::string_view> names;
    for (const Key& key : all_keys()) {
        if (key.section == section) names.push_back(key.name);
    }
    return names;
}

}  // namespace corda::scene
