#include "corda/film/scene_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"
#include "corda/film/film.hpp"
#include "corda/film/motion_input.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/film/tracked_particle.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/sim/forces/forces.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/words.hpp"

namespace corda::film {
namespace {

/// Half of the video time over which a followed place is averaged.
constexpr double kSmoothSeconds = 0.2;
constexpr double kMaxSmoothFrames = 100.0;

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

}  // namespace

void Canvas::Delete::operator()(Canvas* canvas) const {
    const gl::SavedContext saved;
    const auto lock = canvas->context.exclusive();
    try {
        canvas->context.make_current();  // throws in a forked child
    } catch (const Error&) {
        return;
    }
    delete canvas;
}

namespace {

OverlayDef with_font_path(const Scene& scene) {
    OverlayDef overlay = scene.overlay;
    overlay.font = font_path(scene);
    return overlay;
}

}  // namespace

SceneRenderer::SceneRenderer(const Scene& scene, const System& system, const std::string& backend,
                             bool require_gpu)
    : scene_(&scene),
      system_(&system),
      gl_(gl::ContextDef::parse(backend)),
      view_(system, scene.world.gravity_m_s2, scene.style, scene.body_styles, scene.video.width_px,
            scene.video.height_px),
      overlay_(with_font_path(scene), scene.style, scene.video.width_px, scene.video.height_px,
               scene.video.scene_rate().interval_s()) {
    gl_.require_gpu = require_gpu;
    overlay_.set_energy_scale(sim::energy_scale_j(system, sim::Forces(scene.world).on_particles(system)));
}

bool SceneRenderer::needs_motion() const {
    return view::needs_motion(scene_->camera) || view_.needs_motion() || !scene_->overlay.plots.empty();
}

CameraDef SceneRenderer::fit(std::span<const MotionBounds> motion, const sim::Histogram& histogram) {
    view_.set_motion(motion);
    if (const auto quantity = quantity_of(scene_->style.color_by)) {
        const view::ColorScale scale = view::scale_of(*quantity, histogram, scene_->style);
        view_.set_scale(scale);
        overlay_.set_scale(scale);
    }
    std::vector<view::Drawn> drawn = view_.drawn(motion);
    overlay_.set_labels(view_.labels(), motion, drawn);
    return view::fit_camera(scene_->camera, system_->origin_m, drawn, scene_->video.width_px,
                            scene_->video.height_px, overlay_.insets());
}

view::ArrowExtents SceneRenderer::arrow_extents(
    double end_s, const std::function<const State&(double time_s)>& state_at) const {
    view::ArrowExtents extents;
    const std::vector<double> instants_s = arrow_times_s(*scene_);
    const Timeline times(scene_->video.scene_rate(), last_frame_of(*scene_), instants_s);
    for (std::size_t i = 0; i < times.size() && times.time_s(i) <= end_s; ++i) {
        check_cancelled();
        extents.include(view_.arrows().of(state_at(times.time_s(i))),
                        std::binary_search(instants_s.begin(), instants_s.end(), times.time_s(i)));
    }
    return extents;
}

double SceneRenderer::height_about(std::span<const MotionBounds> motion,
                                   const view::ArrowExtents& arrows) const {
    const CameraDef about{Vec2{}, {}, scene_->camera.margin};
    std::vector<view::Drawn> drawn = view_.drawn_bodies(motion);
    view_.arrows().list(drawn, &arrows);
    view::Insets insets = overlay_.insets();
    const auto taken_x_px = static_cast<int>(std::exchange(insets.right_panel_px, 0.0));
    const auto taken_y_px = static_cast<int>(std::exchange(insets.bottom_panel_px, 0.0));
    const int height_px = scene_->video.height_px - taken_y_px;
    const CameraDef beside =
        view::fit_camera(about, {}, drawn, scene_->video.width_px - taken_x_px, height_px, insets);
    return *beside.height_m * (static_cast<double>(scene_->video.height_px) / height_px);
}

view::CameraTrack SceneRenderer::track(double end_s,
                                       const std::function<const State&(double time_s)>& state_at,
                                       CameraDef& camera) const {
    std::vector<view::CameraTrack::Key> keys;
    for (const CameraKeyDef& key : scene_->camera.path)
        keys.push_back(
            {key.time_s, key.center_m.value_or(*camera.center_m), key.height_m.value_or(*camera.height_m)});
    if (!scene_->camera.follow) return view::CameraTrack(std::move(keys));
    std::vector<double> times_s;
    std::vector<Vec2> path;
    for (std::int64_t k = 0; k == 0 || scene_->video.scene_rate().time_s(k) <= end_s; ++k) {
        times_s.push_back(scene_->video.scene_rate().time_s(k));
        path.push_back(followed_m(*scene_->camera.follow, *system_, state_at(times_s.back())));
    }
    const double half = std::min(kSmoothSeconds * scene_->video.fps.per_second(), kMaxSmoothFrames);
    path = smoothed(path, std::llround(half));
    if (!scene_->camera.height_m) {
        std::vector<MotionBounds> about(system_->particle_count());
        view::ArrowExtents arrows;
        for (std::size_t k = 0; k < times_s.size(); ++k) {
            check_cancelled();
            const State& state = state_at(times_s[k]);
            for (std::size_t i = 0; i < about.size(); ++i)
                about[i].include(state.x_m[i] - path[k].x, state.y_m[i] - path[k].y);
            std::vector<view::Arrow> all = view_.arrows().of(state);
            for (view::Arrow& arrow : all) arrow.at_m = arrow.at_m - path[k];
            arrows.include(all, false);
        }
        camera.height_m = height_about(about, arrows);
    }
    const view::Insets insets = overlay_.insets();
    const Vec2 beside_panels_m = (0.5 * *camera.height_m / scene_->video.height_px) *
                                 Vec2{insets.right_panel_px, -insets.bottom_panel_px};
    for (std::size_t k = 0; k < times_s.size(); ++k)
        keys.push_back({times_s[k], system_->origin_m + path[k] + beside_panels_m, *camera.height_m});
    return view::CameraTrack(std::move(keys));
}

double SceneRenderer::largest_pixels_per_metre(const MotionBounds& bounds) const {
    const std::array<view::Drawn, 1> lines{{{.bounds = bounds}}};
    const double height_m =
        *view::fit_camera(scene_->camera, system_->origin_m, lines, scene_->video.width_px,
                          scene_->video.height_px, overlay_.insets())
             .height_m;
    return scene_->video.height_px / view::least_height_m(scene_->camera, height_m);
}

view::Camera SceneRenderer::map_of(const CameraDef& camera) const {
    return {camera, system_->origin_m, scene_->video.width_px, scene_->video.height_px};
}

void SceneRenderer::open(Needs needs) {
    // A forked child needs a context of its own and must not destroy that of its parent.
    if (canvas_ && canvas_->context.is_inherited()) static_cast<void>(canvas_.release());
    if (!canvas_) has_others_ = false;
    if (canvas_) {
        canvas_->context.make_current();
    } else {
        canvas_ = OwnedCanvas(new Canvas(gl_));
    }
    if (needs == Needs::kContext || (canvas_->renderer && !has_others_)) return;
    const auto lock = canvas_->context.exclusive();
    const int width_px = scene_->video.width_px;
    const int height_px = scene_->video.height_px;
    auto& renderer = canvas_->renderer;
    if (std::exchange(has_others_, false) && renderer) {  // keeps the compiled programs
        renderer = std::make_unique<render::FrameRenderer>(*renderer, width_px, height_px);
        return;
    }
    renderer = std::make_unique<render::FrameRenderer>(canvas_->context, width_px, height_px);
    try {
        render::check_driver(canvas_->context, *canvas_->renderer, false);
    } catch (...) {
        canvas_->renderer.reset();
        throw;
    }
}

Damage SceneRenderer::draw(const State& state, const view::Camera& map, const view::Caption& caption,
                           const Traces& traces) {
    list(state, map, traces);
    annotate(caption, map, list_);
    return paint();
}

void SceneRenderer::list(const State& state, const view::Camera& map, const Traces& traces) {
    view_.draw(state, map, list_, traces.trails);
    draw_curves(traces.plotted_s, list_);
}

bool SceneRenderer::would_show_nothing(const State& state, const view::Camera& map, const Traces& traces) {
    list(state, map, traces);
    return list_.shows_nothing();
}

Damage SceneRenderer::draw(view::DrawList list) {
    list_ = std::move(list);
    return paint();
}

view::PoseTime SceneRenderer::add_pose(const State& state, const view::Camera& map, double opacity,
                                       view::DrawList& list) const {
    const std::size_t first_layer = list.layers.size();
    view_.draw_pose(state, map, list);
    for (std::size_t l = first_layer; l < list.layers.size(); ++l) {
        Color& color = list.layers[l].color;
        color.a = static_cast<std::uint8_t>(std::lround(opacity * color.a));
    }
    const view::BodyLabel label = view_.label_at(tip_of(*system_), "");
    return {label, map.at(state, label.particle), map.at(state, label.from), opacity};
}

void SceneRenderer::annotate_poses(std::span<const double> times_s, std::vector<view::PoseTime> poses,
                                   view::DrawList& list) {
    const std::vector<std::string> digits = view::digits_of(times_s);
    for (std::size_t k = 0; k < poses.size(); ++k)
        poses[k].label.text = view::localized(digits[k] + " s", scene_->overlay.language);
    overlay_.draw_times(poses, list);
}

std::vector<std::uint8_t> SceneRenderer::mask(const State& state, const view::Camera& map) {
    constexpr std::size_t kMaxDistinct = 255;
    const std::size_t bodies = system_->bodies.size();
    if (bodies > kMaxDistinct)
        throw_usage("a mask distinguishes {} bodies, and the scene has {}", kMaxDistinct, bodies);
    view_.start(list_);
    std::vector<std::uint8_t> mask(static_cast<std::size_t>(list_.width) * list_.height);
    for (std::size_t i = 0; i < bodies; ++i) {
        check_cancelled();
        list_.clear();
        view_.draw_body(i, state, map, list_);
        render::mark_covered(list_, static_cast<std::uint8_t>(i + 1), mask);
    }
    return mask;
}

void SceneRenderer::begin_exposure() {
    shows_nothing_ = true;
    canvas_->renderer->begin_exposure();
}

void SceneRenderer::expose(const State& state, const view::Camera& map, const Traces& traces) {
    canvas_->context.make_current();
    list(state, map, traces);
    shows_nothing_ = list_.shows_nothing() && shows_nothing_;
    check_tints();
    const CancelScope current = keep_current();
    check_cancelled();
    canvas_->renderer->expose(list_);
}

Damage SceneRenderer::develop(const view::Caption& caption, const view::Camera& map) {
    canvas_->context.make_current();
    view_.start(list_);
    annotate(caption, map, list_);
    return canvas_->renderer->develop(list_);
}

Damage SceneRenderer::paint() {
    canvas_->context.make_current();  // the host may have made another one current since open()
    shows_nothing_ = list_.shows_nothing();
    check_tints();
    const CancelScope current = keep_current();
    return canvas_->renderer->render(list_);
}

void SceneRenderer::check_tints() {
    if (canvas_->has_checked_tints || !list_.has_tints()) return;
    render::check_driver(canvas_->context, *canvas_->renderer, true);
    canvas_->has_checked_tints = true;
}

CancelScope SceneRenderer::keep_current() {
    return CancelScope([this] { canvas_->context.make_current(); });
}

}  // namespace corda::film

