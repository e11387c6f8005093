#include "corda/film/motion_input.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <variant>

#include <fmt/format.h>

#include "corda/core/text.hpp"
#include "corda/core/timeline.hpp"
#include "corda/film/given.hpp"
#include "corda/scene/schema.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/moving_pins.hpp"
#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/number_text.hpp"

namespace corda::film {
namespace {

void validate_frame_rate(const Scene& scene) {
    const Rational fps = scene.video.fps.rational();
    if (fps.is_rate()) return;
    throw_error(ExitCode::kInvalidScene, "video.fps: {}/{} is not a fraction of integers within 1 .. {}",
                fps.num, fps.den, Rational::kMaxPart);
}

void validate_frames(const Scene& scene) {
    const FrameRate rate = scene.video.scene_rate();
    const double frames = scene.world.duration_s * rate.per_second();
    constexpr auto kMost = static_cast<double>(scene::Limits::kFrames);
    if (frames <= kMost && rate.frame_count(scene.world.duration_s) >= 1) return;
    throw_error(ExitCode::kInvalidScene,
                "world.duration: {:g} s at {} frames per second are {:g} frames; give 1 .. {}",
                scene.world.duration_s, rate.rational().text(), frames, scene::Limits::kFrames);
}

/// Relative differences of kinetic energy or velocity below this one come from rounded numbers in the scene.
constexpr double kRounding = 1e-9;

/// The velocity at the start that all pins of a body have.
Vec2 velocity_of_pins_m_s(const System& body) {
    return sim::common_displacement(body).value_or(sim::TimeFunction()).derivative()(0.0);
}

/// Kinetic energy of the free particles in J, seen from a frame of this velocity.
double kinetic_j(const System& system, std::span<const double> vx_m_s, std::span<const double> vy_m_s,
                 Vec2 frame_m_s) {
    double sum_j = 0.0;
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        const Vec2 v = Vec2{vx_m_s[i], vy_m_s[i]} - frame_m_s;
        if (!system.is_pinned(i)) sum_j += 0.5 * system.mass_kg[i] * dot(v, v);
    }
    return sum_j;
}

/// True if the ends of a rigid bar separate at the start, or approach each other unless it is a string.
bool has_velocity_along_bars(const System& body) {
    const MaterialDef& material = body.bodies.front().material;
    if (material.compliance_1_n > 0.0) return false;
    return std::ranges::any_of(body.bars, [&](const Bar& bar) {
        if (body.is_pinned(bar.a) && body.is_pinned(bar.b)) return false;
        const Vec2 along{body.x_m[bar.b] - body.x_m[bar.a], body.y_m[bar.b] - body.y_m[bar.a]};
        const Vec2 apart{body.vx_m_s[bar.b] - body.vx_m_s[bar.a], body.vy_m_s[bar.b] - body.vy_m_s[bar.a]};
        const double rate = dot(along, apart);
        const double small = kRounding * sim::length(along.x, along.y) * sim::length(apart.x, apart.y);
        return material.is_string ? rate > small : std::abs(rate) > small;
    });
}

/// The kinetic energy in J after projecting the velocities; std::nullopt if the method cannot run the body.
std::optional<double> kinetic_after_j(const System& body, const WorldDef& world, const MethodDef& method,
                                      double frame_interval_s) {
    // Relaxation uses the velocities unchanged. Its first steps remove those along a rope's links like
    // `rattle`, but let a net stretch.
    const bool is_relaxed = std::holds_alternative<RelaxationDef>(method);
    if (is_relaxed && body.bars.size() != body.bodies.front().link_count) return std::nullopt;
    const MethodDef projecting = is_relaxed ? RattleDef{} : method;
    try {
        const auto solver = sim::make_solver(body, world, {&projecting, 1}, frame_interval_s);
        State state;
        state.vx_m_s.resize(body.particle_count());
        state.vy_m_s.resize(body.particle_count());
        solver->velocities(state);
        return kinetic_j(body, state.vx_m_s, state.vy_m_s, velocity_of_pins_m_s(body));
    } catch (const Refusal&) {
        return std::nullopt;
    }
}

/// True if pins start with a speed, and free particles at rest.
bool has_pins_alone_that_move(const System& body) {
    if (body.moves.empty()) return false;
    for (std::size_t i = 0; i < body.particle_count(); ++i)
        if (!body.is_pinned(i) && (body.vx_m_s[i] != 0.0 || body.vy_m_s[i] != 0.0)) return false;
    return true;
}

void add_lost_velocity(const Scene& scene, const System& system, const Plan& plan,
                       std::vector<std::string>& notes) {
    const auto is_zero = [](double v) { return v == 0.0; };
    if (std::ranges::all_of(system.vx_m_s, is_zero) && std::ranges::all_of(system.vy_m_s, is_zero)) return;
    sim::for_each_body(system, [&](const System& body, std::size_t i) {
        if (!has_velocity_along_bars(body)) return;
        const double before_j = kinetic_j(body, body.vx_m_s, body.vy_m_s, velocity_of_pins_m_s(body));
        const auto after_j =
            kinetic_after_j(body, scene.world, plan.bodies[i].method, scene.video.fps.interval_s());
        if (!after_j || !(before_j - *after_j > kRounding * before_j)) return;
        const double all_j = kinetic_j(body, body.vx_m_s, body.vy_m_s, {});
        if (!(before_j - *after_j > kRounding * kRounding * all_j)) return;
        const bool is_string = body.bodies.front().material.is_string;
        const bool is_by_pins = has_pins_alone_that_move(body);
        notes.push_back(fmt::format(
            "{}: {:.3g} % of the kinetic energy at the start{}, {:.3g} J of {:.3g} J, is left out: "
            "{} {} of fixed length, which {}; {}, or a compliance",
            body_name(system, i), 100.0 * (1.0 - *after_j / before_j),
            body.moves.empty() ? "" : ", seen from its pins", before_j - *after_j, before_j,
            is_by_pins ? "a pin starts with a speed along" : "velocity along",
            is_string ? "taut links" : "bars",
            is_string ? "cannot lengthen" : "can neither lengthen nor shorten",
            is_by_pins ? "let its waves start at rest (phase_deg = 90)" : "give velocities across them"));
    });
}

/// Notes a velocity of a pinned particle in a list per particle; a single velocity is for free particles.
void add_pinned_velocity(const std::string& name, const std::vector<Vec2>& velocity_m_s,
                         const std::vector<std::uint32_t>& pinned, std::vector<std::string>& notes) {
    const auto is_same = [&](Vec2 v) {
        return v.x == velocity_m_s.front().x && v.y == velocity_m_s.front().y;
    };
    if (std::ranges::all_of(velocity_m_s, is_same)) return;
    for (const std::uint32_t i : pinned) {
        const Vec2 v = velocity_m_s[i];
        if (v.x == 0.0 && v.y == 0.0) continue;
        notes.push_back(
            fmt::format("{}: velocity [{}, {}] of particle {} is left out, because it is pinned; give [0, "
                        "0], or remove it from pinned",
                        name, v.x, v.y, i));
        return;
    }
}

/// Notes links of a string that are too short for its points.
void add_pulled_in(const std::string& name, const RopeDef& rope, std::vector<std::string>& notes) {
    const std::optional<RopeDef> start = pulled_in(rope);
    if (!start) return;
    double farthest_m = 0.0;
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < rope.points_m.size(); ++i) {
        const Vec2 moved = start->points_m[i] - rope.points_m[i];
        const double distance_m = sim::length(moved.x, moved.y);
        if (distance_m <= farthest_m) continue;
        farthest_m = distance_m;
        farthest = i;
    }
    if (farthest_m == 0.0) return;
    const Vec2 at = rope.origin_m + start->points_m[farthest];
    const Vec2 given = rope.origin_m + rope.points_m[farthest];
    notes.push_back(
        fmt::format("{}: link_length is less than the distance of its points, so it starts pulled in, "
                    "particle {} at [{:.6g}, "
                    "{:.6g}] instead of [{:.6g}, {:.6g}]; give a larger link_length, or a compliance",
                    name, farthest, at.x, at.y, given.x, given.y));
}

