#include "corda/view/arrows.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "corda/view/colors.hpp"
#include "corda/view/number_text.hpp"

namespace corda::view {
namespace {

// Sizes as shares of the frame's shorter side.
constexpr double kLongest = 0.22;
// Parallel ones, or those along a rope, would cover each other.
constexpr double kLongestWeight = 0.12;
constexpr double kLongestTension = 0.14;
constexpr double kShaft = 1.0 / 480.0;  // half of its width
constexpr double kMinShaftPx = 0.75;

// Sizes as shares of half of the shaft's width.
constexpr double kHeadLength = 7.0;
constexpr double kHeadWidth = 2.8;  // half of it
constexpr double kHeadLine = 0.6;
constexpr double kHalo = 0.8;

/// Share of the shorter side that arrows of a given scale are not longer than.
constexpr double kMost = 0.5;

/// Arrows are cut above this multiple of the largest one in this share of the instants.
constexpr double kCut = 1.5;
constexpr double kUsual = 0.9;
constexpr double kRounding = 1e-9;  // of the largest arrow; instants with less do not count

constexpr std::size_t kMaxArrows = 60;
constexpr std::size_t kMaxPerRope = 12;

double shaft_px(double side_px) {
    return std::max(kMinShaftPx, kShaft * side_px);
}

/// A number >= 0, rounded up to 4 bits.
double to_four_bits(double value) {
    constexpr int kBits = 4;
    int exponent = 0;
    const double bits = std::ceil(std::ldexp(std::frexp(value, &exponent), kBits));
    return std::ldexp(bits, exponent - kBits);
}

/// Free particles at even distances in their order, with the last one.
std::vector<std::size_t> chosen(const System& system, const Body& body, std::size_t count) {
    std::vector<std::size_t> free;
    for (std::size_t i = body.first_particle + body.particle_count; i-- > body.first_particle;)
        if (!system.stays_pinned(i)) free.push_back(i);
    const std::size_t stride = std::max<std::size_t>(1, (free.size() + count - 1) / count);
    std::vector<std::size_t> some;
    for (std::size_t k = 0; k < free.size(); k += stride) some.push_back(free[k]);
    return some;
}

ArrowScale arrow_scale_of(const ArrowExtents& extents, const StyleDef& style, double side_px) {
    const double fitted = extents.longest();
    if (!(fitted > 0.0)) return {};
    if (!style.arrow_scale_px) {
        const double share = style.arrows == Arrows::kWeight    ? kLongestWeight
                             : style.arrows == Arrows::kTension ? kLongestTension
                                                                : kLongest;
        return {side_px * share / fitted, fitted, extents.is_cut()};
    }
    const double most = round_number_below(kMost * side_px / *style.arrow_scale_px).value();
    const double longest = std::min(to_four_bits(extents.largest()), most);
    return {*style.arrow_scale_px, longest, longest < extents.largest()};
}

}  // namespace

void ArrowExtents::include(std::span<const Arrow> arrows, bool is_instant) {
    double largest = 0.0;
    for (const Arrow& arrow : arrows) {
        largest = std::max(largest, sim::length(arrow.value.x, arrow.value.y));
        const double sides[] = {-arrow.value.x, arrow.value.x, arrow.value.y, -arrow.value.y};
        for (std::size_t side = 0; side < starts_.size(); ++side)
            if (sides[side] > 0.0)
                starts_[side][to_four_bits(sides[side])].include(arrow.at_m.x, arrow.at_m.y);
    }
    largest_ = std::max(largest_, largest);
    if (is_instant) instants_.push_back(largest);
}

double ArrowExtents::longest() const {
    std::vector<double> sizes = instants_;
    std::erase_if(sizes, [this](double size) { return size <= kRounding * largest_; });
    if (sizes.empty()) return to_four_bits(largest_);
    const auto usual =
        sizes.begin() + static_cast<std::ptrdiff_t>(kUsual * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), usual, sizes.end());
    return std::min(to_four_bits(largest_), rounded_end(kCut * *usual));
}

void ArrowExtents::list(double longest, double pixels_per_unit, double head_px,
                        std::vector<Drawn>& drawn) const {
    constexpr double Drawn::*kSides[] = {&Drawn::left_px, &Drawn::right_px, &Drawn::up_px, &Drawn::down_px};
    for (std::size_t side = 0; side < starts_.size(); ++side) {
        for (const auto& [extent, starts] : starts_[side]) {
            drawn.push_back({starts, head_px, head_px, head_px, head_px});
            drawn.back().*kSides[side] += std::min(extent, longest) * pixels_per_unit;
        }
    }
}

void add_arrow(PixelPoint from, PixelPoint to, double side_px, bool has_halo, bool is_cut, DrawList& list) {
    const double length_px = sim::length(to.x - from.x, to.y - from.y);
    if (!(length_px >= 1.0)) return;
    const PixelPoint along{(to.x - from.x) / length_px, (to.y - from.y) / length_px};
    const double line_px = std::min(shaft_px(side_px), length_px / kHeadLength);
    const auto at = [&](double back, double across) {  // from the tip
        return PixelPoint{to.x - line_px * (back * along.x + across * along.y),
                          to.y - line_px * (back * along.y - across * along.x)};
    };
    const double halo_px = has_halo ? kHalo * line_px : 0.0;
    list.add_capsule(from, at(kHeadLength - 1.0, 0.0), line_px, halo_px);
    for (int head = 0; head <= (is_cut ? 1 : 0); ++head) {
        for (const double share : {1.0, 0.6, 0.2}) {  // triangles, whose lines fill the head
            const double back = head * kHeadLength;
            const PixelPoint corners[] = {at(back + kHeadLine, 0.0),
                                          at(back + kHeadLength, share * kHeadWidth),
                                          at(back + kHeadLength, -share * kHeadWidth)};
            for (std::size_t i = 0; i < 3; ++i)
                list.add_capsule(corners[i], corners[(i + 1) % 3], kHeadLine * line_px, halo_px);
        }
    }
}

