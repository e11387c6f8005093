#include "corda/scene/write_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/scene/digest.hpp"
#include "corda/scene/keys.hpp"
#include "corda/scene/readers.hpp"

namespace corda {
namespace {

[[noreturn]] void fail_unsayable(const std::string& what) {
    throw Error(ExitCode::kUsage, fmt::format("a scene file cannot say this scene: {}", what));
}

std::string value_text(bool value) {
    return value ? "true" : "false";
}

template <class T>
requires std::is_integral_v<T> std::string value_text(T value) {
    return fmt::format("{}", value);
}

/// As few digits as give the same bits again.
std::string value_text(double value) {
    return value == 0.0 && std::signbit(value) ? "-0.0" : fmt::format("{}", value);
}

std::string value_text(const std::string& value) {
    std::string text = "\"";
    for (const char c : value) {
        if (c == '"' || c == '\\') text += '\\';
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            text += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
            text += c;
    }
    return text + '"';
}

std::string value_text(Vec2 value) {
    return fmt::format("[{}, {}]", value_text(value.x), value_text(value.y));
}

std::string value_text(Color value) {
    return value_text(value.text());
}

template <class T>
std::string value_text(const std::vector<T>& values) {
    std::string text = "[";
    for (const T& value : values) text += (text.size() == 1 ? "" : ", ") + value_text(value);
    return text + "]";
}

/// Writes the keys of one table.
class TableWriter {
  public:
    /// `heading` as it stands in the file; `section` as the list of keys has it.
    TableWriter(std::string& toml, std::string_view heading, std::string_view section)
        : toml_(&toml), section_(section) {
        *toml_ += fmt::format("\n{}\n", heading);
    }

    template <class T>
    void add(const char* key, const T& value) {
        if constexpr (std::is_enum_v<T>)
            add(key, std::string(
                         scene::find_key(section_, key)->type.choices.at(static_cast<std::size_t>(value))));
        else
            add_text(key, value_text(value));
    }

    template <class T>
    void add(const char* key, const std::optional<T>& value) {
        if (value) add(key, *value);
    }

    /// A word that is empty if it is left open.
    void add_word(const char* key, const std::string& word) {
        if (!word.empty()) add(key, word);
    }

    void add_text(const char* key, const std::string& text) { *toml_ += fmt::format("{} = {}\n", key, text); }

  private:
    std::string* toml_;
    std::string section_;
};

void write_method(const AutoDef& def, TableWriter& table) {
    table.add("tolerance_px", def.tolerance_px);
}

void write_method(const ExactDef& def, TableWriter& table) {
    table.add("tolerance", def.tolerance);
}

void write_method(const RattleDef& def, TableWriter& table) {
    if (def.guard != RattleDef{}.guard) fail_unsayable("the guard of method rattle has no key");
    table.add("order", def.order);
    table.add("step", def.step_s);
}

void write_method(const RelaxationDef& def, TableWriter& table) {
    table.add("step", def.step_s);
    table.add("sweeps", def.sweeps);
    table.add("delta", def.delta);
    table.add("force", def.force_n);
}

/// The reach that ropes share.
class Reach {
  public:
    void take(const RopeDef& rope) {
        if (reach_ && *reach_ != rope.reach) fail_unsayable("ropes of one method differ in reach");
        reach_ = rope.reach;
    }

    void write(std::string_view method, TableWriter& table) const {
        if (!reach_) return;
        if (method == RelaxationDef::kName)
            table.add("reach", *reach_);
        else if (*reach_ != 1)
            fail_unsayable("only method relaxation has a reach");
    }

