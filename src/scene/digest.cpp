#include "corda/scene/digest.hpp"

#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "corda/scene/keys.hpp"

namespace corda {
namespace {

constexpr std::size_t kMaxBodies = 100;
constexpr std::size_t kMaxText = 64;
constexpr std::string_view kHashed = "hash ";

/// FNV-1a, by Fowler, Noll and Vo.
std::uint64_t hash_of(std::string_view text) {
    std::uint64_t hash = 14695981039346656037U;
    for (const char c : text) {
        hash ^= static_cast<unsigned char>(c);
        hash *= 1099511628211U;
    }
    return hash;
}

std::string text_of(bool value) {
    return value ? "true" : "false";
}

template <class T>
requires std::is_arithmetic_v<T> std::string text_of(T value) {
    return fmt::format("{}", value);
}

std::string text_of(const std::string& value) {
    return value;
}

std::string text_of(Vec2 value) {
    return fmt::format("[{}, {}]", value.x, value.y);
}

std::string text_of(Color value) {
    return value.text();
}

std::string text_of(const Ground& value) {
    return fmt::format("[{}, {}]", value.top.text(), value.bottom.text());
}

std::string text_of(const NetBar& value) {
    return fmt::format("[{}, {}, {}]", value.a, value.b, value.is_real);
}

template <class T>
std::string text_of(const std::optional<T>& value) {
    return value ? text_of(*value) : "not given";
}

template <class T>
std::string text_of(const std::vector<T>& values) {
    std::string text;
    for (const T& value : values) text += (text.empty() ? "" : ", ") + text_of(value);
    return "[" + text + "]";
}

/// The keys of one table.
class Table {
  public:
    Table(std::string name, std::map<std::string, std::string>& digest)
        : name_(std::move(name)), digest_(&digest) {}

    template <class T>
    void add(const char* key, const T& value) {
        if constexpr (std::is_enum_v<T>) {
            add(key, std::optional(value));
        } else {
            std::string text = text_of(value);
            if (text.size() > kMaxText) text = fmt::format("{}{:016x}", kHashed, hash_of(text));
            digest_->emplace(name_ + "." + key, std::move(text));
        }
    }

    /// A choice: its word.
    template <class E>
    requires std::is_enum_v<E>
    void add(const char* key, std::optional<E> value) {
        std::optional<std::string> word;
        if (value) word = scene::find_key(name_, key)->type.choices.at(static_cast<std::size_t>(*value));
        add(key, word);
    }

