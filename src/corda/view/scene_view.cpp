#include "corda/view/scene_view.hpp"

#include <algorithm>
#include <utility>

#include "corda/core/basics.hpp"
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

std::vector<std::size_t> traced_by(const StyleDef& style, const System& system,
                                   const std::vector<std::size_t>& free_ends) {
    if (style.trail_s == 0.0) return {};
    if (style.trail_of.empty()) return free_ends;
    std::vector<std::size_t> particles;
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

Drawn around(const MotionBounds& bounds, double radius_px) {
    return {bounds, radius_px, radius_px, radius_px, radius_px};
}

}  // namespace

std::vector<std::size_t> free_ends(const System& system) {
    std::vector<std::size_t> ends;
    for (const Body& body : system.bodies) {
        const bool is_closed = body.link_count == body.particle_count;
        if (body.is_net || is_closed) continue;
        const std::size_t first = body.first_particle;
        const std::size_t last = first + body.particle_count - 1;
        if (!system.is_pinned(last))
            ends.push_back(last);
        else if (!system.is_pinned(first))
            ends.push_back(first);
    }
    return ends;
}

SceneView::SceneView(const System& system, Vec2 gravity_m_s2, const StyleDef& style,
                     const std::vector<BodyStyleDef>& body_styles, int width, int height)
    : system_(&system),
      gravity_m_s2_(gravity_m_s2),
      style_(style),
      look_(look_of(style)),
      width_(width),
      height_(height),
      side_px_(std::min(width, height)),
      rope_width_px_(style.rope_width_px.value_or(std::max(kMinLineWidthPx, kRopeWidth * side_px_))),
      free_ends_(free_ends(system)),
      traced_(traced_by(style, system, free_ends_)),
      arrows_(system, gravity_m_s2, style, side_px_) {
    const double net_width_px =
        style.net_width_px.value_or(style.rope_width_px ? kNetWidthPerRopeWidth * rope_width_px_
                                                        : std::max(kMinLineWidthPx, kNetWidth * side_px_));
    std::size_t next_color = 0;
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
        const Body& body = system.bodies[i];
        const BodyStyleDef own = i < body_styles.size() ? body_styles[i] : BodyStyleDef{};
        const double width_px = own.width_px.value_or(body.is_net ? net_width_px : rope_width_px_);
        const double end_width_px = own.width_px ? own.end_width_px.value_or(width_px) : width_px;
        const bool by_link = style.color_by == ColorBy::kLink && !own.link_colors.empty();
        Color color = by_link ? own.link_colors.front() : own.color.value_or(look_.support);
        if (!by_link && !own.color && !quantity_of(style.color_by))
            color = look_.palette[next_color++ % look_.palette.size()];
        bodies_.push_back({color,
                           by_link ? own.link_colors : std::vector<Color>{},
                           0.5 * width_px,
                           0.5 * end_width_px,
                           i > 0 && own.merged,
                           own.label_at,
                           {}});
        bodies_.back().balls = balls_of(i);
        ball_count_ += bodies_.back().balls.size();
    }
    if (style.color_by == ColorBy::kBody) color_merged(body_styles);
}

void SceneView::color_merged(const std::vector<BodyStyleDef>& body_styles) {
    const ColorScale scale = scale_of(Quantity::kSpeed, {}, style_);
    for (std::size_t first = 0, end = 0; first < bodies_.size(); first = end) {
        for (end = first + 1; end < bodies_.size() && bodies_[end].is_merged;) ++end;
        for (std::size_t i = first; i < end && end - first > 1; ++i) {
            const double share = static_cast<double>(i - first) / static_cast<double>(end - first - 1);
            if (i >= body_styles.size() || !body_styles[i].color)
                bodies_[i].color = scale.color(scale.low + share * (scale.high - scale.low));
        }
    }
}

double SceneView::link_radius_px(std::size_t body, std::size_t link) const {
    const BodyLook& look = bodies_[body];
    const Body& of = system_->bodies[body];
    const double share = static_cast<double>(link - of.first_bar) /
                         static_cast<double>(std::max<std::size_t>(of.link_count, 2) - 1);
    return look.radius_px + share * (look.end_radius_px - look.radius_px);
}

