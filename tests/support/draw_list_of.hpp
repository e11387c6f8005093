#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "corda/film/draw.hpp"
#include "corda/film/film.hpp"
#include "corda/film/live_plots.hpp"
#include "corda/film/motion_input.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/sim/recording.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/camera.hpp"
#include "corda/view/colors.hpp"
#include "corda/view/overlay.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::test {

/// Adds a state to the bounds of each particle.
inline void include(const State& state, std::vector<MotionBounds>& motion) {
    motion.resize(state.x_m.size());
    for (std::size_t i = 0; i < motion.size(); ++i) motion[i].include(state.x_m[i], state.y_m[i]);
}

/// The poses of a film at increasing times.
inline view::DrawList poses_of(const Film& film, const std::vector<double>& times_s) {
    view::DrawList list;
    film::draw_poses(film.look(), film.motion(), times_s, list);
    return list;
}

/// The draw list of a scene at a state, made without Film, for the reference renderer.
inline view::DrawList draw_list_of(const Scene& scene, const System& system, const CameraDef& camera,
                                   const State& state, const std::vector<MotionBounds>& motion,
                                   const view::Caption& caption = {},
                                   std::span<const view::Trail> trails = {},
                                   const sim::Histogram& histogram = {},
                                   const std::vector<view::PlotData>& plots = {},
                                   const view::ArrowLayer& arrows = {}) {
    const int width_px = scene.video.width_px;
    const int height_px = scene.video.height_px;
    std::optional<view::ColorScale> scale;
    if (const auto quantity = quantity_of(scene.style.color_by))
        scale = view::scale_of(*quantity, histogram, scene.style);
    const view::SceneView scene_view =
        view::make_scene_view(system, scene.world.gravity_m_s2, scene.style, scene.body_styles, width_px,
                              height_px, {motion, scale, arrows});
    const std::vector<Color> body_colors = view::body_colors(scene_view);
    const view::Overlay overlay = view::make_overlay(
        scene.overlay, scene.style, width_px, height_px, scene.video.scene_rate().interval_s(),
        {scale, scene_view.arrows.scale(), 0.0, view::body_labels(scene_view), plots, body_colors});
    view::DrawList list;
    const view::Camera map(camera, system.origin_m, width_px, height_px);
    view::draw(scene_view, state, map, list, trails);
    view::draw_curves(overlay, state.time_s, list);
    view::Caption located = caption;
    located.labels = view::places_of(overlay.labels, state, map);
    view::draw(overlay, located, map.pixels_per_metre(), list);
    return list;
}

/// The particles whose paths a film draws.
inline std::vector<std::size_t> traced(const Film& film) {
    return view::traced_particles(film.system(), film.scene().style);
}

inline void add_points(const Film& film, const State& state, double age_s, std::vector<view::Trail>& trails) {
    const std::vector<std::size_t> ends = traced(film);
    for (std::size_t i = 0; i < ends.size(); ++i)
        trails[i].push_back({age_s,
                             {state.x_m[ends[i]], state.y_m[ends[i]]},
                             {state.vx_m_s[ends[i]], state.vy_m_s[ends[i]]}});
}

/// Adds the quantity that a film's colours show to a state.
inline void add_values(const Film& film, const State& state, sim::Histogram& histogram) {
    const auto quantity = quantity_of(film.scene().style.color_by);
    if (!quantity) return;
    for (const Body& body : film.system().bodies) {
        for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k)
            histogram.add(sim::kind_of(*quantity).value(film.system(), body, k, state));
    }
}

/// The draw list of a film at a time.
inline view::DrawList draw_list_of(const Film& film, double time_s) {
    std::vector<MotionBounds> motion;
    sim::Histogram histogram;
    for (std::int64_t k = 0; k <= film.last_frame(); ++k) {
        include(film.state(k), motion);
        add_values(film, film.state(k), histogram);
    }
    view::ArrowExtents extents;
    const Scene& scene = film.scene();
    const view::ArrowPlaces places(film.system(), scene.world.gravity_m_s2, scene.style.arrows);
    for (std::int64_t k = 0; k <= film.last_frame() && scene.style.arrows != Arrows::kNone; ++k)
        extents.include(places.of(film.state(k)), false);
    for (const double instant_s : film::arrow_times_s(scene))
        extents.include(places.of(film.state_at(instant_s)), true);
    std::vector<view::Trail> trails(test::traced(film).size());
    const double trail_s = film.scene().style.trail_s;
    for (std::int64_t k = 0; k <= film.last_frame() && !trails.empty(); ++k) {
        const double age_s = time_s - film.time_s(k);
        if (age_s > 0.0 && age_s < trail_s) add_points(film, film.state(k), age_s, trails);
    }
    const State state = film.state_at(time_s);
    add_points(film, state, 0.0, trails);
    const view::Caption caption{
        time_s,
        film.figures_at(time_s).energy_error,
        method_caption(film.plan(), film.error_estimate_px(), film.scene().overlay.language),
        {}};
    const double side_px = std::min(scene.video.width_px, scene.video.height_px);
    std::vector<view::PlotData> plots;
    if (!scene.overlay.plots.empty()) plots = film::plots_of(scene, film.motion());
    return draw_list_of(film.scene(), film.system(), film.camera_at(time_s), state, motion, caption, trails,
                        histogram, plots, {places, scene.style, side_px, extents});
}

}  // namespace corda::test
