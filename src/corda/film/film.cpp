#include "corda/film/film.hpp"

#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/text.hpp"
#include "corda/film/film_renderer.hpp"
#include "corda/film/live_plot_data.hpp"
#include "corda/film/motion.hpp"
#include "corda/film/motion_input.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/sim/auto/planner.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/camera.hpp"

namespace corda {
namespace {

/// Maximum number of capsules in several poses: more would be indistinguishable, and take much memory.
constexpr std::size_t kMaxPoseCapsules = 5'000'000;

}  // namespace

struct Film::Impl {
    using DrawContext = film::DrawContext;
    using Use = film::SharedMotion::Use;

    Impl(const Scene& given, FilmDef options)
        : scene(given),
          def(std::move(options)),
          run(std::make_shared<film::SharedMotion>(scene)),
          system(run->system),
          drawing(scene, system, def),
          plot_data(scene, system),
          motion(start_motion()),
          plan(run->plan) {
        if (motion.methods().empty()) {
            plan = motion.record([&](const Timeline& timeline, sim::Recording& recording) {
                return plan_within(timeline, recording);
            });
        } else {
            for (const MethodDef& method : motion.methods()) plan.bodies.emplace_back().method = method;
        }
        const CancelScope starting = reporting_start();
        plan.notes = film::input_notes(scene, system, plan);
    }

    /// Calls on_progress, with nothing done, until the simulation starts.
    CancelScope reporting_start() const {
        return CancelScope(
            [this] { report_progress(def.on_progress, 0, film::last_frame_of(scene) + 1); });
    }

    film::Motion& start_motion() const {
        const CancelScope starting = reporting_start();
        return run->motion.emplace(system, scene.world, film::if_all_named(run->named), timeline(),
                                   def.motion_budget_bytes, quantity_of(scene.style.color_by),
                                   def.readings.with(plot_data.readings())
                                       .with(view::fields_of(scene.style.arrows))
                                       .with({.velocities = scene.style.trail_s > 0.0}));
    }

    /// Required while the motion is read.
    Use reading() const { return {*run, def.on_progress}; }

    /// The times to record.
    Timeline timeline() const {
        std::vector<double> times_s = plot_data.times_s();
        times_s.insert(times_s.end(), def.stills_s.begin(), def.stills_s.end());
        return film::recorded_times(scene, system, std::move(times_s), def.motion_budget_bytes);
    }

    /// Shares the motion of another film.
    Impl(const Impl& other, const Scene& given)
        : scene(given),
          def(other.def),
          run(other.run),
          system(run->system),
          drawing(scene, system, def),
          plot_data(scene, system),
          motion(*run->motion),
          plan(run->plan) {}

    Plan plan_within(const Timeline& timeline, sim::Recording& recording) const {
        const double tolerance_px = std::get<AutoDef>(scene.solver).tolerance_px;
        const auto tolerance_m = [&](const MotionBounds& bounds) {
            return tolerance_px / drawing.renderer.largest_pixels_per_metre(bounds);
        };
        return sim::plan_methods(system, run->named, scene.world,
                                 {tolerance_m, timeline, def.on_progress, now_s}, recording);
    }

    /// The camera, fitted to the motion if it depends on it.
    const CameraDef& find_camera() {
        const Use use = reading();
        return find_camera_locked();
    }

    const CameraDef& find_camera_locked() {
        if (camera) return *camera;
        if (drawing.renderer.needs_motion()) motion.run_to_end();
        const auto state_at = [this](double time_s) -> const State& { return motion.at(time_s); };
        if (!scene.overlay.plots.empty()) {
            plots = plot_data.read(motion.methods(), last_s_locked(), state_at,
                                   [this](const State& state) { return motion.energy_of(state); });
        }
        if (scene.style.arrows != Arrows::kNone)
            arrows = drawing.renderer.arrow_extents(last_s_locked(), state_at);
        CameraDef fitted = fit_locked(drawing.renderer);
        if (scene.camera.moves())
            track = drawing.renderer.track(scene.camera.follow ? last_s_locked() : 0.0, state_at, fitted);
        return camera.emplace(fitted);
    }

    CameraDef camera_at(double time_s) {
        const CameraDef& still = find_camera();
        return track ? track->at(still, time_s) : still;
    }

    view::Camera map_at(double time_s, const film::SceneRenderer& renderer) {
        return renderer.map_of(camera_at(time_s));
    }

