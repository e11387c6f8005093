#include "corda/film/live_plots.hpp"

#include <algorithm>
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
#include "corda/film/tracked_particle.hpp"
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
        tips.assign(2, tip_of(of));
        for (const TrackedParticle& tracked : turning)
            if (tracked.body < tips.size()) tips[tracked.body] = tracked.particle;
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

    const System& system;
    Language language;
    double end_s;
    double size_m = 0.0;
    double mass_kg = 0.0;
    [[nodiscard]] bool is_near_pin(std::size_t k, const State& state) const {
        const std::size_t i = turning[k].particle;
        const std::size_t pin = *turning[k].pin;
        return sim::length(state.x_m[i] - state.x_m[pin], state.y_m[i] - state.y_m[pin]) < near_m[k];
    }

    std::vector<TrackedParticle> turning;  ///< free ends of bodies with one pin
    std::vector<double> near_m;            ///< distance of each from its pin below which its curves break
    std::vector<std::size_t> tips;         ///< of ropes 0 and 1
};

/// A state, and what several plots show of it.
struct Sample {
    const State& state;
    const Motion& motion;
    std::vector<CurvePoint> turns;  ///< see turning_of(); one per particle of Subject::turning; NaN: a gap
};

/// One kind of plot: the fields that it needs of states, its axes and empty curves, and the values that a
/// sample adds to the curves: the y of each over time, otherwise x and y.
struct Kind {
    StateFields fields;
    PlotData (*axes)(const Subject& subject) = nullptr;
    std::vector<CurvePoint> (*values)(const Subject& subject, const Sample& sample) = nullptr;
};

constexpr StateFields kVelocities{.velocities = true};
constexpr double kDegrees = 180.0 / std::numbers::pi;

/// In the order of LivePlot.
constexpr Kind kKinds[] = {
    {kVelocities,
     [](const Subject& subject) -> PlotData {
         using Hue = PlotData::Hue;
         const double speed_m_s = subject.size_m / subject.end_s;
         return {{"t", "s"},
                 {subject.word("energy"), "J", kStill * subject.mass_kg * speed_m_s * speed_m_s},
                 subject.end_s,
                 {{subject.word("kinetic"), Hue::kKinetic},
                  {subject.word("potential"), Hue::kPotential},
                  {subject.word("total"), Hue::kText}}};
     },
     [](const Subject&, const Sample& sample) -> std::vector<CurvePoint> {
         const Energy energy = sample.motion.energy_of(sample.state);
         const double potential_j = energy.potential_j();
         return {{.y = energy.kinetic_j}, {.y = potential_j}, {.y = energy.kinetic_j + potential_j}};
     }},
    {kVelocities,
     [](const Subject& subject) -> PlotData {
         return {{"t", "s"}, {subject.word("angle"), "°", kStill, "φ"}, subject.end_s, subject.curves()};
     },
     [](const Subject&, const Sample& sample) {
         std::vector<CurvePoint> values;
         for (const CurvePoint& turn : sample.turns) values.push_back({.y = kDegrees * turn.x});
         return values;
     }},
    {kVelocities,
     [](const Subject& subject) -> PlotData {
         const double least = kStill / kDegrees;
         return {{subject.word("angle"), "rad", least, "φ"},
                 {subject.word("angular velocity"), "rad/s", least / subject.end_s, "ω"},
                 0.0,
                 subject.curves()};
     },
     [](const Subject&, const Sample& sample) { return sample.turns; }},
    {{},
     [](const Subject& subject) -> PlotData {
         const std::string name = subject.name_of(0) + " – " + subject.name_of(1);
         return {{"t", "s"},
                 {subject.word("distance of the tips"), "m", 0.0, subject.word("distance"), true},
                 subject.end_s,
                 {{subject.system.bodies.size() > 2 ? name : ""}}};
     },
     [](const Subject& subject, const Sample& sample) -> std::vector<CurvePoint> {
         const State& state = sample.state;
         const std::size_t a = subject.tips[0];
         const std::size_t b = subject.tips[1];
         return {{.y = sim::length(state.x_m[a] - state.x_m[b], state.y_m[a] - state.y_m[b])}};
     }},
    {{},
     [](const Subject& subject) -> PlotData {
         const std::size_t tip = tip_of(subject.system);
         const std::string x = subject.system.bodies.size() > 1
                                   ? fmt::format(fmt::runtime(subject.word("x of {}")),
                                                 subject.name_of(body_of(subject.system, tip)))
                                   : "x";
         return {{"t", "s"},
                 {subject.word("position"), "m", kStill * subject.size_m},
                 subject.end_s,
                 {{x, PlotData::Hue::kX}, {"y", PlotData::Hue::kY}}};
     },
     [](const Subject& subject, const Sample& sample) -> std::vector<CurvePoint> {
         const std::size_t tip = tip_of(subject.system);
         return {{.y = subject.system.origin_m.x + sample.state.x_m[tip]},
                 {.y = subject.system.origin_m.y + sample.state.y_m[tip]}};
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
    for (const LivePlot plot : scene.overlay.plots) fields = fields.with(kind_of(plot).fields);
    return fields;
}

std::vector<double> plot_times_s(const Scene& scene, const System& system) {
    if (scene.overlay.plots.empty()) return {};
    constexpr std::size_t kNumbersPerParticle = 4;
    const std::size_t state_bytes = kNumbersPerParticle * sizeof(double) * system.particle_count();
    const std::size_t count = std::min(kFinestSamples, kMaxBytes / state_bytes);
    std::vector<double> times_s;
    for (std::size_t i = 0; i < count; ++i)
        times_s.push_back(scene.world.duration_s * static_cast<double>(i) / static_cast<double>(count));
    return times_s;
}

std::vector<PlotData> plots_of(const Scene& scene, const Motion& motion) {
    const Subject subject(scene, motion.system);
    const std::vector<LivePlot>& plots = scene.overlay.plots;
    std::vector<PlotData> all;
    for (const LivePlot plot : plots) all.push_back(kind_of(plot).axes(subject));
    for (PlotData& data : all) data.language = subject.language;
    const bool has_velocities = plot_fields(scene).velocities;
    std::vector<CurvePoint> turns;
    motion.for_each(sampled_s(scene, motion), [&](const State& state, const Figures& /*figures*/) {
        Sample sample{state, motion, {}};
        const bool is_first = turns.empty();
        turns.resize(subject.turning.size());
        for (std::size_t k = 0; has_velocities && k < turns.size(); ++k) {
            turns[k] = turning_of(subject.turning[k], state, is_first ? nullptr : &turns[k]);
            constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
            sample.turns.push_back(subject.is_near_pin(k, state) ? CurvePoint{.x = kNone, .y = kNone}
                                                                 : turns[k]);
        }
        for (std::size_t p = 0; p < plots.size(); ++p) {
            const std::vector<CurvePoint> values = kind_of(plots[p]).values(subject, sample);
            for (std::size_t k = 0; k < values.size(); ++k)
                all[p].curves[k].points.push_back(
                    {state.time_s, all[p].end_s > 0.0 ? state.time_s : values[k].x, values[k].y});
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