std::vector<SceneView::Ball> SceneView::balls_of(std::size_t b) const {
    const Body& body = system_->bodies[b];
    std::vector<Ball> balls;
    if (!style_.payload || body.is_net) return balls;
    const std::size_t last = body.first_particle + body.particle_count - 1;
    double rope_kg = -body.payload_kg;
    for (std::size_t i = body.first_particle; i <= last; ++i) rope_kg += system_->mass_kg[i];
    for (std::size_t i = body.first_particle; i <= last; ++i) {
        const bool is_bob = body.link_count <= kLinksOfPendulum;
        const bool has_payload = i == last && body.payload_kg > 0.0;
        if (system_->is_pinned(i) || !(is_bob || has_payload)) continue;
        const double mass_kg = is_bob ? system_->mass_kg[i] : body.payload_kg;
        const double radius_px = ball_radius(mass_kg, rope_kg) * side_px_;
        const std::size_t link =
            body.first_bar + std::max(i, body.first_particle + 1) - body.first_particle - 1;
        balls.push_back({i, link, std::max(radius_px, kBallPerLine * link_radius_px(b, link))});
    }
    return balls;
}

BodyLabel SceneView::label_at(std::size_t particle, std::string text) const {
    const std::size_t b = body_of(*system_, particle);
    double clear_px = std::max(bodies_[b].radius_px, bodies_[b].end_radius_px);
    for (const Ball& ball : bodies_[b].balls)
        if (ball.particle == particle) clear_px = ball.radius_px;
    const bool is_end = std::ranges::binary_search(free_ends_, particle);
    const std::size_t next = particle == system_->bodies[b].first_particle ? particle + 1 : particle - 1;
    return {std::move(text), particle, is_end ? next : particle, clear_px};
}

BodyLabel SceneView::label_of(std::size_t b) const {
    const Body& body = system_->bodies[b];
    const std::size_t end = body.first_particle + body.particle_count;
    const auto first_pin = [&](const Body& of) {
        std::size_t i = of.first_particle;
        while (i < of.first_particle + of.particle_count && !system_->is_pinned(i)) ++i;
        return i;
    };
    const std::size_t pin = first_pin(body);
    const auto shares_pin = [&](const Body& other) {
        const std::size_t other_pin = first_pin(other);
        const auto b_of_other = static_cast<std::size_t>(&other - system_->bodies.data());
        return &other != &body && !other.label.empty() && bodies_[b_of_other].label_at != LabelAt::kEnd &&
               other_pin < other.first_particle + other.particle_count &&
               system_->x_m[other_pin] == system_->x_m[pin] && system_->y_m[other_pin] == system_->y_m[pin];
    };
    const auto free = std::lower_bound(free_ends_.begin(), free_ends_.end(), body.first_particle);
    const bool has_free_end = free != free_ends_.end() && *free < end;
    const bool is_shared = std::ranges::any_of(system_->bodies, shares_pin);
    const LabelAt place =
        bodies_[b].label_at.value_or(pin == end || is_shared ? LabelAt::kEnd : LabelAt::kPin);
    if (has_free_end && (pin == end || place == LabelAt::kEnd)) return label_at(*free, body.label);
    if (pin == end) return {body.label, body.first_particle, body.first_particle, bodies_[b].radius_px};
    std::vector<Drawn> supports;
    supports_.list(supports);
    double clear_px = marker_radius_px(b, true);
    for (const Drawn& support : supports) clear_px = std::max(clear_px, support.up_px);
    return {body.label, pin, pin, clear_px};
}

std::vector<BodyLabel> SceneView::labels() const {
    std::vector<BodyLabel> labels;
    for (std::size_t b = 0; b < bodies_.size(); ++b)
        if (!system_->bodies[b].label.empty()) labels.push_back(label_of(b));
    const auto is_above = [this](const BodyLabel& label, const BodyLabel& other) {
        return label.particle == label.from && other.particle == other.from &&
               system_->x_m[label.particle] == system_->x_m[other.particle] &&
               system_->y_m[label.particle] == system_->y_m[other.particle];
    };
    for (auto label = labels.begin(); label != labels.end(); ++label)
        label->row = static_cast<int>(std::count_if(
            labels.begin(), label, [&](const BodyLabel& other) { return is_above(*label, other); }));
    return labels;
}

std::vector<Color> SceneView::body_colors() const {
    std::vector<Color> colors;
    for (const BodyLook& body : bodies_) colors.push_back(body.color);
    return colors;
}

void SceneView::set_motion(std::span<const MotionBounds> motion) {
    if (!style_.supports) return;
    std::vector<double> line_px;
    for (const BodyLook& body : bodies_) line_px.push_back(body.radius_px);
    supports_ = Supports(*system_, gravity_m_s2_, motion, side_px_, line_px);
}