ArrowPlaces::ArrowPlaces(const System& system, Vec2 gravity_m_s2, Arrows kind)
    : system_(&system), gravity_m_s2_(gravity_m_s2), kind_(kind) {
    const std::size_t bodies = kind_ == Arrows::kNone ? 0 : system.bodies.size();
    for (std::size_t b = 0; b < bodies; b += (bodies + kMaxArrows - 1) / kMaxArrows) {
        const Body& body = system.bodies[b];
        const std::size_t most = std::clamp<std::size_t>(kMaxArrows / bodies, 1, kMaxPerRope);
        std::size_t before = 0;  // the bar of the place before, which is nearer to the end
        const std::vector<std::size_t> particles = chosen(system, body, body.is_net ? 3 * most : most);
        for (const std::size_t i : particles) {
            if (kind_ != Arrows::kTension) places_.push_back({i, 0, HUGE_VAL, HUGE_VAL});
            const bool both = body.is_net || body.link_count <= kLinksOfPendulum;
            for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k) {
                const bool is_end = system.bars[k].b == i || (both && system.bars[k].a == i);
                if (kind_ != Arrows::kTension || !is_end) continue;
                double path_m = both || i == particles.front() ? HUGE_VAL : 0.0;
                for (std::size_t bar = k; !both && bar++ < before;) path_m += system.bars[bar].rest_m;
                places_.push_back({i, k, path_m, to_support_m(i, k)});
                before = k;
            }
        }
    }
}

double ArrowPlaces::to_support_m(std::size_t particle, std::size_t k) const {
    double path_m = 0.0;
    for (;; --k) {
        const Bar& bar = system_->bars[k];
        path_m += bar.rest_m;
        const std::size_t next = bar.a == particle ? bar.b : bar.a;
        if (system_->is_pinned(next)) return path_m;
        if (k == 0 || system_->bars[k - 1].b != next) return HUGE_VAL;
        particle = next;
    }
}

std::vector<Arrow> ArrowPlaces::of(const State& state, double apart_m) const {
    std::vector<Arrow> arrows;
    double gone_m = HUGE_VAL;
    for (const auto& [i, k, path_m, to_support_m] : places_) {
        gone_m += path_m;
        if (system_->is_pinned_at(i, state.time_s)) continue;
        if (gone_m < apart_m || (path_m < HUGE_VAL && to_support_m < apart_m)) continue;
        const Vec2 at_m{state.x_m[i], state.y_m[i]};
        Vec2 value = system_->mass_kg[i] * gravity_m_s2_;
        if (kind_ == Arrows::kVelocity) {
            value = {state.vx_m_s[i], state.vy_m_s[i]};
        } else if (kind_ == Arrows::kTension) {
            const std::size_t other = system_->bars[k].a == i ? system_->bars[k].b : system_->bars[k].a;
            const Vec2 way_m = Vec2{state.x_m[other], state.y_m[other]} - at_m;
            value = state.tension_n[k] / sim::length(way_m.x, way_m.y) * way_m;
        }
        const bool is_shown = std::isfinite(value.x) && std::isfinite(value.y) && value != Vec2{};
        if (!is_shown) continue;
        gone_m = 0.0;
        arrows.push_back({at_m, value, to_support_m});
    }
    return arrows;
}

ArrowLayer::ArrowLayer(ArrowPlaces places, const StyleDef& style, double side_px, const ArrowExtents& extents)
    : places_(std::move(places)),
      color_(arrow_color(style)),
      side_px_(side_px),
      extents_(extents),
      scale_(arrow_scale_of(extents, style, side_px)),
      usual_(scale_.is_cut ? scale_.longest / kCut : scale_.longest) {}

void ArrowLayer::list(std::vector<Drawn>& drawn, const ArrowExtents* extents) const {
    (extents == nullptr ? extents_ : *extents)
        .list(scale_.longest, scale_.pixels_per_unit, (kHeadWidth + kHeadLine) * shaft_px(side_px_), drawn);
}

void ArrowLayer::draw(const State& state, const Camera& camera, DrawList& list) const {
    if (scale_.pixels_per_unit == 0.0) return;
    list.add_layer(color_);
    list.layers.back().is_note = true;
    const double head_px = kHeadLength * shaft_px(side_px_);
    const double apart_px = scale_.pixels_per_unit * usual_ + head_px;
    for (const Arrow& arrow : places_.of(state, apart_px / camera.pixels_per_metre())) {
        const double size = sim::length(arrow.value.x, arrow.value.y);
        const double length_px = scale_.pixels_per_unit * std::min(size, scale_.longest);
        if (length_px < head_px) continue;
        const Vec2 along = (1.0 / size) * arrow.value;
        // A head is longer than a ring is wide.
        const double room_px = arrow.to_support_m * camera.pixels_per_metre() - head_px;
        const double end_px = std::min(length_px, room_px);
        const auto at = [&](double way_px) {
            return PixelPoint{camera.x_px(arrow.at_m.x) + way_px * along.x,
                              camera.y_px(arrow.at_m.y) - way_px * along.y};
        };
        add_arrow(at(end_px - length_px), at(end_px), side_px_, true, size > scale_.longest, list);
    }
}

}  // namespace corda::view
