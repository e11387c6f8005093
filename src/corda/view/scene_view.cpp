#include "corda/view/scene_view.hpp"

#include <algorithm>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/sim/events.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {
namespace {

// Sizes as shares of the frame's shorter side.
constexpr double kRopeWidth = 1.0 / 120.0;
constexpr double kNetWidth = 1.0 / 240.0;   // so that the cells of a cloth stay open
constexpr double kPinnedRim = 1.0 / 150.0;  // rim: how far a marker extends beyond the line
constexpr double kFreeRim = 1.0 / 400.0;
constexpr double kOutlineWidth = 1.0 / 400.0;
constexpr double kMinBall = 0.018;
constexpr double kMaxBall = 0.055;

constexpr double kMinLineWidthPx = 2.0;
constexpr double kNetWidthPerRopeWidth = 0.5;
constexpr double kBallPerLine = 1.6;  // radius, at least
constexpr double kTrailPerLine = 0.6;
constexpr double kMinTrailRadiusPx = 0.8;
constexpr double kHaloPerWidth = 0.35;
constexpr double kBarWidthPerRopeWidth = 0.25;
constexpr double kMinBarWidthPx = 1.0;

/// A ball hides the links that end in it.
constexpr std::uint8_t kBallWeight = 64;

/// Beyond this number balls have no outlines, which take many capsules each.
constexpr std::size_t kMaxOutlines = 1000;

/// The cube root of a number from 1 to 1000, by Newton's method: libraries differ in the last bit of cbrt.
double cube_root(double value) {
    double root = 10.0;
    for (int i = 0; i < 20; ++i) root -= (root - value / (root * root)) / 3.0;
    return root;
}

/// Radius of a payload's ball as a share of the shorter side; it grows with the cube root of the mass.
double ball_radius(double mass_kg, double rope_kg) {
    constexpr double kMaxRatio = 1000.0;
    const double ratio = std::clamp(mass_kg / rope_kg, 1.0, kMaxRatio);
    return std::min(kMinBall * cube_root(ratio), kMaxBall);
}

/// Between the first link's and the last one's.
double link_radius_px(const Body& body, const BodyView& view, std::size_t link) {
    const double share = static_cast<double>(link - body.first_bar) /
                         static_cast<double>(std::max<std::size_t>(body.link_count, 2) - 1);
    return view.radius_px + share * (view.end_radius_px - view.radius_px);
}

std::vector<Ball> balls_of(const System& system, const Body& body, const BodyView& view,
                           const StyleDef& style, double side_px) {
    std::vector<Ball> balls;
    if (body.is_net) return balls;
    const std::size_t last = body.first_particle + body.particle_count - 1;
    double rope_kg = -body.payload_kg;
    for (std::size_t i = body.first_particle; i <= last; ++i) rope_kg += system.mass_kg[i];
    for (std::size_t i = body.first_particle; i <= last; ++i) {
        const bool is_bob = body.link_count <= kLinksOfPendulum;
        const bool has_payload = i == last && body.payload_kg > 0.0;
        if (system.stays_pinned(i) || !(is_bob || has_payload)) continue;
        const double mass_kg = is_bob ? system.mass_kg[i] : body.payload_kg;
        const double radius_px = style.payload_radius_m ? 0.0 : ball_radius(mass_kg, rope_kg) * side_px;
        const std::size_t link =
            body.first_bar + std::max(i, body.first_particle + 1) - body.first_particle - 1;
        balls.push_back({i, link, std::max(radius_px, kBallPerLine * link_radius_px(body, view, link)),
                         style.payload_radius_m.value_or(0.0)});
    }
    return balls;
}

/// See BodyView::dots.
std::vector<Ball> dots_of(const System& system, const Body& body, const BodyView& view) {
    if (system.cut_s.empty()) return {};
    constexpr std::size_t kNone = SIZE_MAX;
    std::vector<std::size_t> last(body.particle_count, kNone);  // the link that is cut last, of each particle
    for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k) {
        for (const std::size_t i : {system.bars[k].a, system.bars[k].b}) {
            std::size_t& link = last[i - body.first_particle];
            if (link == kNone || system.cut_s[k] > system.cut_s[link]) link = k;
        }
    }
    std::vector<Ball> dots;
    for (std::size_t i = 0; i < last.size(); ++i)
        if (last[i] != kNone && system.cut_s[last[i]] < sim::kNoEvent)
            dots.push_back({body.first_particle + i, last[i], link_radius_px(body, view, last[i])});
    return dots;
}