double SceneView::marker_radius_px(std::size_t body, bool pinned) const {
    const double rim = pinned ? kPinnedRim : kFreeRim;
    return style_.marker_radius_px.value_or(bodies_[body].radius_px + rim * side_px_);
}

std::vector<Drawn> SceneView::drawn(std::span<const MotionBounds> motion) const {
    std::vector<Drawn> all = drawn_bodies(motion);
    supports_.list(all);
    arrows_.list(all);
    return all;
}

std::vector<Drawn> SceneView::drawn_bodies(std::span<const MotionBounds> motion) const {
    std::vector<Drawn> all;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        const Body& body = system_->bodies[b];
        MotionBounds bounds;
        for (std::size_t i = 0; i < body.particle_count; ++i) bounds.include(motion[body.first_particle + i]);
        if (body.material.is_string) include_slack(body, motion, bounds);
        double radius_px = std::max(bodies_[b].radius_px, bodies_[b].end_radius_px);
        if (style_.markers != Markers::kNone) radius_px = std::max(radius_px, marker_radius_px(b, true));
        all.push_back(around(bounds, radius_px));
        for (const Ball& ball : bodies_[b].balls)
            all.push_back(around(motion[ball.particle], ball.radius_px));
    }
    return all;
}

void SceneView::include_slack(const Body& body, std::span<const MotionBounds> motion,
                              MotionBounds& bounds) const {
    // Along any axis, twice the coordinate of a point of the arc is at most the sum of those of its ends and
    // the length. That is what a string reaches anyway, if it ever hangs taut.
    const Vec2 g = gravity_m_s2_;
    const bool anywhere = g == Vec2{};
    for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k) {
        const Bar& link = system_->bars[k];
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

void SceneView::draw_trails(std::span<const Trail> trails, const Camera& camera, DrawList& list) const {
    if (trails.empty()) return;
    double points = 1.0;
    for (const Trail& trail : trails) points += static_cast<double>(trail.size());
    const double max_pieces = std::clamp(kPiecesOfTrails / points, kMinPiecesPerPoint, kMaxPiecesPerPoint);
    const double slope_px = style_.trail_s * camera.pixels_per_metre();
    std::vector<FadingPoint> path;
    for (std::size_t i = 0; i < traced_.size(); ++i) {
        check_cancelled();
        const std::size_t b = body_of(*system_, traced_[i]);
        path.clear();
        for (const auto& [age_s, at_m, velocity_m_s] : trails[i])
            path.push_back({{camera.x_px(at_m.x), camera.y_px(at_m.y)},
                            1.0 - age_s / style_.trail_s,
                            {slope_px * velocity_m_s.x, -slope_px * velocity_m_s.y}});
        const Body& body = system_->bodies[b];
        const std::size_t number = std::max<std::size_t>(traced_[i] - body.first_particle, 1);
        const std::size_t link = body.first_bar + std::min(number, body.link_count) - 1;
        add_trail(path, std::max(kMinTrailRadiusPx, kTrailPerLine * link_radius_px(b, link)),
                  bodies_[b].color, list, max_pieces);
    }
}

void SceneView::draw(const State& state, const Camera& camera, DrawList& list,
                     std::span<const Trail> trails) const {
    start(list);
    draw_trails(trails, camera, list);
    draw_pose(state, camera, list);
    draw_supports(state, camera, list);
}

void SceneView::start(DrawList& list) const {
    list.width = width_;
    list.height = height_;
    list.ground = look_.ground;
    list.clear();
}

void SceneView::draw_pose(const State& state, const Camera& camera, DrawList& list) const {
    const Positions positions(state, camera);
    if (style_.bars == Bars::kAll) draw_bars(false, positions, list);
    // Sums of tints are exact up to 257 capsules in a pixel: two links and a ball of each body.
    constexpr std::size_t kMaxMerged = 64;
    for (std::size_t first = 0, end = 0; first < bodies_.size(); first = end) {
        for (end = first + 1; end < bodies_.size() && bodies_[end].is_merged && end - first < kMaxMerged;)
            ++end;
        draw_bodies(first, end, positions, list);
    }
    if (style_.bars != Bars::kNone) draw_bars(true, positions, list);
    if (style_.markers == Markers::kAll) draw_markers(false, positions, list);
    arrows_.draw(state, camera, list);
}

void SceneView::draw_supports(const State& state, const Camera& camera, DrawList& list) const {
    list.add_layer(look_.support);
    supports_.draw(camera, list);
    if (style_.markers != Markers::kNone) draw_markers(true, Positions(state, camera), list);
}

Tint SceneView::tint_of(std::size_t body, std::size_t link, const State& state) const {
    const Body& of = system_->bodies[body];
    const std::vector<Color>& in_turn = bodies_[body].link_colors;
    Color color = bodies_[body].color;
    if (scale_)
        color = scale_->color(sim::kind_of(scale_->quantity).value(*system_, of, link, state));
    else if (!in_turn.empty())
        color = in_turn[(link - of.first_bar) % in_turn.size()];
    return {color.r, color.g, color.b};
}

void SceneView::draw_links(std::size_t i, bool is_tinted, double halo_per_radius, const Positions& positions,
                           DrawList& list) const {
    const Body& body = system_->bodies[i];
    for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k) {
        const Bar& link = system_->bars[k];
        const double radius_px = link_radius_px(i, k);
        const double halo_px = halo_per_radius * radius_px;
        const Tint tint = is_tinted ? tint_of(i, k, positions.state()) : Tint{};
        if (body.material.is_string && positions.distance_m(link) < link.rest_m)
            draw_slack(link, radius_px, halo_px, tint, positions, list);
        else
            list.add_capsule(positions.px(link.a), positions.px(link.b), radius_px, halo_px, tint);
    }
}