    /// Fits a renderer to the motion.
    CameraDef fit_locked(film::SceneRenderer& renderer) const {
        if (!plots.empty()) renderer.set_plots(plots);
        if (arrows) renderer.set_arrows(*arrows);
        // The start exists even if the first step diverges.
        const sim::Recording& recording = motion.recording();
        return renderer.fit(recording.size() > 0 ? recording.particle_bounds() : bounds_of_start(system),
                            recording.histogram());
    }

    /// The state of another renderer of this film.
    std::unique_ptr<DrawContext> make_context(film::OwnedCanvas* canvas) {
        const Use use = reading();
        static_cast<void>(find_camera_locked());
        auto made = std::make_unique<DrawContext>(scene, system, def);
        static_cast<void>(fit_locked(made->renderer));
        made->trails = drawing.trails;
        if (canvas != nullptr) made->renderer.set_canvas(std::move(*canvas));
        return made;
    }

    /// A time in the form of time_within(). Throws corda::Error (kUsage) if there is no motion at that time.
    [[nodiscard]] double checked_s(double time_s) const {
        if (const auto within_s = film::motion_time_s(scene, time_s)) return *within_s;
        throw_usage("{} s is not within 0 .. {} s; world.duration sets the end", time_s,
                    scene.world.duration_s);
    }

    const State& at(double time_s) {
        time_s = checked_s(time_s);
        const Use use = reading();
        asked = motion.at(time_s);
        figures = motion.figures();
        return asked;
    }

    /// Reads the state at a time, and the trails up to it, into a draw context. Threads may do so at once,
    /// each with its own context.
    const State& read(double time_s, DrawContext& by) {
        time_s = checked_s(time_s);
        const Use use = reading();
        by.trails.read(motion, time_s);
        by.state = motion.at(time_s);
        by.figures = motion.figures();
        by.energy.reset();
        if (scene.overlay.energy && !by.figures.energy_error) by.energy = motion.energy_of(by.state);
        return by.state;
    }

    view::DrawList list_poses(std::span<const double> times_s) {
        film::SceneRenderer& renderer = drawing.renderer;
        const view::Camera map = map_at(times_s.back(), renderer);
        const view::SceneView& view = renderer.view();
        view::DrawList list;
        view.start(list);
        view.draw_trails(drawing.trails.to(read(times_s.back(), drawing)), map, list);
        std::vector<view::PoseTime> poses;
        for (std::size_t k = 0; k < times_s.size(); ++k) {
            check_cancelled();
            const double opacity = view::pose_opacity(k, times_s.size());
            poses.push_back(renderer.add_pose(read(times_s[k], drawing), map, opacity, list));
            if (k > 0 && list.capsules.size() > kMaxPoseCapsules) {
                throw_usage("{} of {} poses have over {} lines in all; ask for fewer times", k + 1,
                            times_s.size(), kMaxPoseCapsules);
            }
        }
        view.draw_supports(drawing.state, map, list);
        view::Caption caption = caption_of(drawing, map);
        if (times_s.size() > 1) {  // the picture has no single time
            caption.time_s.reset();
            caption.energy_error.reset();
            renderer.annotate_poses(times_s, std::move(poses), list);
        }
        renderer.draw_curves(times_s.back(), list);
        renderer.annotate(caption, map, list);
        return list;
    }

    /// The caption of the state in a draw context.
    view::Caption caption_of(const DrawContext& by, const view::Camera& map) const {
        std::optional<double> estimate_px;
        if (plan.error_estimate_m) estimate_px = *plan.error_estimate_m * map.pixels_per_metre();
        const std::string method = method_caption(plan, estimate_px, scene.overlay.language);
        view::Caption caption{by.state.time_s, by.figures.energy_error, method, {}, by.energy};
        by.renderer.locate_labels(by.state, map, caption);
        return caption;
    }

    /// Requires a Use of the context's renderer.
    Damage draw(double time_s, double shutter, DrawContext& by) {
        const film::SharedMotion::Activity drawing_it(*run);
        time_s = checked_s(time_s);
        if (!(shutter >= 0.0 && shutter <= 1.0)) throw_usage("a shutter of {} is not within 0 .. 1", shutter);
        if (shutter > 0.0) return expose(time_s, shutter, by);
        const view::Camera map = map_at(time_s, by.renderer);
        const State& state = read(time_s, by);
        return by.renderer.draw(state, map, caption_of(by, map), {by.trails.to(state), state.time_s});
    }

    /// The end of the motion: that of the scene, or the last recorded state if the motion diverges. Simulates
    /// it to its end.
    double last_s() {
        const Use use = reading();
        return last_s_locked();
    }