/// The end of the row of merged bodies that starts at `first`.
std::size_t end_of_merged(const std::vector<BodyView>& bodies, std::size_t first, std::size_t most) {
    std::size_t end = first + 1;
    while (end < bodies.size() && bodies[end].is_merged && end - first < most) ++end;
    return end;
}

/// Gives each row of merged bodies its gradient of colours.
void color_merged(const StyleDef& style, const std::vector<BodyStyleDef>& body_styles,
                  std::vector<BodyView>& bodies) {
    const ColorScale scale = scale_of(Quantity::kSpeed, {}, style);
    std::span<const Color> colors = scale.colors;
    if (!style.palette.empty()) colors = style.palette;
    for (std::size_t first = 0, end = 0; first < bodies.size(); first = end) {
        end = end_of_merged(bodies, first, bodies.size());
        for (std::size_t i = first; i < end && end - first > 1; ++i) {
            const double share = static_cast<double>(i - first) / static_cast<double>(end - first - 1);
            if (i >= body_styles.size() || !body_styles[i].color)
                bodies[i].color = mixed_color(colors, share);
        }
    }
}

Drawn around(const MotionBounds& bounds, double radius_px) {
    return {bounds, radius_px, radius_px, radius_px, radius_px};
}

/// Includes the positions that slack links of a string may reach.
void include_slack(const SceneView& view, const Body& body, std::span<const MotionBounds> motion,
                   MotionBounds& bounds) {
    // Along any axis, twice the coordinate of a point of the arc is at most the sum of those of its ends and
    // the length. That is what a string reaches anyway, if it ever hangs taut.
    const Vec2 g = view.gravity_m_s2;
    const bool anywhere = g == Vec2{};
    for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k) {
        const Bar& link = view.system->bars[k];
        const MotionBounds& a = motion[link.a];
        const MotionBounds& b = motion[link.b];
        const Vec2 reach{0.5 * link.rest_m, 0.5 * link.rest_m};
        const Vec2 low = 0.5 * (a.min_m() + b.min_m()) - reach;
        const Vec2 high = 0.5 * (a.max_m() + b.max_m()) + reach;
        bounds.include(anywhere || g.x < 0.0 ? low.x : a.min_m().x,
                       anywhere || g.y < 0.0 ? low.y : a.min_m().y);
        bounds.include(anywhere || g.x > 0.0 ? high.x : a.max_m().x,
                       anywhere || g.y > 0.0 ? high.y : a.max_m().y);
    }
}

/// How a link or a ball is drawn.
struct Stroke {
    double radius_px = 0.0;
    double halo_px = 0.0;
    Tint tint = {};
};

Tint tint_of(const SceneView& view, std::size_t b, std::size_t link, const State& state) {
    const Body& body = view.system->bodies[b];
    const std::vector<Color>& in_turn = view.bodies[b].link_colors;
    Color color = view.bodies[b].color;
    if (view.scale)
        color = view.scale->color(sim::kind_of(view.scale->quantity).value(*view.system, body, link, state));
    else if (!in_turn.empty())
        color = in_turn[(link - body.first_bar) % in_turn.size()];
    return {color.r, color.g, color.b};
}

void draw_slack(const SceneView& view, const Bar& link, const Stroke& stroke, const State& state,
                const Camera& camera, DrawList& list) {
    const PixelPoint a = camera.at(state, link.a);
    const PixelPoint b = camera.at(state, link.b);
    // Without gravity it bends to the left, seen from a.
    Vec2 down{b.y - a.y, a.x - b.x};
    if (view.gravity_m_s2 != Vec2{}) down = {view.gravity_m_s2.x, -view.gravity_m_s2.y};
    const double length = std::max(sim::length(down.x, down.y), 1e-300);
    const Arc arc =
        hang_slack(a, b, link.rest_m * camera.pixels_per_metre(), {down.x / length, down.y / length});
    for (std::size_t k = 0; k + 1 < arc.count; ++k)
        list.add_capsule(arc.points[k], arc.points[k + 1], stroke.radius_px, stroke.halo_px, stroke.tint);
}