void add_rope_notes(const std::string& name, const RopeDef& rope, std::vector<std::string>& notes) {
    add_pulled_in(name, rope, notes);
    add_pinned_velocity(name, rope.velocity_m_s, rope.pinned, notes);
    const auto last = static_cast<std::uint32_t>(rope.points_m.size() - 1);
    const bool is_last_pinned =
        std::ranges::find(rope.pinned, last) != rope.pinned.end() &&
        std::ranges::find(rope.releases, last, &ReleaseDef::pin) == rope.releases.end();
    if (rope.payload_kg > 0.0 && is_last_pinned) {
        notes.push_back(fmt::format(
            "{}: payload {} kg changes nothing, because the last particle is pinned; remove payload, or -1 "
            "from pinned",
            name, rope.payload_kg));
    }
    if (rope.bending_n_m2 > 0.0 && rope.points_m.size() == 2) {
        notes.push_back(fmt::format(
            "{}: bending changes nothing in a rope of one link; give more links, or remove bending", name));
    }
}

/// Notes colours of links beyond the last link.
void add_spare_colors(const Scene& scene, const System& system, std::vector<std::string>& notes) {
    for (std::size_t i = 0; i < std::min(scene.body_styles.size(), system.bodies.size()); ++i) {
        const std::size_t colors = scene.body_styles[i].link_colors.size();
        const std::size_t links = system.bodies[i].link_count;
        if (colors <= links) continue;
        notes.push_back(
            fmt::format("{}: the last {} of {} colours are not used, because it has {} links; remove them",
                        body_name(system, i), colors - links, colors, links));
    }
}

}  // namespace