    double last_s_locked() {
        motion.run_to_end();
        const std::size_t states = motion.recording().size();
        return motion.diverges() && states > 0 ? motion.timeline().time_s(states - 1)
                                               : scene.world.duration_s;
    }

    /// Reads the states in order of time, so that those that are not recorded take one simulation.
    Damage expose(double time_s, double shutter, DrawContext& by) {
        const view::Camera map = map_at(time_s, by.renderer);
        const double end_s = last_s();
        by.renderer.begin_exposure();
        std::optional<view::Caption> caption;
        const auto note = [&] {
            static_cast<void>(read(time_s, by));
            caption = caption_of(by, map);
        };
        for (int i = 0; i < scene.video.subframes; ++i) {
            const double at_s = film::subframe_s(scene.video, time_s, shutter, end_s, i);
            if (!caption && at_s >= time_s) note();
            const State& state = read(at_s, by);
            by.renderer.expose(state, map_at(at_s, by.renderer), {by.trails.to(state), time_s});
        }
        if (!caption) note();
        return by.renderer.develop(*caption, map);
    }

    /// True if the frame at a time would be empty.
    bool is_empty(double time_s) {
        const auto shows_nothing_at = [&](double at_s) {
            const view::Camera map = map_at(at_s, drawing.renderer);
            const State& state = read(at_s, drawing);
            return drawing.renderer.would_show_nothing(state, map, {drawing.trails.to(state), time_s});
        };
        const VideoDef& video = scene.video;
        if (video.shutter == 0.0) return shows_nothing_at(time_s);
        const double end_s = last_s();
        for (int i = 0; i < video.subframes; ++i)
            if (!shows_nothing_at(film::subframe_s(scene.video, time_s, video.shutter, end_s, i)))
                return false;
        return true;
    }

    /// True if frames before `end` can be drawn in any order without another simulation.
    bool holds(std::int64_t end) {
        const Use use = reading();
        const VideoDef& video = scene.video;
        const double last_frame_s = video.scene_rate().time_s(end - 1);
        const double needed_s =
            video.shutter > 0.0
                ? std::max(last_frame_s, film::subframe_s(scene.video, last_frame_s, video.shutter,
                                                              last_s_locked(), video.subframes - 1))
                : last_frame_s;
        const auto last = motion.timeline().find(needed_s);
        if (!last) return false;
        try {
            if (motion.recording().size() <= *last) static_cast<void>(motion.at(needed_s));
        } catch (const Error& error) {
            if (error.code() != ExitCode::kDiverged) throw;
        }
        return motion.recording().holds(*last);
    }