  private:
    std::string name_;
    std::map<std::string, std::string>* digest_;
};

void add_method(const ExactDef& def, Table& table) {
    table.add("tolerance", def.tolerance);
}

void add_method(const RattleDef& def, Table& table) {
    table.add("order", def.order);
    table.add("step", def.step_s);
    table.add("guard", def.guard);
}

void add_method(const RelaxationDef& def, Table& table) {
    table.add("step", def.step_s);
    table.add("sweeps", def.sweeps);
    table.add("delta", def.delta);
    table.add("force", def.force_n);
}

void add_method(const AutoDef& def, Table& table) {
    table.add("tolerance_px", def.tolerance_px);
}

void add_solver(const Scene& scene, std::map<std::string, std::string>& digest) {
    Table table("solver", digest);
    table.add("method", std::string(solver_name(scene.solver)));
    std::visit([&](const auto& def) { add_method(def, table); }, scene.solver);
    for (std::size_t i = 0; i < scene.body_solvers.size(); ++i) {
        const BodySolverDef& bodies = scene.body_solvers[i];
        Table part(fmt::format("solver.bodies[{}]", i), digest);
        part.add("ropes", bodies.ropes);
        part.add("nets", bodies.nets);
        part.add("method", std::string(method_name(bodies.method)));
        std::visit([&](const auto& def) { add_method(def, part); }, bodies.method);
    }
}

void add_style(const StyleDef& style, std::map<std::string, std::string>& digest) {
    Table table("style", digest);
    table.add("theme", style.theme);
    table.add("background", style.background);
    table.add("palette", style.palette);
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

void add_picture(const Scene& scene, std::map<std::string, std::string>& digest) {
    Table overlay("overlay", digest);
    overlay.add("time", scene.overlay.time);
    overlay.add("scale_bar", scene.overlay.scale_bar);
    overlay.add("legend", scene.overlay.legend);
    overlay.add("title", scene.overlay.title);
    overlay.add("energy", scene.overlay.energy);
    overlay.add("method", scene.overlay.method);
    overlay.add("plot", scene.overlay.plot);
    overlay.add("text_px", scene.overlay.text_px);
    Table camera("camera", digest);
    camera.add("center", scene.camera.center_m);
    camera.add("height", scene.camera.height_m);
    camera.add("margin", scene.camera.margin);
    const VideoDef& video = scene.video;
    Table table("video", digest);
    table.add("size", std::vector<int>{video.width_px, video.height_px});
    table.add("fps", video.fps.rational().text());
    table.add("shutter", video.shutter);
    table.add("subframes", video.subframes);
    table.add("codec", video.encoder.codec);
    table.add("preset", video.encoder.preset);
    table.add("crf", video.encoder.crf);
    table.add("pix", video.encoder.pix);
    table.add("threads", video.encoder.threads);
}

template <class Body>
void add_body(const Body& body, Table& table) {
    table.add("origin", body.origin_m);
    table.add("points", body.points_m);
    table.add("mass", body.mass_kg);
    table.add("velocity", body.velocity_m_s);
    table.add("pinned", body.pinned);
    table.add("compliance", body.material.compliance_1_n);
    table.add("string", body.material.is_string);
}

void add_bodies(const Scene& scene, std::map<std::string, std::string>& digest) {
    for (std::size_t i = 0; i < scene.ropes.size(); ++i) {
        const RopeDef& rope = scene.ropes[i];
        Table table(fmt::format("rope[{}]", i), digest);
        add_body(rope, table);
        table.add("payload", rope.payload_kg);
        table.add("reach", rope.reach);
        table.add("closed", rope.closed);
        table.add("link_length", rope.rest_m);
        table.add("bending", rope.bending_n_m2);
    }
    for (std::size_t i = 0; i < scene.nets.size(); ++i) {
        Table table(fmt::format("net[{}]", i), digest);
        add_body(scene.nets[i], table);
        table.add("bars", scene.nets[i].bars);
    }
    for (std::size_t i = 0; i < scene.body_styles.size(); ++i) {
        const BodyStyleDef& style = scene.body_styles[i];
        Table table(i < scene.ropes.size() ? fmt::format("rope[{}]", i)
                                           : fmt::format("net[{}]", i - scene.ropes.size()),
                    digest);
        table.add("color", style.color);
        table.add("link_colors", style.link_colors);
        table.add("width_px", style.width_px);
    }
}

}  // namespace

std::map<std::string, std::string> digest(const Scene& scene) {
    std::map<std::string, std::string> digest;
    Table world("world", digest);
    world.add("gravity", scene.world.gravity_m_s2);
    world.add("duration", scene.world.duration_s);
    world.add("drag", scene.world.drag_1_s);
    add_solver(scene, digest);
    add_style(scene.style, digest);
    add_picture(scene, digest);
    std::map<std::string, std::string> bodies;
    add_bodies(scene, bodies);
    if (scene.ropes.size() + scene.nets.size() <= kMaxBodies) {
        digest.merge(bodies);
        return digest;
    }
    std::string all;
    for (const auto& [key, value] : bodies) all += fmt::format("{} = {}\n", key, value);
    Table("scene", digest).add("bodies", all);
    return digest;
}

std::string first_difference(const std::map<std::string, std::string>& digest,
                             const std::map<std::string, std::string>& other) {
    constexpr const char* kNone = "not there";
    for (const auto& [key, value] : digest) {
        const auto there = other.find(key);
        if (there != other.end() && there->second == value) continue;
        if (value.starts_with(kHashed)) return key + " has other values";
        return fmt::format("{} is {} and was {}", key, value, there == other.end() ? kNone : there->second);
    }
    for (const auto& [key, value] : other)
        if (!digest.contains(key)) return fmt::format("{} is {} and was {}", key, kNone, value);
    return {};
}

}  // namespace corda