void SceneView::draw_bodies(std::size_t first, std::size_t end, const Positions& positions,
                            DrawList& list) const {
    const bool is_one = end - first == 1;
    const bool is_tinted = scale_.has_value() || !is_one || !bodies_[first].link_colors.empty();
    list.add_layer(bodies_[first].color, is_tinted);
    const double outline_px = kOutlineWidth * side_px_;
    const auto inside_px = [&](const Ball& ball) { return ball.radius_px - 0.5 * outline_px; };
    for (std::size_t i = first; i < end; ++i) {
        const BodyLook& look = bodies_[i];
        // Only the background is behind the first body.
        const double halo_per_radius = style_.halo && first > 0 ? kHaloPerWidth * 2.0 : 0.0;
        draw_links(i, is_tinted, halo_per_radius, positions, list);
        const double halo_px = halo_per_radius * look.radius_px;
        for (const Ball& ball : look.balls) {
            Tint tint = is_tinted ? tint_of(i, ball.link, positions.state()) : Tint{};
            if (is_one) tint.weight = kBallWeight;
            list.add_capsule(positions.px(ball.particle), positions.px(ball.particle), inside_px(ball),
                             halo_px, tint);
        }
    }
    if (!is_one || bodies_[first].balls.empty() || ball_count_ > kMaxOutlines) return;
    list.add_layer(look_.outline);
    for (const Ball& ball : bodies_[first].balls)
        list.add_ring(positions.px(ball.particle), inside_px(ball), outline_px);
}

void SceneView::draw_slack(const Bar& link, double radius_px, double halo_px, Tint tint,
                           const Positions& positions, DrawList& list) const {
    const PixelPoint a = positions.px(link.a);
    const PixelPoint b = positions.px(link.b);
    // Without gravity it bends to the left, seen from a.
    Vec2 down{b.y - a.y, a.x - b.x};
    if (gravity_m_s2_ != Vec2{}) down = {gravity_m_s2_.x, -gravity_m_s2_.y};
    const double length = std::max(sim::length(down.x, down.y), 1e-300);
    const Arc arc =
        hang_slack(a, b, link.rest_m * positions.pixels_per_metre(), {down.x / length, down.y / length});
    for (std::size_t k = 0; k + 1 < arc.count; ++k)
        list.add_capsule(arc.points[k], arc.points[k + 1], radius_px, halo_px, tint);
}

void SceneView::draw_bars(bool real, const Positions& positions, DrawList& list) const {
    const double width_px =
        style_.bar_width_px.value_or(std::max(kMinBarWidthPx, kBarWidthPerRopeWidth * rope_width_px_));
    list.add_layer(real ? look_.real_bar : look_.imaginary_bar);
    for (const Bar& bar : system_->bars) {
        if ((bar.reach == 1) == real)
            list.add_capsule(positions.px(bar.a), positions.px(bar.b), 0.5 * width_px);
    }
}

void SceneView::draw_markers(bool pinned, const Positions& positions, DrawList& list) const {
    list.add_layer(pinned ? look_.pinned : look_.free);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        const Body& body = system_->bodies[b];
        const double radius_px = marker_radius_px(b, pinned);
        for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i) {
            if (system_->is_pinned(i) == pinned)
                list.add_capsule(positions.px(i), positions.px(i), radius_px);
        }
    }
}

}  // namespace corda::view
