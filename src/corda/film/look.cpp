#include "corda/film/look.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/timeline.hpp"
#include "corda/film/live_plots.hpp"
#include "corda/film/motion.hpp"
#include "corda/film/motion_input.hpp"
#include "corda/film/series.hpp"
#include "corda/sim/forces/forces.hpp"

namespace corda::film {
namespace {

view::Overlay overlay_of(const Scene& scene, view::OverlayData data = {}) {
    data.speed = scene.video.speed;
    OverlayDef def = scene.overlay;
    def.font = font_path(scene);
    const VideoDef& video = scene.video;
    return view::make_overlay(def, scene.style, video.width_px, video.height_px,
                              video.scene_rate().interval_s(), data);
}

/// Every `stride`-th frame time up to the end of a motion.
std::vector<double> frame_times_s(const Scene& scene, const Motion& motion, std::size_t stride = 1) {
    return motion.times_of({scene.video.scene_rate(), last_frame_of(scene)}, stride);
}

view::TrailPoint trail_point(const State& state, std::size_t i) {
    return {0.0, {state.x_m[i], state.y_m[i]}, {state.vx_m_s[i], state.vy_m_s[i]}};
}

Paths paths_of(const Scene& scene, const Motion& motion) {
    constexpr double kMaxPoints = 400.0;  // more segments would be shorter than a pixel
    const double trail_s = scene.style.trail_s;
    const FrameRate fps = scene.video.scene_rate();
    const auto stride = std::llround(std::ceil(trail_s / fps.interval_s() / kMaxPoints));
    Paths paths{view::traced_particles(motion.system, scene.style),
                trail_s,
                fps,
                std::max<std::int64_t>(1, stride),
                {}};
    if (paths.particles.empty()) return paths;
    const std::vector<double> times_s = frame_times_s(scene, motion, static_cast<std::size_t>(paths.stride));
    motion.for_each(times_s, [&](const State& state, const Figures& /*figures*/) {
        for (const std::size_t i : paths.particles) paths.points.push_back(trail_point(state, i));
    });
    return paths;
}

/// The place of what the camera follows, relative to the system's origin.
Vec2 followed_m(int follow, const System& system, const State& state) {
    if (follow == CameraDef::kTip) {
        const std::size_t tip = tip_of(system);
        return {state.x_m[tip], state.y_m[tip]};
    }
    const Body& body = system.bodies[static_cast<std::size_t>(follow)];
    Vec2 sum;
    double mass_kg = 0.0;
    for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i) {
        sum = sum + system.mass_kg[i] * Vec2{state.x_m[i], state.y_m[i]};
        mass_kg += system.mass_kg[i];
    }
    return (1.0 / mass_kg) * sum;
}

/// Averages with weights that fall evenly to 0; the ends count as resting.
std::vector<Vec2> smoothed(const std::vector<Vec2>& path, std::int64_t half) {
    const std::int64_t last = std::ssize(path) - 1;
    std::vector<Vec2> smooth;
    for (std::int64_t k = 0; k <= last; ++k) {
        Vec2 sum;
        for (std::int64_t j = -half; j <= half; ++j)
            sum = sum + static_cast<double>(half + 1 - std::abs(j)) *
                            path[static_cast<std::size_t>(std::clamp<std::int64_t>(k + j, 0, last))];
        smooth.push_back((1.0 / static_cast<double>((half + 1) * (half + 1))) * sum);
    }
    return smooth;
}

/// The arrows, with the scale of their extents at frame times and arrow_times_s().
view::ArrowLayer arrow_layer(const Scene& scene, const Motion& motion) {
    if (scene.style.arrows == Arrows::kNone) return {};
    view::ArrowPlaces places(motion.system, scene.world.gravity_m_s2, scene.style.arrows);
    view::ArrowExtents extents;
    const VideoDef& video = scene.video;
    const std::vector<double> instants_s = arrow_times_s(scene);
    const Timeline timeline(video.scene_rate(), last_frame_of(scene), instants_s);
    motion.for_each(motion.times_of(timeline), [&](const State& state, const Figures& /*figures*/) {
        extents.include(places.of(state),
                        std::binary_search(instants_s.begin(), instants_s.end(), state.time_s));
    });
    return {std::move(places), scene.style, static_cast<double>(std::min(video.width_px, video.height_px)),
            extents};
}

std::optional<view::ColorScale> color_scale(const Scene& scene, const sim::Histogram& histogram) {
    const auto quantity = quantity_of(scene.style.color_by);
    return quantity ? std::optional(view::scale_of(*quantity, histogram, scene.style)) : std::nullopt;
}

/// The camera at rest that shows all particles within these bounds.
CameraDef fitted_camera(const Look& look, std::span<const MotionBounds> bounds) {
    std::vector<view::Drawn> drawn = view::drawn(look.view, bounds);
    const VideoDef& video = look.scene.video;
    const double metres_per_px = look.camera.height_m.value_or(0.0) / video.height_px;
    std::ranges::copy(view::drawn_labels(look.overlay.area, look.overlay.labels, bounds, metres_per_px),
                      std::back_inserter(drawn));
    return view::fit_camera(look.scene.camera, look.system->origin_m, drawn, video.width_px, video.height_px,
                            look.overlay.insets);
}

/// Raises labels above pins over what passes there at frame times. The camera is fitted to raised ones; then
/// they are raised as that camera, given by a scene, would have them. Where raised ones would take most of
/// the picture, as over a rope that stands on its pin, the camera stays as it is.
void raise_labels(const Motion& motion, std::span<const MotionBounds> bounds, Look& look) {
    if (look.overlay.labels.empty()) return;
    constexpr double kMaxGrowth = 1.3;  // of the camera's height for raised labels
    const bool is_fitted = !look.track && !look.scene.camera.height_m;
    const bool moves = look.track || !motion.system.moves.empty();
    if (view::stack_labels(look.overlay.area, look.overlay.labels, motion.at(0.0), look.map_at(0.0)) &&
        is_fitted)
        look.camera = fitted_camera(look, bounds);
    for (const bool is_first : {true, false}) {
        if (is_first && !is_fitted) continue;
        view::LabelRoom room(look.overlay.area, look.view, look.overlay.labels);
        if (!room.is_needed(bounds)) return;
        motion.for_each(frame_times_s(look.scene, motion), [&](const State& state, const Figures&) {
            check_cancelled();
            room.include(state, look.map_at(state.time_s),
                         moves ? look.paths.to(state) : std::vector<view::Trail>());
        });
        if (!room.raise_labels(is_first)) return;
        if (!is_first) continue;
        const CameraDef raised = fitted_camera(look, bounds);
        if (*raised.height_m <= kMaxGrowth * *look.camera.height_m) look.camera = raised;
    }
}

/// The look of a scene that moves like this, with a camera at rest and without trails.
Look fitted_look(const Scene& scene, const System& system, const view::WholeMotion& motion,
                 std::span<const view::PlotData> plots) {
    const VideoDef& video = scene.video;
    view::SceneView view = view::make_scene_view(system, scene.world.gravity_m_s2, scene.style,
                                                 scene.body_styles, video.width_px, video.height_px, motion);
    const std::vector<Color> body_colors = view::body_colors(view);
    view::Overlay overlay =
        overlay_of(scene, {motion.scale, view.arrows.scale(),
                           sim::energy_scale_j(system, sim::Forces(scene.world).on_particles(system)),
                           view::body_labels(view), plots, body_colors});
    Look look{scene, &system, std::move(view), std::move(overlay), {}};
    look.camera = fitted_camera(look, motion.bounds);
    return look;
}

/// Height of a picture in which the origin of these bounds of each particle is in the middle of what panels
/// leave, so that all bodies and arrows are in view.
double height_about(std::span<const MotionBounds> motion, const view::ArrowExtents& arrows,
                    const Look& look) {
    const VideoDef& video = look.scene.video;
    const CameraDef about{Vec2{}, {}, look.scene.camera.margin};
    std::vector<view::Drawn> drawn = view::drawn_bodies(look.view, motion);
    look.view.arrows.list(drawn, &arrows);
    view::Insets insets = look.overlay.insets;
    const auto taken_x_px = static_cast<int>(std::exchange(insets.right_panel_px, 0.0));
    const auto taken_y_px = static_cast<int>(std::exchange(insets.bottom_panel_px, 0.0));
    const int height_px = video.height_px - taken_y_px;
    const CameraDef beside =
        view::fit_camera(about, {}, drawn, video.width_px - taken_x_px, height_px, insets);
    return *beside.height_m * (static_cast<double>(video.height_px) / height_px);
}

/// Where something is that the camera follows, at frame times.
struct FollowedPath {
    std::vector<double> times_s;
    std::vector<Vec2> at_m;  ///< relative to the system's origin
};

FollowedPath followed_path(const Scene& scene, const Motion& motion) {
    constexpr double kSmoothSeconds = 0.2;  // half of the video time over which a followed place is averaged
    constexpr double kMaxSmoothFrames = 100.0;
    FollowedPath path{frame_times_s(scene, motion), {}};
    motion.for_each(path.times_s, [&](const State& state, const Figures& /*figures*/) {
        path.at_m.push_back(followed_m(*scene.camera.follow, motion.system, state));
    });
    const double half = std::min(kSmoothSeconds * scene.video.fps.per_second(), kMaxSmoothFrames);
    path.at_m = smoothed(path.at_m, std::llround(half));
    return path;
}

/// The height of a camera along a path so that all is in view.
double height_along(const FollowedPath& path, const Look& look, const Motion& motion) {
    std::vector<MotionBounds> about(look.system->particle_count());
    view::ArrowExtents arrows;
    std::size_t k = 0;
    motion.for_each(path.times_s, [&](const State& state, const Figures& /*figures*/) {
        check_cancelled();
        for (std::size_t i = 0; i < about.size(); ++i)
            about[i].include(state.x_m[i] - path.at_m[k].x, state.y_m[i] - path.at_m[k].y);
        std::vector<view::Arrow> all = look.view.arrows.places().of(state);
        for (view::Arrow& arrow : all) arrow.at_m = arrow.at_m - path.at_m[k];
        arrows.include(all, false);
        ++k;
    });
    return height_about(about, arrows, look);
}

view::CameraTrack track_along(const FollowedPath& path, double height_m, const Look& look) {
    const view::Insets insets = look.overlay.insets;
    const Vec2 beside_panels_m =
        (0.5 * height_m / look.scene.video.height_px) * Vec2{insets.right_panel_px, -insets.bottom_panel_px};
    std::vector<view::CameraTrack::Key> keys;
    for (std::size_t k = 0; k < path.times_s.size(); ++k)
        keys.push_back({path.times_s[k], look.system->origin_m + path.at_m[k] + beside_panels_m, height_m});
    return view::CameraTrack(std::move(keys));
}

view::CameraTrack track_of_path(const Look& look) {
    std::vector<view::CameraTrack::Key> keys;
    for (const CameraKeyDef& key : look.scene.camera.path)
        keys.push_back({key.time_s, key.center_m.value_or(*look.camera.center_m),
                        key.height_m.value_or(*look.camera.height_m)});
    return view::CameraTrack(std::move(keys));
}

}  // namespace

