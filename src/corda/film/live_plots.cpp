#include "corda/film/live_plots.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <string_view>
#include <variant>

#include <fmt/format.h>

#include "corda/core/timeline.hpp"
#include "corda/film/motion.hpp"
#include "corda/film/series.hpp"
#include "corda/scene/schema.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/words.hpp"

namespace corda::film {
namespace {

using view::CurvePoint;
using view::PlotData;

/// Maximum number of samples: a longer motion is read at a stride.
constexpr std::size_t kMaxSamples = 100'000;
/// Number of samples of a short motion: a few per pixel of a wide plot.
constexpr std::size_t kFinestSamples = 4000;
/// Maximum memory of the states that are recorded only for the plots.
constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
/// Motion below this share of the scene's initial size, and of that per duration, is drawn as rest.
constexpr double kStill = 1e-3;
/// Maximum number of bodies with a curve each.
constexpr std::size_t kMaxCurves = 64;

/// The parts of a scene that plots show.
struct Subject {
    Subject(const Scene& scene, const System& of)
        : system(of), language(scene.overlay.language), end_s(scene.world.duration_s) {
        MotionBounds start;
        for (std::size_t i = 0; i < of.particle_count(); ++i) start.include(of.x_m[i], of.y_m[i]);
        const Vec2 extent_m = start.max_m() - start.min_m();
        size_m = sim::length(extent_m.x, extent_m.y);
        mass_kg = std::accumulate(of.mass_kg.begin(), of.mass_kg.end(), 0.0);
        turning = tracked_particles(of, of.bodies.size());
        std::erase_if(turning, [](const TrackedParticle& one) { return !one.pin || !one.is_free_end; });
        turning.resize(std::min(turning.size(), kMaxCurves));
        for (const TrackedParticle& one : turning)
            near_m.push_back(kNearPin * links_length_m(of, of.bodies[one.body]));
    }

    /// Curves of bodies, with names if the scene has others; of many, only labels tell them apart.
    [[nodiscard]] std::vector<PlotData::Curve> curves() const {
        const std::size_t bodies = system.bodies.size();
        std::vector<PlotData::Curve> curves;
        for (const TrackedParticle& one : turning) {
            const bool is_named =
                bodies > 1 && (bodies <= kMaxBodies || !system.bodies[one.body].label.empty());
            curves.push_back({.name = is_named ? name_of(one.body) : "", .body = one.body});
        }
        return curves;
    }

    [[nodiscard]] std::string name_of(std::size_t body) const {
        return view::translated_name(system, body, language);
    }
    [[nodiscard]] std::string word(std::string_view english) const {
        return view::translated(english, language);
    }
    [[nodiscard]] PlotData::AxisName axis(const Series& of, double least_extent = 0.0,
                                          const std::string& symbol = {}) const {
        return {word(of.word), of.unit, least_extent, symbol};
    }

    const System& system;
    Language language;
    double end_s;
    double size_m = 0.0;
    double mass_kg = 0.0;
    std::vector<TrackedParticle> turning;  ///< free ends of bodies with one pin
    std::vector<double> near_m;            ///< distance of each from its pin below which its curves break

