#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "corda/figures/chapters.hpp"
#include "corda/figures/chart.hpp"
#include "corda/figures/quantity_text.hpp"

namespace corda::figures {
namespace {

constexpr const char* kTipData = "tip.csv";

std::vector<pipeline::TrackedParticle> followed_of(const MotionSummary& reading) {
    std::vector<pipeline::TrackedParticle> followed;
    for (const BodyCurves& body : reading.bodies) followed.push_back(body.followed);
    return followed;
}

/// Curves that are not over time: dots where lines would be misleading.
std::vector<Curve> tip_curves(const Film& film, const MotionSummary& reading, Thinner BodyCurves::*curve) {
    std::vector<Curve> curves = curves_of(film.scene(), film.system(), reading, curve);
    for (std::size_t i = 0; i < curves.size(); ++i)
        curves[i].is_joined = (reading.bodies[i].*curve).is_joined();
    return curves;
}

/// As thinning_text().
std::string path_thinning_text(const MotionSummary& reading) {
    if (reading.bodies.front().path.is_joined()) return thinning_text(reading);
    return fmt::format(
        " Of the {} rows, {} at most are drawn, as dots: evenly spread ones, the last, and where x or y is "
        "least or largest. The CSV has all rows.",
        reading.rows, Thinner::kMaxPoints);
}

/// Whether all bodies turn about their pins: an angle about a point says nothing beside it.
bool all_turn(const System& system, const MotionSummary& reading) {
    constexpr double kNear = 0.1;
    return std::all_of(reading.bodies.begin(), reading.bodies.end(), [&](const BodyCurves& body) {
        const double length_m = links_length_m(system, system.bodies[body.followed.body]);
        return body.followed.pin && body.followed.is_free_end && body.nearest_m >= kNear * length_m;
    });
}

/// The size of the area in which the paths are.
double extent_m(const std::vector<Curve>& curves) {
    double low_x = HUGE_VAL;
    double high_x = -HUGE_VAL;
    double low_y = HUGE_VAL;
    double high_y = -HUGE_VAL;
    for (const Curve& curve : curves) {
        for (const CurvePoint& point : curve.points) {
            low_x = std::min(low_x, point.x);
            high_x = std::max(high_x, point.x);
            low_y = std::min(low_y, point.y);
            high_y = std::max(high_y, point.y);
        }
    }
    return std::max(high_x - low_x, high_y - low_y);
}

}  // namespace

report::Chapter path_chapter(const Film& film, const MotionSummary& reading) {
    report::Chapter chapter;
    chapter.title = "Path";
    if (reading.bodies.empty()) {
        chapter.paragraphs.emplace_back("All particles are pinned: nothing moves.");
        return chapter;
    }
    const System& system = film.system();
    const Extreme& speed = reading.speed;
    if (speed.is_known) {
        chapter.summary = fmt::format("The largest speed is {} at {} (particle {} of {}).",
                                      quantity_text(speed.size, "m/s"), time_text(speed.time_s), speed.index,
                                      body_name(system, speed.body));
    }
    std::vector<Curve> curves = tip_curves(film, reading, &BodyCurves::path);
    // Axes far from 0 would have the same number at each tick.
    constexpr double kFar = 1e3;
    const Vec2 origin_m = system.origin_m;
    const bool is_far = std::max(std::abs(origin_m.x), std::abs(origin_m.y)) > kFar * extent_m(curves);
    for (Curve& curve : curves) {
        for (CurvePoint& point : curve.points) {
            if (is_far) break;
            point.x += origin_m.x;
            point.y += origin_m.y;
        }
    }
    report::Plot plot = make_plot("path", "Path of the tip", {"x", "m"}, {"y", "m"}, curves);
    plot.has_equal_scales = true;
    fit_height(plot);
    plot.caption = fmt::format("Path of {}.{}{}{}", pipeline::particles_text(system, followed_of(reading)),
                               is_far ? fmt::format(" Counted from ({}, {}) m.", origin_m.x, origin_m.y) : "",
                               left_out_text(system, reading), path_thinning_text(reading));
    plot.data = kTipData;
    chapter.plots.push_back(plot);
    return chapter;
}

report::Chapter phase_chapter(const Film& film, const MotionSummary& reading) {
    report::Chapter chapter;
    chapter.title = "Phase portrait";
    if (reading.bodies.empty()) return chapter;
    const System& system = film.system();
    const bool turns = all_turn(system, reading);
    const auto curve = turns ? &BodyCurves::turning : &BodyCurves::phase;
    const std::vector<Curve> curves = tip_curves(film, reading, curve);
    report::Plot plot =
        turns ? make_plot("phase", "Phase portrait", {"angle", "rad"}, {"angular velocity", "rad/s"}, curves)
              : make_plot("phase", "Phase portrait", {"x", "m"}, {"vx", "m/s"}, curves);
    plot.caption = turns ? fmt::format(
                               "Phase portrait: the angle of the line from the pin to {}, from straight "
                               "down, positive towards +x, turns counted on, and its rate of change.",
                               pipeline::particles_text(system, followed_of(reading)))
                         : fmt::format(
                               "Phase portrait: the horizontal position of {}, counted from the pin of "
                               "its body or, if that has none or several, from the start, and the "
                               "horizontal velocity.",
                               pipeline::particles_text(system, followed_of(reading)));
    plot.caption += left_out_text(system, reading) + path_thinning_text(reading);
    plot.data = kTipData;
    chapter.plots.push_back(plot);
    return chapter;
}

}  // namespace corda::figures