std::vector<view::Trail> Paths::to(const State& state) const {
    constexpr double kTooClose = 1e-6;  // in frame intervals: it would give its segment no direction
    if (particles.empty()) return {};
    const auto time_s = [this](std::size_t point) {
        return fps.time_s(static_cast<std::int64_t>(point) * stride);
    };
    const std::size_t count = points.size() / particles.size();
    std::size_t first = count;
    if (const double passed = state.time_s / (fps.interval_s() * static_cast<double>(stride)) + 2.0;
        passed < static_cast<double>(count))
        first = static_cast<std::size_t>(passed);
    while (first > 0 && time_s(first - 1) >= state.time_s - kTooClose * fps.interval_s()) --first;
    const std::size_t end = first;
    while (first > 0 && state.time_s - time_s(first - 1) < trail_s) --first;
    std::vector<view::Trail> trails(particles.size());
    for (std::size_t p = 0; p < particles.size(); ++p) {
        for (std::size_t k = first; k < end; ++k) {
            trails[p].push_back(points[k * particles.size() + p]);
            trails[p].back().age_s = state.time_s - time_s(k);
        }
        trails[p].push_back(trail_point(state, particles[p]));
    }
    return trails;
}

CameraDef Look::camera_at(double time_s) const {
    return track ? track->at(camera, time_s) : camera;
}