void draw_links(const SceneView& view, std::size_t b, bool is_tinted, double halo_per_radius,
                const State& state, const Camera& camera, DrawList& list) {
    const Body& body = view.system->bodies[b];
    for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k) {
        if (!view.system->has_bar_at(k, state.time_s)) continue;
        const Bar& link = view.system->bars[k];
        const double radius_px = link_radius_px(body, view.bodies[b], k);
        const Stroke stroke{radius_px, halo_per_radius * radius_px,
                            is_tinted ? tint_of(view, b, k, state) : Tint{}};
        const double distance_m =
            sim::length(state.x_m[link.b] - state.x_m[link.a], state.y_m[link.b] - state.y_m[link.a]);
        if (body.material.is_string && distance_m < link.rest_m)
            draw_slack(view, link, stroke, state, camera, list);
        else
            list.add_capsule(camera.at(state, link.a), camera.at(state, link.b), radius_px, stroke.halo_px,
                             stroke.tint);
    }
    for (const Ball& dot : view.bodies[b].dots) {
        if (view.system->has_bar_at(dot.link, state.time_s)) continue;
        const PixelPoint at = camera.at(state, dot.particle);
        list.add_capsule(at, at, dot.radius_px, halo_per_radius * dot.radius_px,
                         is_tinted ? tint_of(view, b, dot.link, state) : Tint{});
    }
}

void draw_bars(const SceneView& view, bool real, const State& state, const Camera& camera, DrawList& list) {
    const double width_px = view.style.bar_width_px.value_or(
        std::max(kMinBarWidthPx, kBarWidthPerRopeWidth * view.rope_width_px));
    list.add_layer(real ? view.colors.real_bar : view.colors.imaginary_bar);
    for (std::size_t k = 0; k < view.system->bars.size(); ++k) {
        const Bar& bar = view.system->bars[k];
        if ((bar.reach == 1) == real && view.system->has_bar_at(k, state.time_s))
            list.add_capsule(camera.at(state, bar.a), camera.at(state, bar.b), 0.5 * width_px);
    }
}

void draw_markers(const SceneView& view, bool pinned, const State& state, const Camera& camera,
                  DrawList& list) {
    list.add_layer(pinned ? view.colors.pinned : view.colors.free);
    for (std::size_t b = 0; b < view.bodies.size(); ++b) {
        const Body& body = view.system->bodies[b];
        const double radius_px =
            pinned ? view.bodies[b].pinned_marker_radius_px : view.bodies[b].free_marker_radius_px;
        for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i) {
            if (view.system->is_pinned_at(i, state.time_s) == pinned)
                list.add_capsule(camera.at(state, i), camera.at(state, i), radius_px);
        }
    }
}

/// A pin whose way was drawn because it moved, and that was let go.
bool is_former_pin(const SceneView& view, std::size_t i, double time_s) {
    const System& system = *view.system;
    return view.style.trail_of.empty() && system.is_pinned(i) && !system.is_pinned_at(i, time_s) &&
           free_end(system, system.bodies[body_of(system, i)]) != i;
}

}  // namespace

std::optional<std::size_t> free_end(const System& system, const Body& body) {
    const bool is_closed = body.link_count == body.particle_count;
    if (body.is_net || is_closed) return std::nullopt;
    const std::size_t first = body.first_particle;
    const std::size_t last = first + body.particle_count - 1;
    if (!system.stays_pinned(last)) return last;
    return system.stays_pinned(first) ? std::nullopt : std::optional(first);
}

std::vector<std::size_t> free_ends(const System& system) {
    std::vector<std::size_t> ends;
    for (const Body& body : system.bodies)
        if (const auto end = free_end(system, body)) ends.push_back(*end);
    return ends;
}

std::vector<std::size_t> traced_particles(const System& system, const StyleDef& style) {
    if (style.trail_s == 0.0) return {};
    std::vector<std::size_t> particles;
    if (style.trail_of.empty()) {
        particles = free_ends(system);
        for (const MoveDef& move : system.moves) particles.push_back(move.pin);
        return particles;
    }
    std::vector<bool> is_traced(system.particle_count());
    for (const Body& body : system.bodies) {
        const auto count = static_cast<std::int64_t>(body.particle_count);
        for (const std::int64_t i : style.trail_of) {
            if (i < -count || i >= count) continue;
            const std::size_t particle =
                body.first_particle + static_cast<std::size_t>(i < 0 ? i + count : i);
            if (!is_traced[particle]) particles.push_back(particle);
            is_traced[particle] = true;
        }
    }
    return particles;
}

