#include "corda/view/supports.hpp"

#include <algorithm>
#include <cmath>

namespace corda::view {
namespace {

// Sizes as shares of the frame's shorter side.
constexpr double kPlateLength = 0.09;
constexpr double kPlateWidth = 1.0 / 240.0;
constexpr double kHatchHeight = 0.02;
constexpr double kHatchWidth = 1.0 / 400.0;
constexpr double kRingRadius = 1.0 / 72.0;
constexpr double kRingWidth = 1.0 / 270.0;
constexpr double kMinStrokeWidthPx = 1.0;

constexpr double kMaxPlateWidths = 3.0;  // largest width in units of kPlateWidth
constexpr int kStrokes = 7;              // of one plate, in a frame that is large enough
constexpr double kStepPerStroke = 3.0;   // at least, so that there are gaps
constexpr double kRingPerLine = 1.6;     // radius, at least, so that it shows on a wide line

/// Beyond this number, supports are dots: plates would hide the bodies.
constexpr std::size_t kMaxSupports = 1000;

/// Height above a pin, as a share of the body's length, that the plate still hides.
constexpr double kHidden = 0.01;

Vec2 axis_against(Vec2 gravity_m_s2) {
    const Vec2 g = gravity_m_s2;
    if (g.x == 0.0 && g.y == 0.0) return {};
    if (std::abs(g.y) >= std::abs(g.x)) return {0.0, g.y < 0.0 ? 1.0 : -1.0};
    return {g.x < 0.0 ? 1.0 : -1.0, 0.0};
}

double width_px(double share, double side_px) {
    return std::max(kMinStrokeWidthPx, share * side_px);
}

}  // namespace

Supports::Supports(const System& system, Vec2 gravity_m_s2, std::span<const MotionBounds> motion,
                   double side_px, std::span<const double> line_px)
    : side_px_(side_px), up_(axis_against(gravity_m_s2)), has_releases_(!system.release_s.empty()) {
    for (std::size_t i = 0; i < system.bodies.size(); ++i)
        add_pins(system, system.bodies[i], motion, line_px[i]);
    std::ranges::sort(plates_, {}, [this](const Plate& plate) {
        const Local place = local(plate.pin_m);
        return std::pair(place.up, place.along);
    });
}

void Supports::add_pins(const System& system, const Body& body, std::span<const MotionBounds> motion,
                        double line_px) {
    MotionBounds bounds;
    const std::size_t end = body.first_particle + body.particle_count;
    for (std::size_t i = body.first_particle; i < end; ++i) bounds.include(motion[i]);
    const double top_m = std::max(local(bounds.min_m()).up, local(bounds.max_m()).up);
    const double hidden_m = kHidden * links_length_m(system, body);
    for (std::size_t i = body.first_particle; i < end; ++i) {
        // A pinned particle next to a pin of a rope is a clamp.
        const auto release_s = [&](std::size_t pin) {
            return system.release_s.empty() ? HUGE_VAL : system.release_s[pin];
        };
        const bool is_clamped = !body.is_net && i > body.first_particle && system.is_pinned(i - 1) &&
                                release_s(i - 1) >= release_s(i);
        if (!system.is_pinned(i) || is_clamped) continue;
        const Vec2 pin_m{system.x_m[i], system.y_m[i]};
        const bool moves = std::ranges::find(system.moves, i, &MoveDef::pin) != system.moves.end();
        const bool has_plate = !moves && up_ != Vec2{} && top_m <= local(pin_m).up + hidden_m;
        if (has_plate)
            plates_.push_back({pin_m,
                               std::clamp(line_px, width_px(kPlateWidth, side_px_),
                                          kMaxPlateWidths * width_px(kPlateWidth, side_px_)),
                               release_s(i)});
        else
            rings_.push_back({pin_m, std::max(kRingRadius * side_px_, kRingPerLine * line_px), release_s(i),
                              moves ? std::optional(i) : std::nullopt, motion[i]});
    }
}

void Supports::list(std::vector<Drawn>& drawn) const {
    const auto at = [](Vec2 point_m) {
        Drawn support;
        support.bounds.include(point_m.x, point_m.y);
        return support;
    };
    const double half_px = 0.5 * kPlateLength * side_px_;
    for (const Plate& hatched : plates_) {
        const double above_px = hatched.width_px + (kHatchHeight + kHatchWidth) * side_px_;
        Drawn plate = at(hatched.pin_m);
        const auto extent_px = [&](double up) { return up > 0.0 ? above_px : up < 0.0 ? 0.0 : half_px; };
        plate.left_px = extent_px(-up_.x);
        plate.right_px = extent_px(up_.x);
        plate.up_px = extent_px(up_.y);
        plate.down_px = extent_px(-up_.y);
        drawn.push_back(plate);
    }
    for (const Ring& ring : rings_) {
        Drawn circle = at(ring.center_m);
        if (ring.moving) circle.bounds.include(ring.way);
        circle.left_px = circle.right_px = circle.up_px = circle.down_px = ring.radius_px;
        drawn.push_back(circle);
    }
}

void Supports::draw(const State& state, double time_s, const Camera& camera, DrawList& list) const {
    const double length_px = kPlateLength * side_px_;
    const auto at_px = [&](Vec2 v) { return PixelPoint{camera.x_px(v.x), camera.y_px(v.y)}; };
    Supports left;  // without those that are gone; empty if none is
    if (has_releases_) {
        left = *this;
        std::erase_if(left.plates_, [&](const Plate& plate) { return plate.release_s <= time_s; });
        std::erase_if(left.rings_, [&](const Ring& ring) {  // one that moved is elsewhere by now
            return ring.release_s <= (ring.moving ? state.time_s : time_s);
        });
    }
    const std::vector<Plate>& plates = has_releases_ ? left.plates_ : plates_;
    const std::vector<Ring>& rings = has_releases_ ? left.rings_ : rings_;
    if (plates_.size() + rings_.size() > kMaxSupports) {
        const auto dot = [&](PixelPoint at) { list.add_capsule(at, at, width_px(kRingWidth, side_px_)); };
        for (const Plate& plate : plates) dot(at_px(plate.pin_m));
        for (const Ring& ring : rings) dot(at_px(ring.center_at(state)));
        return;
    }
    for (std::size_t i = 0; i < plates.size();) {
        const std::size_t first = i;
        double plate_px = plates[first].width_px;
        const auto touches_next = [&] {
            const Local here = local(plates[i].pin_m);
            const Local next = local(plates[i + 1].pin_m);
            return next.up == here.up && (next.along - here.along) * camera.pixels_per_metre() <= length_px;
        };
        while (i + 1 < plates.size() && touches_next()) plate_px = std::max(plate_px, plates[++i].width_px);
        const double span_m = local(plates[i].pin_m).along - local(plates[first].pin_m).along;
        draw_plate(at_px(plates[first].pin_m), span_m * camera.pixels_per_metre() + length_px, plate_px,
                   list);
        ++i;
    }
    const double ring_px = width_px(kRingWidth, side_px_);
    for (const Ring& ring : rings)
        list.add_ring(at_px(ring.center_at(state)), ring.radius_px - 0.5 * ring_px, ring_px);
}

void Supports::draw_plate(PixelPoint first, double length_px, double plate_px, DrawList& list) const {
    if (!std::isfinite(length_px)) return;  // between pins near the largest of numbers
    const double hatch_px = width_px(kHatchWidth, side_px_);
    const double height_px = kHatchHeight * side_px_;
    // Pixels count y downwards.
    const auto at = [&](double along, double up) {
        const Vec2 right = -1.0 * left_of(up_);
        return PixelPoint{first.x + along * right.x + up * up_.x, first.y - along * right.y - up * up_.y};
    };
    const double left = -0.5 * kPlateLength * side_px_;
    const double inset = 0.5 * plate_px;  // of round caps
    list.add_capsule(at(left + inset, inset), at(left + length_px - inset, inset), 0.5 * plate_px);
    const double step_px =
        std::max((kPlateLength * side_px_ - height_px) / (kStrokes - 1), kStepPerStroke * hatch_px);
    const int strokes = std::max(static_cast<int>(std::round((length_px - height_px) / step_px)), 1) + 1;
    for (int k = 0; k < strokes; ++k) {
        const double x = left + k * (length_px - height_px) / (strokes - 1);
        list.add_capsule(at(x, plate_px), at(x + height_px, plate_px + height_px), 0.5 * hatch_px);
    }
}

}  // namespace corda::view