namespace corda {

struct Renderer::Impl {
    Impl(const Scene& given, const std::string& backend)
        : scene((check_definitions(given), given)),
          system(system_of(scene)),
          renderer(scene, system, backend, false) {
        if (quantity_of(scene.style.color_by)) {
            throw Error(ExitCode::kInvalidScene,
                        "style: color_by is a quantity of a motion, and a Renderer draws positions alone; "
                        "choose kBody or kLink");
        }
        if (scene.style.arrows != Arrows::kNone) {
            throw Error(
                ExitCode::kInvalidScene,
                "style: arrows have the scale of a motion, and a Renderer draws positions alone; leave "
                "them out");
        }
        if (!scene.overlay.plots.empty()) {
            throw Error(
                ExitCode::kInvalidScene,
                "overlay: plots show a whole motion, and a Renderer draws positions alone; leave them out");
        }
        camera = renderer.fit(bounds_of_start(system));
    }
    Scene scene;
    System system;
    film::SceneRenderer renderer;
    CameraDef camera;
    State state;
};

Renderer::Renderer(const Scene& scene, const std::string& backend) {
    try {
        impl_ = std::make_unique<Impl>(scene, backend);
    } catch (const Refusal& refusal) {
        throw film::explained(refusal, scene);
    }
}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

const CameraDef& Renderer::camera() const {
    return impl_->camera;
}

Image Renderer::draw(std::span<const Vec2> positions_m) {
    const std::size_t count = impl_->system.particle_count();
    if (positions_m.size() != count) {
        throw_usage("{} positions for the {} particles of the scene; give one each", positions_m.size(),
                    count);
    }
    State& state = impl_->state;
    state.x_m.resize(count);
    state.y_m.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (!std::isfinite(positions_m[i].x) || !std::isfinite(positions_m[i].y))
            throw_usage("position {} is not finite", i);
        state.x_m[i] = positions_m[i].x - impl_->system.origin_m.x;
        state.y_m[i] = positions_m[i].y - impl_->system.origin_m.y;
    }
    const film::SceneRenderer::Use use(impl_->renderer);
    const view::Camera map = impl_->renderer.map_of(impl_->camera);
    view::Caption caption;
    impl_->renderer.locate_labels(state, map, caption);
    impl_->renderer.draw(state, map, caption);
    return impl_->renderer.image();
}

}  // namespace corda