SceneView make_scene_view(const System& system, Vec2 gravity_m_s2, const StyleDef& style,
                          const std::vector<BodyStyleDef>& body_styles, int width_px, int height_px,
                          const WholeMotion& motion) {
    const double side_px = std::min(width_px, height_px);
    const double rope_width_px =
        style.rope_width_px.value_or(std::max(kMinLineWidthPx, kRopeWidth * side_px));
    const double net_width_px =
        style.net_width_px.value_or(style.rope_width_px ? kNetWidthPerRopeWidth * rope_width_px
                                                        : std::max(kMinLineWidthPx, kNetWidth * side_px));
    SceneView view{
        &system,      gravity_m_s2, style,         theme_colors(style), width_px,
        height_px,    side_px,      rope_width_px, motion.scale,        traced_particles(system, style),
        motion.arrows};
    std::size_t next_color = 0;
    std::vector<double> line_px;
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
        const Body& body = system.bodies[i];
        const BodyStyleDef own = i < body_styles.size() ? body_styles[i] : BodyStyleDef{};
        const double body_px = own.width_px.value_or(body.is_net ? net_width_px : rope_width_px);
        const double end_px = own.width_px ? own.end_width_px.value_or(body_px) : body_px;
        const auto marker_px = [&](double rim) {
            return style.marker_radius_px.value_or(0.5 * body_px + rim * side_px);
        };
        const bool by_link = style.color_by == ColorBy::kLink && !own.link_colors.empty();
        Color color = by_link ? own.link_colors.front() : own.color.value_or(view.colors.support);
        if (!by_link && !own.color && !quantity_of(style.color_by))
            color = view.colors.palette[next_color++ % view.colors.palette.size()];
        BodyView& drawn = view.bodies.emplace_back(
            BodyView{color, by_link ? own.link_colors : std::vector<Color>{}, 0.5 * body_px, 0.5 * end_px,
                     marker_px(kPinnedRim), marker_px(kFreeRim), i > 0 && own.merged, own.label_at});
        if (style.payload) drawn.balls = balls_of(system, body, drawn, style, side_px);
        drawn.dots = dots_of(system, body, drawn);
        view.ball_count += drawn.balls.size();
        line_px.push_back(drawn.radius_px);
    }
    if (style.color_by == ColorBy::kBody) color_merged(style, body_styles, view.bodies);
    if (style.supports && !motion.bounds.empty())
        view.supports = Supports(system, gravity_m_s2, motion.bounds, side_px, line_px);
    return view;
}

std::vector<Color> body_colors(const SceneView& view) {
    std::vector<Color> colors;
    for (const BodyView& body : view.bodies) colors.push_back(body.color);
    return colors;
}

std::vector<Drawn> drawn(const SceneView& view, std::span<const MotionBounds> bounds) {
    std::vector<Drawn> all = drawn_bodies(view, bounds);
    view.supports.list(all);
    view.arrows.list(all);
    return all;
}

std::vector<Drawn> drawn_bodies(const SceneView& view, std::span<const MotionBounds> bounds) {
    std::vector<Drawn> all;
    for (std::size_t b = 0; b < view.bodies.size(); ++b) {
        const Body& body = view.system->bodies[b];
        const BodyView& look = view.bodies[b];
        MotionBounds lines;
        for (std::size_t i = 0; i < body.particle_count; ++i) lines.include(bounds[body.first_particle + i]);
        if (body.material.is_string) include_slack(view, body, bounds, lines);
        double radius_px = std::max(look.radius_px, look.end_radius_px);
        if (view.style.markers != Markers::kNone)
            radius_px = std::max(radius_px, look.pinned_marker_radius_px);
        all.push_back(around(lines, radius_px));
        for (const Ball& ball : look.balls)
            all.push_back(around(bounds[ball.particle].widened(ball.radius_m), ball.radius_px));
    }
    return all;
}

void draw(const SceneView& view, const State& state, const Camera& camera, DrawList& list,
          std::span<const Trail> trails) {
    start(view, list);
    draw_trails(view, trails, state.time_s, camera, list);
    draw_pose(view, state, camera, list);
    draw_supports(view, state, camera, list);
}

void start(const SceneView& view, DrawList& list) {
    list.width = view.width_px;
    list.height = view.height_px;
    list.ground = view.colors.ground;
    list.clear();
}

