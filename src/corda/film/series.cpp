#include "corda/film/series.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "corda/core/direction.hpp"
#include "corda/film/motion.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::film {
namespace {

std::vector<std::size_t> particles_of(const System& system, const Body& body, bool are_pinned) {
    std::vector<std::size_t> particles;
    for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i)
        if (are_pinned ? system.is_pinned(i) : !system.stays_pinned(i)) particles.push_back(i);
    return particles;
}

/// The first one of those that are closest to the mean, up to rounding.
std::size_t most_central(const System& system, const std::vector<std::size_t>& particles) {
    constexpr double kSame = 1e-9;
    Vec2 mean_m;
    for (const std::size_t i : particles)
        mean_m = mean_m + (1.0 / static_cast<double>(particles.size())) * Vec2{system.x_m[i], system.y_m[i]};
    std::size_t nearest = particles.front();
    double least_m2 = HUGE_VAL;
    for (const std::size_t i : particles) {
        const Vec2 way_m = Vec2{system.x_m[i], system.y_m[i]} - mean_m;
        if (dot(way_m, way_m) >= (1.0 - kSame) * least_m2) continue;
        least_m2 = dot(way_m, way_m);
        nearest = i;
    }
    return nearest;
}

}  // namespace

std::vector<TrackedParticle> tracked_particles(const System& system, std::size_t most) {
    const std::vector<std::size_t> ends = view::free_ends(system);
    std::vector<TrackedParticle> all;
    for (std::size_t b = 0; b < system.bodies.size() && all.size() < most; ++b) {
        const Body& body = system.bodies[b];
        const std::vector<std::size_t> free = particles_of(system, body, false);
        if (free.empty()) continue;
        const auto end = std::ranges::find_if(ends, [&](std::size_t i) {
            return i >= body.first_particle && i < body.first_particle + body.particle_count;
        });
        TrackedParticle& tracked = all.emplace_back();
        tracked.body = b;
        tracked.is_free_end = end != ends.end();
        tracked.particle = tracked.is_free_end ? *end
                           : body.is_net       ? most_central(system, free)
                                               : free[free.size() / 2];
        const std::vector<std::size_t> pins = particles_of(system, body, true);
        if (pins.size() == 1) tracked.pin = pins.front();
    }
    return all;
}

view::CurvePoint turning_of(const TrackedParticle& tracked, const State& state,
                            const view::CurvePoint* last) {
    constexpr double kTurn = 2.0 * std::numbers::pi;
    const std::size_t i = tracked.particle;
    const std::size_t pin = tracked.pin.value_or(i);
    const double dx_m = state.x_m[i] - state.x_m[pin];
    const double dy_m = state.y_m[i] - state.y_m[pin];
    const double vx_m_s = state.vx_m_s[i] - (tracked.pin ? state.vx_m_s[pin] : 0.0);
    const double vy_m_s = state.vy_m_s[i] - (tracked.pin ? state.vy_m_s[pin] : 0.0);
    const double rate = (dx_m * vy_m_s - dy_m * vx_m_s) / (dx_m * dx_m + dy_m * dy_m);
    double angle = angle_rad(dx_m, -dy_m);
    if (last != nullptr) {
        // The geometric mean of the rates is that of a uniform rotation; past the pin in a straight line, it
        // gives the sine of the turn.
        const double square = last->y * rate;
        const double mean = square > 0.0 ? std::copysign(std::sqrt(square), rate) : 0.0;
        const double expected = last->x + mean * (state.time_s - last->time_s);
        if (std::isfinite(expected)) angle += kTurn * std::round((expected - angle) / kTurn);
    }
    return {state.time_s, angle, rate};
}

std::size_t tip_of(const System& system) {
    const std::vector<std::size_t> ends = view::free_ends(system);
    if (!ends.empty()) return ends.front();
    const std::vector<TrackedParticle> tracked = tracked_particles(system);
    return tracked.empty() ? 0 : tracked.front().particle;
}

SeriesSource::SeriesSource(const Motion& of) : motion(of), tip(tip_of(of.system)), tips{tip, tip} {
    for (const TrackedParticle& tracked : tracked_particles(of.system, of.system.bodies.size()))
        if (tracked.body < tips.size()) tips[tracked.body] = tracked.particle;
}

Instant::Instant(const SeriesSource& of, const State& at, const Figures& its)
    : source(of),
      state(at),
      figures(its),
      energy(at.vx_m_s.empty() ? Energy{SeriesTable::kNone, SeriesTable::kNone, SeriesTable::kNone}
                               : of.motion.energy_of(at)) {}

Vec2 Instant::tip_m() const {
    return source.motion.system.origin_m + Vec2{state.x_m[source.tip], state.y_m[source.tip]};
}

double Instant::tip_distance_m() const {
    const auto [a, b] = source.tips;
    return sim::length(state.x_m[a] - state.x_m[b], state.y_m[a] - state.y_m[b]);
}

}  // namespace corda::film
