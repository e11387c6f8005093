#include "corda/pipeline/curves.hpp"

#include <algorithm>

#include "corda/pipeline/followed.hpp"
#include "corda/view/trail.hpp"

namespace corda::pipeline {
namespace {

/// Of a longer motion, every so many frames are read.
constexpr std::int64_t kMostSamples = 100'000;

/// The first free end of a rope; without one, what stands for the first body that moves.
std::size_t tip_of(const System& system) {
    const std::vector<std::size_t> ends = view::free_ends(system);
    if (!ends.empty()) return ends.front();
    const std::vector<Followed> followed = list_followed(system);
    return followed.empty() ? 0 : followed.front().particle;
}

view::PlotData axes_of(LivePlot plot, double end_s) {
    using Curve = view::PlotData::Curve;
    switch (plot) {
        case LivePlot::kEnergy:
            return {
                {"t", "s"}, {"energy", "J"}, end_s, {Curve{"kinetic"}, Curve{"potential"}, Curve{"total"}}};
        case LivePlot::kTip:
            return {{"t", "s"}, {"position", "m"}, end_s, {Curve{"x"}, Curve{"y"}}};
        case LivePlot::kPhase:
            return {{"x", "m"}, {"vx", "m/s"}, 0.0, {Curve{}}};
        case LivePlot::kNone:
            break;
    }
    return {};
}

}  // namespace

Curves::Curves(const Scene& scene, const System& system)
    : scene_(&scene), system_(&system), plot_(scene.overlay.plot), tip_(tip_of(system)) {}

Readings Curves::readings() const {
    return {.velocities = plot_ == LivePlot::kEnergy || plot_ == LivePlot::kPhase};
}

view::PlotData Curves::read(std::span<const MethodDef> methods, std::int64_t states,
                            const std::function<const State&(std::int64_t)>& state_of) {
    view::PlotData data = axes_of(plot_, scene_->world.duration_s);
    meter_.emplace(*system_, scene_->world, methods);
    least_potential_j_ = 0.0;
    const std::int64_t stride = states / kMostSamples + 1;
    for (std::int64_t k = 0; k < states; k += stride) {
        const std::vector<view::CurvePoint> now = at(state_of(k));
        for (std::size_t i = 0; i < now.size(); ++i) data.curves[i].points.push_back(now[i]);
    }
    if (plot_ != LivePlot::kEnergy || data.curves[1].points.empty()) return data;
    const auto lower = [](const view::CurvePoint& a, const view::CurvePoint& b) { return a.y < b.y; };
    auto& potential = data.curves[1].points;
    least_potential_j_ = std::min_element(potential.begin(), potential.end(), lower)->y;
    for (const std::size_t i : {1, 2})
        for (view::CurvePoint& point : data.curves[i].points) point.y -= least_potential_j_;
    return data;
}

std::vector<view::CurvePoint> Curves::at(const State& state) const {
    const double t = state.time_s;
    const double x_m = system_->origin_m.x + state.x_m[tip_];
    switch (plot_) {
        case LivePlot::kEnergy: {
            const sim::Energy energy = meter_.value().of(state);
            const double potential_j = energy.potential_j() - least_potential_j_;
            return {{t, t, energy.kinetic_j}, {t, t, potential_j}, {t, t, energy.kinetic_j + potential_j}};
        }
        case LivePlot::kTip:
            return {{t, t, x_m}, {t, t, system_->origin_m.y + state.y_m[tip_]}};
        case LivePlot::kPhase:
            return {{t, x_m, state.vx_m_s[tip_]}};
        case LivePlot::kNone:
            break;
    }
    return {};
}

}  // namespace corda::pipeline
