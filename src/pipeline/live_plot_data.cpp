#include "corda/pipeline/live_plot_data.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <variant>

#include "corda/core/timeline.hpp"
#include "corda/pipeline/plan_text.hpp"
#include "corda/pipeline/tracked_particle.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::pipeline {
namespace {

/// Maximum number of samples: a longer motion is read at a stride.
constexpr std::size_t kMaxSamples = 100'000;
/// Number of samples of a short motion: a few per pixel of a wide plot.
constexpr std::size_t kFinestSamples = 4000;
/// Maximum memory of the states that are recorded only for the plot.
constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
/// Motion below this share of the scene's initial size, and of that per duration, is drawn as rest.
constexpr double kStill = 1e-3;

std::size_t body_of(const System& system, std::size_t particle) {
    std::size_t body = 0;
    while (body + 1 < system.bodies.size() && system.bodies[body + 1].first_particle <= particle) ++body;
    return body;
}

}  // namespace

LivePlotData::LivePlotData(const Scene& scene, const System& system)
    : scene_(&scene),
      system_(&system),
      plot_(scene.overlay.plot),
      tip_(tip_of(system)),
      body_(body_of(system, tip_)) {}

StateFields LivePlotData::readings() const {
    return {.velocities = plot_ == LivePlot::kEnergy || plot_ == LivePlot::kPhase};
}

std::vector<double> LivePlotData::times_s() const {
    if (plot_ == LivePlot::kNone) return {};
    constexpr std::size_t kNumbersPerParticle = 4;
    const std::size_t state_bytes = kNumbersPerParticle * sizeof(double) * system_->particle_count();
    const std::size_t count = std::min(kFinestSamples, kMaxBytes / state_bytes);
    std::vector<double> times_s;
    for (std::size_t i = 0; i < count; ++i)
        times_s.push_back(scene_->world.duration_s * static_cast<double>(i) / static_cast<double>(count));
    return times_s;
}

view::PlotData LivePlotData::axes() const {
    using Curve = view::PlotData::Curve;
    MotionBounds start;
    for (std::size_t i = 0; i < system_->particle_count(); ++i)
        start.include(system_->x_m[i], system_->y_m[i]);
    const Vec2 extent_m = start.max_m() - start.min_m();
    const double size_m = sim::length(extent_m.x, extent_m.y);
    const double end_s = scene_->world.duration_s;
    const double speed_m_s = size_m / end_s;
    const double mass_kg = std::accumulate(system_->mass_kg.begin(), system_->mass_kg.end(), 0.0);
    const view::PlotData::AxisName time{"t", "s"};
    const std::string of_body = system_->bodies.size() > 1 ? " of " + body_name(*system_, body_) : "";
    switch (plot_) {
        case LivePlot::kEnergy:
            return {time,
                    {"energy", "J", kStill * mass_kg * speed_m_s * speed_m_s},
                    end_s,
                    {Curve{"kinetic"}, Curve{"potential"}, Curve{"total"}}};
        case LivePlot::kTip:
            return {
                time, {"position", "m", kStill * size_m}, end_s, {Curve{"x" + of_body}, Curve{"y"}}, body_};
        case LivePlot::kPhase:
            return {{"x" + of_body, "m", kStill * size_m},
                    {"vx", "m/s", kStill * speed_m_s},
                    0.0,
                    {Curve{}},
                    body_};
        case LivePlot::kNone:
            break;
    }
    return {};
}

view::PlotData LivePlotData::read(const std::vector<MethodDef>& methods, double end_s,
                                  const std::function<const State&(double time_s)>& state_at,
                                  const std::function<Energy(const State&)>& energy_of) const {
    view::PlotData data = axes();
    const FrameRate fps = scene_->video.scene_rate();
    const Timeline timeline(fps, fps.last_frame_within(scene_->world.duration_s), times_s());
    const std::size_t stride = timeline.size() / kMaxSamples + 1;
    for (std::size_t i = 0; i < timeline.size() && timeline.time_s(i) <= end_s; i += stride)
        add(state_at(timeline.time_s(i)), energy_of, data);
    if (plot_ != LivePlot::kEnergy) return data;
    const auto lower = [](const view::CurvePoint& a, const view::CurvePoint& b) { return a.y < b.y; };
    auto& potential = data.curves[1].points;
    const double least_j = std::min_element(potential.begin(), potential.end(), lower)->y;
    for (const std::size_t curve : {1, 2})
        for (view::CurvePoint& point : data.curves[curve].points) point.y -= least_j;
    const auto is_relaxation = [](const MethodDef& method) {
        return std::holds_alternative<RelaxationDef>(method);
    };
    if (std::any_of(methods.begin(), methods.end(), is_relaxation)) data.curves.pop_back();
    return data;
}

void LivePlotData::add(const State& state, const std::function<Energy(const State&)>& energy_of,
                       view::PlotData& data) const {
    const double t = state.time_s;
    const double x_m = system_->origin_m.x + state.x_m[tip_];
    switch (plot_) {
        case LivePlot::kEnergy: {
            const Energy energy = energy_of(state);
            const double potential_j = energy.potential_j();
            data.curves[0].points.push_back({t, t, energy.kinetic_j});
            data.curves[1].points.push_back({t, t, potential_j});
            data.curves[2].points.push_back({t, t, energy.kinetic_j + potential_j});
            break;
        }
        case LivePlot::kTip:
            data.curves[0].points.push_back({t, t, x_m});
            data.curves[1].points.push_back({t, t, system_->origin_m.y + state.y_m[tip_]});
            break;
        case LivePlot::kPhase:
            data.curves[0].points.push_back({t, x_m, state.vx_m_s[tip_]});
            break;
        case LivePlot::kNone:
            break;
    }
}

}  // namespace corda::pipeline