  private:
    std::optional<int> reach_;
};

void write_solver(const Scene& scene, std::string& toml) {
    const auto check_index = [&](std::uint32_t rope) -> const RopeDef& {
        if (rope >= scene.ropes.size()) fail_unsayable("body_solvers names a rope that is not there");
        return scene.ropes[rope];
    };
    std::vector<bool> is_named(scene.ropes.size());
    for (const BodySolverDef& bodies : scene.body_solvers) {
        for (const std::uint32_t rope : bodies.ropes) {
            static_cast<void>(check_index(rope));
            is_named[rope] = true;
        }
    }
    Reach common;
    for (std::size_t i = 0; i < scene.ropes.size(); ++i)
        if (!is_named[i]) common.take(scene.ropes[i]);
    TableWriter table(toml, "[solver]", "solver");
    const std::string method(solver_name(scene.solver));
    table.add("method", method);
    std::visit([&](const auto& def) { write_method(def, table); }, scene.solver);
    common.write(method, table);
    for (const BodySolverDef& bodies : scene.body_solvers) {
        Reach reach;
        for (const std::uint32_t rope : bodies.ropes) reach.take(check_index(rope));
        TableWriter part(toml, "[[solver.bodies]]", "solver.bodies");
        const std::string its_method(method_name(bodies.method));
        part.add("ropes", bodies.ropes);
        part.add("nets", bodies.nets);
        part.add("method", its_method);
        std::visit([&](const auto& def) { write_method(def, part); }, bodies.method);
        reach.write(its_method, part);
    }
}

void write_style(const StyleDef& style, std::string& toml) {
    TableWriter table(toml, "[style]", "style");
    table.add("theme", style.theme);
    if (style.background)
        table.add("background", std::vector<Color>{style.background->top, style.background->bottom});
    if (!style.palette.empty()) table.add("palette", style.palette);
    table.add("color_by", style.color_by);
    table.add("rope_width_px", style.rope_width_px);
    table.add("net_width_px", style.net_width_px);
    table.add("payload", style.payload);
    table.add("supports", style.supports);
    table.add("halo", style.halo);
    table.add("trail_s", style.trail_s);
    table.add("markers", style.markers);
    table.add("marker_radius_px", style.marker_radius_px);
    table.add("pinned_color", style.pinned_color);
    table.add("free_color", style.free_color);
    table.add("bars", style.bars);
    table.add("bar_width_px", style.bar_width_px);
    table.add("real_bar_color", style.real_bar_color);
    table.add("imaginary_bar_color", style.imaginary_bar_color);
}

void write_picture(const Scene& scene, std::string& toml) {
    const VideoDef& video = scene.video;
    TableWriter table(toml, "[video]", "video");
    table.add("size", std::vector<int>{video.width_px, video.height_px});
    table.add("fps", video.fps.rational().text());
    table.add("shutter", video.shutter);
    table.add("subframes", video.subframes);
    table.add_word("codec", video.encoder.codec);
    table.add_word("preset", video.encoder.preset);
    table.add("crf", video.encoder.crf);
    table.add("pix", video.encoder.pix);
    table.add("threads", video.encoder.threads);
    write_style(scene.style, toml);
    TableWriter overlay(toml, "[overlay]", "overlay");
    overlay.add("time", scene.overlay.time);
    overlay.add("scale_bar", scene.overlay.scale_bar);
    overlay.add("legend", scene.overlay.legend);
    overlay.add("title", scene.overlay.title);
    overlay.add("energy", scene.overlay.energy);
    overlay.add("method", scene.overlay.method);
    overlay.add("plot", scene.overlay.plot);
    overlay.add("text_px", scene.overlay.text_px);
    TableWriter camera(toml, "[camera]", "camera");
    camera.add("center", scene.camera.center_m);
    camera.add("height", scene.camera.height_m);
    camera.add("margin", scene.camera.margin);
}

/// One value if all are the same.
template <class T>
void write_all(const char* key, const std::vector<T>& values, const T& initial, TableWriter& table) {
    for (const T& value : values) {
        if (value_text(value) == value_text(values.front())) continue;
        table.add(key, values);
        return;
    }
    if (!values.empty() && value_text(values.front()) != value_text(initial)) table.add(key, values.front());
}

template <class Body>
void write_body(const Body& body, const BodyStyleDef& style, TableWriter& table) {
    write_all("mass", body.mass_kg, scene::kDefaultMassKg, table);
    write_all("velocity", body.velocity_m_s, Vec2{}, table);
    table.add("pinned", body.pinned);
    table.add("compliance", body.material.compliance_1_n);
    table.add("string", body.material.is_string);
    table.add("color", style.color);
    if (!style.link_colors.empty()) table.add("color", style.link_colors);
    table.add("width_px", style.width_px);
}

bool are_same(Vec2 a, Vec2 b) {
    return a == b && std::signbit(a.x) == std::signbit(b.x) && std::signbit(a.y) == std::signbit(b.y);
}

/// Whether the particles stand as those of the key `line` do.
bool is_line(const RopeDef& rope) {
    if (rope.closed || rope.points_m.size() < 2) return false;
    for (std::size_t i = 0; i < rope.points_m.size(); ++i)
        if (!are_same(rope.points_m[i], Vec2{} + static_cast<double>(i) * rope.points_m[1])) return false;
    return true;
}

template <class Body>
void write_points(const Body& body, TableWriter& table) {
    table.add("origin", body.origin_m);
    table.add("points", body.points_m);
}

void write_rope(const RopeDef& rope, const BodyStyleDef& style, std::string& toml) {
    TableWriter table(toml, "[[rope]]", "rope");
    if (is_line(rope))
        table.add_text("line", fmt::format("{{ particles = {}, from = {}, step = {} }}", rope.points_m.size(),
                                           value_text(rope.origin_m), value_text(rope.points_m[1])));
    else
        write_points(rope, table);
    table.add("closed", rope.closed);
    write_body(rope, style, table);
    table.add("payload", rope.payload_kg);
    table.add("bending", rope.bending_n_m2);
    if (!rope.rest_m.empty()) write_all("link_length", rope.rest_m, 0.0, table);
}

/// The key `grid` of a net with so many columns, and of so many rows as it takes.
std::string grid_text(const NetDef& net, std::size_t columns, bool has_diagonals) {
    const std::size_t rows = net.points_m.size() / columns;
    const double dx = columns > 1 ? net.points_m[1].x : 1.0;
    const double dy = rows > 1 ? 0.0 - net.points_m[columns].y : 1.0;
    return fmt::format("{{ columns = {}, rows = {}, from = {}, spacing = {}, diagonals = {} }}", columns,
                       rows, value_text(net.origin_m), value_text(Vec2{dx, dy}), has_diagonals);
}

/// Whether `grid` stands for the particles and the bars of `net`.
bool is_grid(const NetDef& net, const std::string& grid) {
    const auto is_same_bar = [](const NetBar& a, const NetBar& b) {
        return a.a == b.a && a.b == b.b && a.is_real == b.is_real;
    };
    try {
        const Scene made = parse_scene("schema = 1\n[[net]]\ngrid = " + grid + "\n", "grid");
        const NetDef& its = made.nets.front();
        return are_same(net.origin_m, its.origin_m) &&
               std::ranges::equal(net.points_m, its.points_m, are_same) &&
               std::ranges::equal(net.bars, its.bars, is_same_bar);
    } catch (const Error&) {
        return false;
    }
}

void write_net(const NetDef& net, const BodyStyleDef& style, std::string& toml) {
    TableWriter table(toml, "[[net]]", "net");
    // The first row of a grid ends where y changes.
    std::size_t columns = 0;
    while (columns < net.points_m.size() && net.points_m[columns].y == net.points_m.front().y) ++columns;
    std::string grid;
    if (columns > 0 && net.points_m.size() % columns == 0)
        grid = grid_text(net, columns, !net.bars.empty() && !net.bars.back().is_real);
    if (!grid.empty() && is_grid(net, grid)) {
        table.add_text("grid", grid);
    } else {
        write_points(net, table);
        std::string bars = "[";
        for (const NetBar& bar : net.bars) {
            if (!bar.is_real) fail_unsayable("only a grid has imaginary bars");
            bars += fmt::format("{}[{}, {}]", bars.size() == 1 ? "" : ", ", bar.a, bar.b);
        }
        table.add_text("bars", bars + "]");
    }
    write_body(net, style, table);
}

/// With the defaults that a reader fills in.
Scene filled(Scene scene) {
    const auto fill = [](auto& body) {
        if (body.mass_kg.empty()) body.mass_kg.assign(body.points_m.size(), scene::kDefaultMassKg);
        if (body.velocity_m_s.empty()) body.velocity_m_s.resize(body.points_m.size());
    };
    for (RopeDef& rope : scene.ropes) fill(rope);
    for (NetDef& net : scene.nets) fill(net);
    scene.body_styles.resize(scene.ropes.size() + scene.nets.size());
    return scene;
}

}  // namespace

std::string write_scene(const Scene& given) {
    const Scene scene = filled(given);
    std::string toml = "schema = 1\n";
    TableWriter world(toml, "[world]", "world");
    world.add("gravity", scene.world.gravity_m_s2);
    world.add("duration", scene.world.duration_s);
    world.add("drag", scene.world.drag_1_s);
    write_solver(scene, toml);
    write_picture(scene, toml);
    for (std::size_t i = 0; i < scene.ropes.size(); ++i)
        write_rope(scene.ropes[i], scene.body_styles[i], toml);
    for (std::size_t i = 0; i < scene.nets.size(); ++i)
        write_net(scene.nets[i], scene.body_styles[scene.ropes.size() + i], toml);
    std::string difference;
    try {
        difference = first_difference(digest(scene), digest(parse_scene(toml, "scene")));
    } catch (const Error& error) {
        difference = error.what();
    }
    if (!difference.empty()) fail_unsayable(difference);
    return toml;
}

}  // namespace corda