view::Camera Look::map_at(double time_s) const {
    return {camera_at(time_s), system->origin_m, scene.video.width_px, scene.video.height_px};
}

Look look_at(const Scene& scene, const Motion& motion) {
    // The start exists even if the first step diverges.
    const sim::Recording& recording = *motion.recording;
    const std::vector<MotionBounds> bounds =
        recording.size() > 0 ? recording.particle_bounds() : bounds_of_start(motion.system);
    std::vector<view::PlotData> plots;
    if (!scene.overlay.plots.empty()) plots = plots_of(scene, motion);
    Look look =
        fitted_look(scene, motion.system,
                    {bounds, color_scale(scene, recording.histogram()), arrow_layer(scene, motion)}, plots);
    if (scene.camera.follow) {
        const FollowedPath path = followed_path(scene, motion);
        if (!scene.camera.height_m) look.camera.height_m = height_along(path, look, motion);
        look.track = track_along(path, *look.camera.height_m, look);
    } else if (scene.camera.moves()) {
        look.track = track_of_path(look);
    }
    look.paths = paths_of(scene, motion);
    raise_labels(motion, bounds, look);
    if (scene.overlay.energy) look.energy_zero_j = energy_zero_j(scene, motion);
    return look;
}

Look look_within(const Scene& scene, const System& system, std::span<const MotionBounds> bounds) {
    return fitted_look(scene, system, {bounds, color_scale(scene, {})}, {});
}

PictureScale::PictureScale(const Scene& scene, const System& system)
    : scene_(&scene), origin_m_(system.origin_m), insets_(overlay_of(scene).insets) {}

double PictureScale::largest_error_px_per_metre(const MotionBounds& bounds) const {
    const std::array<view::Drawn, 1> lines{{{.bounds = bounds}}};
    const VideoDef& video = scene_->video;
    const double height_m =
        *view::fit_camera(scene_->camera, origin_m_, lines, video.width_px, video.height_px, insets_)
             .height_m;
    return view::error_px(scene_->camera, 1.0, height_m, video.height_px);
}

}  // namespace corda::film