sim::NamedMethods named_methods(const Scene& scene) {
    sim::NamedMethods named;
    for (const SolverDef& solver : solvers_of(scene)) {
        named.push_back(std::visit(
            [](const auto& def) -> std::optional<MethodDef> {
                if constexpr (std::is_same_v<std::decay_t<decltype(def)>, AutoDef>)
                    return std::nullopt;
                else
                    return def;
            },
            solver));
    }
    return named;
}

std::vector<MethodDef> if_all_named(const sim::NamedMethods& named) {
    std::vector<MethodDef> methods;
    for (const auto& method : named) {
        if (!method) return {};
        methods.push_back(*method);
    }
    return methods;
}

std::int64_t last_frame_of(const Scene& scene) {
    return scene.video.scene_rate().last_frame_within(scene.world.duration_s);
}

std::optional<double> motion_time_s(const Scene& scene, double time_s) {
    const double last_s = scene.video.scene_rate().time_s(last_frame_of(scene));
    return time_within(time_s, std::max(scene.world.duration_s, last_s));
}

double subframe_s(const VideoDef& video, double time_s, double shutter, double end_s, int i) {
    const double half_s = 0.5 * shutter * video.scene_rate().interval_s();
    const double from_s = std::max(0.0, time_s - half_s);
    const double until_s = std::min(std::max(end_s, time_s), time_s + half_s);
    return from_s + (i + 0.5) / video.subframes * (until_s - from_s);
}

std::vector<double> arrow_times_s(const Scene& scene) {
    constexpr int kInstants = 250;
    std::vector<double> times_s;
    for (int i = 0; i < kInstants && scene.style.arrows != Arrows::kNone; ++i)
        times_s.push_back(scene.world.duration_s * i / kInstants);
    return times_s;
}

void validate(const Scene& scene, std::span<const double> stills_s) {
    validate_frame_rate(scene);
    check_definitions(scene);
    validate_frames(scene);
    if (scene.given) validate_given(scene);
    static_cast<void>(solvers_of(scene));
    for (const double time_s : stills_s) {
        if (motion_time_s(scene, time_s)) continue;
        throw_usage("stills_s: {} s is not within 0 .. {} s", time_s, scene.world.duration_s);
    }
}

std::vector<std::string> input_notes(const Scene& scene, const System& system, const Plan& plan) {
    std::vector<std::string> notes;
    if (scene.given) {  // other notes are of simulations
        add_spare_colors(scene, system, notes);
        return notes;
    }
    if (scene.world.drag_1_s == 0.0 &&
        (scene.world.wind_m_s != Vec2{} || scene.world.gusts.amplitude != Vec2{}))
        notes.emplace_back(
            "world: wind and gusts change nothing without drag; give world.drag, for instance 0.5");
    add_lost_velocity(scene, system, plan, notes);
    for (std::size_t i = 0; i < scene.ropes.size(); ++i)
        add_rope_notes(body_name(system, i), scene.ropes[i], notes);
    for (std::size_t i = 0; i < scene.nets.size(); ++i) {
        const NetDef& net = scene.nets[i];
        add_pinned_velocity(body_name(system, scene.ropes.size() + i), net.velocity_m_s, net.pinned, notes);
    }
    add_spare_colors(scene, system, notes);
    return notes;
}

}  // namespace corda::film