    Scene scene;
    FilmDef def;
    std::shared_ptr<film::SharedMotion> run;
    const System& system;
    DrawContext drawing;  ///< of frames and stills
    film::LivePlotData plot_data;
    film::Motion& motion;
    Plan& plan;
    std::vector<view::PlotData> plots;
    std::optional<view::ArrowExtents> arrows;
    std::optional<CameraDef> camera;
    std::optional<view::CameraTrack> track;  ///< of a camera that moves
    State asked;                             ///< returned last by at()
    Figures figures;                         ///< of that state
};

Film::Film(const Scene& scene, FilmDef def) {
    try {
        film::validate(scene, def.stills_s);
        for (double& time_s : def.stills_s) time_s = *film::motion_time_s(scene, time_s);
        impl_ = std::make_unique<Impl>(scene, std::move(def));
    } catch (const Refusal& refusal) {
        throw film::explained(refusal, scene);
    }
}

Film::Film(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Film::Film(Film&&) noexcept = default;
Film& Film::operator=(Film&&) noexcept = default;

Film::~Film() = default;

const Scene& Film::scene() const {
    return impl_->scene;
}

const System& Film::system() const {
    return impl_->system;
}

std::int64_t Film::frame_count() const {
    return impl_->scene.video.scene_rate().frame_count(impl_->scene.world.duration_s);
}

std::int64_t Film::last_frame() const {
    return film::last_frame_of(impl_->scene);
}

double Film::time_s(std::int64_t k) const {
    if (k >= 0 && k <= last_frame()) return impl_->scene.video.scene_rate().time_s(k);
    throw_usage("frame {} is not within 0 .. {}", k, last_frame());
}

const Plan& Film::plan() const {
    return impl_->plan;
}

std::optional<double> Film::error_estimate_px() {
    if (!plan().error_estimate_m) return std::nullopt;
    const CameraDef& still = impl_->find_camera();
    return *plan().error_estimate_m * scene().video.height_px / view::least_height_m(still, *still.height_m);
}

const CameraDef& Film::camera() {
    return impl_->find_camera();
}

CameraDef Film::camera_at(double time_s) {
    return impl_->camera_at(time_s);
}

int Film::simulation_passes() const {
    return plan().simulation_passes + impl_->motion.passes();
}

const State& Film::state(std::int64_t k) {
    return impl_->at(time_s(k));
}

const State& Film::state_at(double time_s) {
    return impl_->at(time_s);
}

const Figures& Film::figures() const {
    return impl_->figures;
}

Energy Film::energy() {
    const film::SharedMotion::Use use = impl_->reading();
    return impl_->motion.energy_of(impl_->asked);
}

const Diagnostics& Film::diagnostics() const {
    return impl_->motion.recording().diagnostics();
}

double Film::stepping_s() const {
    return impl_->motion.recording().wall_s();
}

Image Film::frame(std::int64_t k) {
    return still(time_s(k), scene().video.shutter);
}

Image Film::still(double time_s, double shutter) {
    const film::SceneRenderer::Use use(impl_->drawing.renderer);
    impl_->draw(time_s, shutter, impl_->drawing);
    return impl_->drawing.renderer.image();
}

std::vector<std::uint8_t> Film::mask(std::int64_t k) {
    const view::Camera map = impl_->map_at(time_s(k), impl_->drawing.renderer);
    return impl_->drawing.renderer.mask(state(k), map);
}

std::vector<Vec2> Film::to_pixels(std::span<const Vec2> positions_m, double time_s) {
    const view::Camera map = impl_->map_at(time_s, impl_->drawing.renderer);
    std::vector<Vec2> pixels;
    for (const Vec2 position_m : positions_m) {
        const Vec2 relative_m = position_m - system().origin_m;
        pixels.push_back({map.x_px(relative_m.x), map.y_px(relative_m.y)});
    }
    return pixels;
}

bool Film::shows_nothing() const {
    return impl_->drawing.renderer.shows_nothing();
}

std::vector<std::string> Film::left_out() {
    impl_->find_camera();
    return film::left_out_of(scene(), impl_->drawing.renderer.plots());
}

GlInfo Film::gl() {
    const film::SceneRenderer::Use use(impl_->drawing.renderer, film::SceneRenderer::Needs::kContext);
    const gl::Context& context = impl_->drawing.renderer.context();
    return {context.info().gl_renderer, context.info().gl_vendor, context.info().gl_version,
            context.platform()};
}

FilmRenderer::FilmRenderer(Film& film, film::OwnedCanvas* canvas)
    : film_(&film), lent_(canvas), context_(film.impl_->make_context(canvas)), use_(context_->renderer) {}

FilmRenderer::~FilmRenderer() {
    if (lent_ != nullptr) *lent_ = context_->renderer.take_canvas();
}

bool FilmRenderer::can_draw_in_any_order(Film& film, std::int64_t end) {
    return film.impl_->holds(end);
}

Damage FilmRenderer::draw(double time_s) {
    Film::Impl& impl = *film_->impl_;
    return impl.draw(time_s, impl.scene.video.shutter, *context_);
}

view::DrawList FilmRenderer::list_poses(Film& film, std::span<const double> times_s) {
    return film.impl_->list_poses(times_s);
}

Image FilmRenderer::draw_poses(Film& film, std::span<const double> times_s) {
    film::SceneRenderer& renderer = film.impl_->drawing.renderer;
    const film::SceneRenderer::Use use(renderer);
    const film::SharedMotion::Activity drawing(*film.impl_->run);
    renderer.draw(film.impl_->list_poses(times_s));
    return renderer.image();
}

film::SharedMotion& FilmRenderer::motion_of(Film& film) {
    return *film.impl_->run;
}

Film FilmRenderer::another_look(const Film& film, const Scene& look) {
    if (!look.overlay.plots.empty() || look.style.color_by != film.scene().style.color_by ||
        look.style.arrows != film.scene().style.arrows || look.style.trail_s > film.scene().style.trail_s)
        throw Error(ExitCode::kInternal, "another look of a film needs what its motion does not have");
    return Film(std::make_unique<Film::Impl>(*film.impl_, look));
}

void FilmRenderer::keep(Film& film, std::span<const double> times_s) {
    std::vector<double> checked_s;
    for (const double time_s : times_s) checked_s.push_back(film.impl_->checked_s(time_s));
    const film::SharedMotion::Use use = film.impl_->reading();
    film.impl_->motion.keep(checked_s);
}

bool FilmRenderer::is_empty(Film& film, double time_s) {
    return film.impl_->is_empty(time_s);
}

}  // namespace corda