    [[nodiscard]] bool is_near_pin(std::size_t k, const State& state) const {
        const std::size_t i = turning[k].particle;
        const std::size_t pin = *turning[k].pin;
        return sim::length(state.x_m[i] - state.x_m[pin], state.y_m[i] - state.y_m[pin]) < near_m[k];
    }
};

/// One kind of plot: its series, and its axes with empty curves. Each curve has its series of `y`; curves of
/// bodies have the first one.
struct Kind {
    Series x;
    std::array<Series, 3> y;
    PlotData (*axes)(const Subject& subject) = nullptr;
    double y_factor = 1.0;  ///< from the unit of the series to that of the axis
};

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// In the order of LivePlot.
constexpr Kind kKinds[] = {
    {kSeries.time,
     {kSeries.kinetic, kSeries.potential, kSeries.total},
     [](const Subject& subject) -> PlotData {
         using Hue = PlotData::Hue;
         const double speed_m_s = subject.size_m / subject.end_s;
         return {
             subject.axis(kSeries.time),
             {subject.word("energy"), kSeries.total.unit, kStill * subject.mass_kg * speed_m_s * speed_m_s},
             subject.end_s,
             {{subject.word(kSeries.kinetic.word), Hue::kKinetic},
              {subject.word(kSeries.potential.word), Hue::kPotential},
              {subject.word(kSeries.total.word), Hue::kText}}};
     }},
    {kSeries.time,
     {kSeries.angle},
     [](const Subject& subject) -> PlotData {
         return {subject.axis(kSeries.time),
                 {subject.word(kSeries.angle.word), "°", kStill, "φ"},
                 subject.end_s,
                 subject.curves()};
     },
     kDegrees},
    {kSeries.angle,
     {kSeries.angular_velocity},
     [](const Subject& subject) -> PlotData {
         const double least = kStill / kDegrees;
         return {subject.axis(kSeries.angle, least, "φ"),
                 subject.axis(kSeries.angular_velocity, least / subject.end_s, "ω"), 0.0, subject.curves()};
     }},
    {kSeries.time,
     {kSeries.tip_distance},
     [](const Subject& subject) -> PlotData {
         const std::string name = subject.name_of(0) + " – " + subject.name_of(1);
         PlotData data{subject.axis(kSeries.time),
                       subject.axis(kSeries.tip_distance, 0.0, subject.word("distance")),
                       subject.end_s,
                       {{subject.system.bodies.size() > 2 ? name : ""}}};
         data.y.is_log = true;
         return data;
     }},
    {kSeries.time,
     {kSeries.tip_x, kSeries.tip_y},
     [](const Subject& subject) -> PlotData {
         const std::string x =
             subject.system.bodies.size() > 1
                 ? fmt::format(fmt::runtime(subject.word("x of {}")),
                               subject.name_of(body_of(subject.system, tip_of(subject.system))))
                 : subject.word(kSeries.tip_x.word);
         return {subject.axis(kSeries.time),
                 {subject.word("position"), kSeries.tip_x.unit, kStill * subject.size_m},
                 subject.end_s,
                 {{x, PlotData::Hue::kX}, {subject.word(kSeries.tip_y.word), PlotData::Hue::kY}}};
     }},
};

const Kind& kind_of(LivePlot plot) {
    return kKinds[static_cast<std::size_t>(plot)];
}

/// A logarithm takes no 0: equal positions are drawn as the smallest distance.
void raise_zeros(double size_m, PlotData& data) {
    constexpr double kRounding = 1e-16;
    for (PlotData::Curve& curve : data.curves) {
        double least = HUGE_VAL;
        for (const CurvePoint& point : curve.points)
            if (point.y > 0.0) least = std::min(least, point.y);
        if (least == HUGE_VAL) least = kRounding * size_m;
        for (CurvePoint& point : curve.points) point.y = std::max(point.y, least);
    }
}

/// Gives axes the ends that the scene gives.
void set_ranges(const PlotRangesDef& ranges, LivePlot plot, PlotData& data) {
    data.y.range = ranges.of[static_cast<std::size_t>(plot)];
    const std::optional<Interval>& angle = ranges.of[static_cast<std::size_t>(LivePlot::kAngle)];
    if (plot == LivePlot::kPhase && angle) data.x.range = {angle->low / kDegrees, angle->high / kDegrees};
}

/// The times at which curves are read, up to the end of the motion.
std::vector<double> sampled_s(const Scene& scene, const Motion& motion) {
    const FrameRate fps = scene.video.scene_rate();
    const Timeline timeline(fps, fps.last_frame_within(scene.world.duration_s),
                            plot_times_s(scene, motion.system));
    return motion.times_of(timeline, timeline.size() / kMaxSamples + 1);
}

}  // namespace

StateFields plot_fields(const Scene& scene) {
    StateFields fields{.velocities = scene.overlay.energy};
    for (const LivePlot plot : scene.overlay.plots)
        for (const Series& one : kind_of(plot).y) fields = fields.with(one.fields);
    return fields;
}

std::vector<double> plot_times_s(const Scene& scene, const System& system) {
    if (scene.overlay.plots.empty() && scene.overlay.energy_zero == EnergyZero::kStart) return {};
    constexpr std::size_t kNumbersPerParticle = 4;
    const std::size_t state_bytes = kNumbersPerParticle * sizeof(double) * system.particle_count();
    const std::size_t count = std::min(kFinestSamples, kMaxBytes / state_bytes);
    std::vector<double> times_s;
    for (std::size_t i = 0; i < count; ++i)
        times_s.push_back(scene.world.duration_s * static_cast<double>(i) / static_cast<double>(count));
    return times_s;
}

double energy_zero_j(const Scene& scene, const Motion& motion) {
    if (scene.overlay.energy_zero == EnergyZero::kStart) return 0.0;
    double lowest_j = HUGE_VAL;
    motion.for_each(sampled_s(scene, motion), [&](const State& state, const Figures& /*figures*/) {
        lowest_j = std::min(lowest_j, motion.energy_of(state).potential_j());
    });
    return lowest_j;
}

std::vector<PlotData> plots_of(const Scene& scene, const Motion& motion) {
    const Subject subject(scene, motion.system);
    const std::vector<LivePlot>& plots = scene.overlay.plots;
    std::vector<PlotData> all;
    for (const LivePlot plot : plots) all.push_back(kind_of(plot).axes(subject));
    for (std::size_t p = 0; p < plots.size(); ++p) {
        all[p].language = subject.language;
        set_ranges(scene.overlay.plot_range, plots[p], all[p]);
    }
    const bool has_velocities = plot_fields(scene).velocities;
    const SeriesSource source(motion);
    const double zero_j = energy_zero_j(scene, motion);
    std::vector<CurvePoint> turns;  // see turning_of(); of each body that turns
    motion.for_each(sampled_s(scene, motion), [&](const State& state, const Figures& figures) {
        Instant instant(source, state, figures);
        instant.energy.weight_j -= zero_j;
        const bool is_first = turns.empty();
        turns.resize(subject.turning.size());
        for (std::size_t k = 0; has_velocities && k < turns.size(); ++k)
            turns[k] = turning_of(subject.turning[k], state, is_first ? nullptr : &turns[k]);
        for (std::size_t p = 0; p < plots.size(); ++p) {
            const Kind& kind = kind_of(plots[p]);
            for (std::size_t k = 0; k < all[p].curves.size(); ++k) {
                PlotData::Curve& curve = all[p].curves[k];
                constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
                if (curve.body)
                    instant.turning =
                        subject.is_near_pin(k, state) ? CurvePoint{.x = kGap, .y = kGap} : turns[k];
                const Series& y = kind.y[curve.body ? 0 : k];
                curve.points.push_back(
                    {state.time_s, kind.x.value(instant), kind.y_factor * y.value(instant)});
            }
        }
    });
    const bool has_relaxation = std::ranges::any_of(motion.plan.bodies, [](const BodyPlan& body) {
        return std::holds_alternative<RelaxationDef>(body.method);
    });
    for (std::size_t p = 0; p < plots.size(); ++p) {
        if (plots[p] == LivePlot::kEnergy && has_relaxation) all[p].curves.pop_back();
        if (all[p].y.is_log) raise_zeros(subject.size_m, all[p]);
    }
    return all;
}

std::vector<std::string> left_out_of(const Scene& scene, std::span<const view::PlotPanel> shown) {
    const std::vector<LivePlot>& plots = scene.overlay.plots;
    const auto& words = scene::find_key("overlay", "plots")->type.choices;
    std::vector<std::string> sentences;
    for (std::size_t i = 0; i < plots.size(); ++i) {
        const bool has_room = i < shown.size() && shown[i].has_room();
        const std::vector<std::string> names = has_room ? shown[i].nameless() : std::vector<std::string>();
        if (has_room && names.empty()) continue;
        const std::string what =
            has_room ? fmt::format("names no curve from \"{}\" on", names[0]) : "is left out";
        sentences.push_back(fmt::format(
            "overlay.plots: \"{}\" has little room in {}x{} pixels and {}; give a "
            "larger size{}{}",
            words[static_cast<std::size_t>(plots[i])], scene.video.width_px, scene.video.height_px, what,
            plots.size() > 1 ? ", fewer plots" : "", has_room ? " or shorter labels" : ""));
    }
    return sentences;
}

}  // namespace corda::film