void draw_trails(const SceneView& view, std::span<const Trail> trails, double time_s, const Camera& camera,
                 DrawList& list) {
    if (trails.empty()) return;
    double points = 1.0;
    for (const Trail& trail : trails) points += static_cast<double>(trail.size());
    const double max_pieces = std::clamp(kPiecesOfTrails / points, kMinPiecesPerPoint, kMaxPiecesPerPoint);
    const double slope_px = view.style.trail_s * camera.pixels_per_metre();
    std::vector<FadingPoint> path;
    for (std::size_t i = 0; i < view.traced.size(); ++i) {
        check_cancelled();
        if (is_former_pin(view, view.traced[i], time_s)) continue;
        const std::size_t b = body_of(*view.system, view.traced[i]);
        path.clear();
        for (const auto& [age_s, at_m, velocity_m_s] : trails[i])
            path.push_back({{camera.x_px(at_m.x), camera.y_px(at_m.y)},
                            1.0 - age_s / view.style.trail_s,
                            {slope_px * velocity_m_s.x, -slope_px * velocity_m_s.y}});
        const Body& body = view.system->bodies[b];
        const std::size_t number = std::max<std::size_t>(view.traced[i] - body.first_particle, 1);
        const std::size_t link = body.first_bar + std::min(number, body.link_count) - 1;
        add_trail(path,
                  std::max(kMinTrailRadiusPx, kTrailPerLine * link_radius_px(body, view.bodies[b], link)),
                  view.bodies[b].color, list, max_pieces);
    }
}

void draw_bodies(const SceneView& view, std::size_t first, std::size_t end, const State& state,
                 const Camera& camera, DrawList& list) {
    const bool is_one = end - first == 1;
    const bool is_tinted = view.scale || !is_one || !view.bodies[first].link_colors.empty();
    list.add_layer(view.bodies[first].color, is_tinted);
    const double outline_px = kOutlineWidth * view.side_px;
    const auto inside_px = [&](const Ball& ball) { return ball.radius_in(camera) - 0.5 * outline_px; };
    for (std::size_t b = first; b < end; ++b) {
        // Only the background is behind the first body.
        const double halo_per_radius = view.style.halo && first > 0 ? kHaloPerWidth * 2.0 : 0.0;
        draw_links(view, b, is_tinted, halo_per_radius, state, camera, list);
        for (const Ball& ball : view.bodies[b].balls) {
            if (view.system->is_pinned_at(ball.particle, state.time_s)) continue;
            Tint tint = is_tinted ? tint_of(view, b, ball.link, state) : Tint{};
            if (is_one) tint.weight = kBallWeight;
            const PixelPoint at = camera.at(state, ball.particle);
            list.add_capsule(at, at, inside_px(ball), halo_per_radius * view.bodies[b].radius_px, tint);
        }
    }
    if (!is_one || view.bodies[first].balls.empty() || view.ball_count > kMaxOutlines) return;
    list.add_layer(view.colors.outline);
    for (const Ball& ball : view.bodies[first].balls)
        if (!view.system->is_pinned_at(ball.particle, state.time_s))
            list.add_ring(camera.at(state, ball.particle), inside_px(ball), outline_px);
}

void draw_pose(const SceneView& view, const State& state, const Camera& camera, DrawList& list) {
    if (view.style.bars == Bars::kAll) draw_bars(view, false, state, camera, list);
    // Sums of tints are exact up to 257 capsules in a pixel: two links and a ball of each body.
    constexpr std::size_t kMaxMerged = 64;
    for (std::size_t first = 0, end = 0; first < view.bodies.size(); first = end) {
        end = end_of_merged(view.bodies, first, kMaxMerged);
        draw_bodies(view, first, end, state, camera, list);
    }
    if (view.style.bars != Bars::kNone) draw_bars(view, true, state, camera, list);
    if (view.style.markers == Markers::kAll) draw_markers(view, false, state, camera, list);
    view.arrows.draw(state, camera, list);
}

void draw_supports(const SceneView& view, const State& state, const Camera& camera, DrawList& list,
                   std::optional<double> first_s) {
    list.add_layer(view.colors.support);
    view.supports.draw(state, first_s.value_or(state.time_s), camera, list);
    if (view.style.markers != Markers::kNone) draw_markers(view, true, state, camera, list);
}

}  // namespace corda::view
