#include "corda/film/film.hpp"

#include <cmath>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"
#include "corda/film/draw.hpp"
#include "corda/film/live_plots.hpp"
#include "corda/film/look.hpp"
#include "corda/film/motion.hpp"
#include "corda/film/motion_input.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/camera.hpp"

namespace corda {

struct Film::Impl {
    gl::ContextDef gl;
    std::shared_ptr<const film::Motion> motion;  ///< of other looks, too
    film::Look look;
};

Film::Film(const Scene& scene, const FilmDef& def) {
    try {
        gl::ContextDef gl = gl::ContextDef::parse(def.backend);
        gl.require_gpu = def.require_gpu;
        film::validate(scene, def.stills_s);
        film::RecordDef record{{}, def.stills_shutter, def.readings, def.on_progress, def.clock_s};
        for (const double time_s : def.stills_s)
            record.times_s.push_back(*film::motion_time_s(scene, time_s));
        auto motion = film::simulate(scene, record);
        const auto all = static_cast<std::int64_t>(motion->timeline->size());
        const CancelScope looking([&] { report_progress(def.on_progress, all, all); });
        film::Look look = film::look_at(scene, *motion);
        impl_ = std::make_shared<Impl>(Impl{gl, std::move(motion), std::move(look)});
    } catch (const Refusal& refusal) {
        throw film::explained(refusal, scene);
    }
}

Film::Film(Scene scene, GivenMotion motion, const FilmDef& def)
    : Film((give_motion(scene, std::move(motion)), scene), def) {}

Film::Film(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

const Scene& Film::scene() const {
    return impl_->look.scene;
}

const System& Film::system() const {
    return impl_->motion->system;
}

std::int64_t Film::frame_count() const {
    return scene().video.scene_rate().frame_count(scene().world.duration_s);
}

std::int64_t Film::last_frame() const {
    return film::last_frame_of(scene());
}

double Film::time_s(std::int64_t k) const {
    if (k >= 0 && k <= last_frame()) return scene().video.scene_rate().time_s(k);
    throw_usage("frame {} is not within 0 .. {}", k, last_frame());
}

double Film::checked_s(double time_s) const {
    if (const auto within_s = film::motion_time_s(scene(), time_s)) return *within_s;
    throw_usage("{} s is not within 0 .. {} s; world.duration sets the end", time_s,
                scene().world.duration_s);
}

const Plan& Film::plan() const {
    return impl_->motion->plan;
}

std::optional<double> Film::error_estimate_px() const {
    if (!plan().error_estimate_m) return std::nullopt;
    return view::error_px(camera(), *plan().error_estimate_m, *camera().height_m, scene().video.height_px);
}

const CameraDef& Film::camera() const {
    return impl_->look.camera;
}

CameraDef Film::camera_at(double time_s) const {
    return impl_->look.camera_at(time_s);
}

State Film::state(std::int64_t k) const {
    return motion().at(time_s(k));
}

State Film::state_at(double time_s) const {
    return motion().at(checked_s(time_s));
}

Figures Film::figures_at(double time_s) const {
    time_s = checked_s(time_s);
    Figures figures;
    motion().for_each({&time_s, 1}, [&](const State& /*state*/, const Figures& read) { figures = read; });
    return figures;
}

Energy Film::energy_of(const State& state) const {
    return motion().energy_of(state);
}

const Diagnostics& Film::diagnostics() const {
    return motion().recording->diagnostics();
}

double Film::stepping_s() const {
    return motion().recording->wall_s();
}

Image Film::frame(std::int64_t k) const {
    return still(time_s(k), scene().video.shutter);
}

Image Film::still(double time_s, double shutter) const {
    const render::CanvasUse canvas(impl_->gl);
    film::paint(look(), motion(), checked_s(time_s), shutter, *canvas);
    return canvas->image();
}

bool Film::is_empty(double time_s, double shutter) const {
    return film::is_empty(look(), motion(), checked_s(time_s), shutter);
}

std::vector<std::uint8_t> Film::mask(std::int64_t k) const {
    return film::mask(look(), state(k));
}

std::vector<Vec2> Film::to_pixels(std::span<const Vec2> positions_m, double time_s) const {
    const view::Camera map = look().map_at(time_s);
    std::vector<Vec2> pixels;
    for (const Vec2 position_m : positions_m) {
        const Vec2 relative_m = position_m - system().origin_m;
        pixels.push_back({map.x_px(relative_m.x), map.y_px(relative_m.y)});
    }
    return pixels;
}

std::vector<std::string> Film::left_out() const {
    return film::left_out_of(scene(), look().overlay.plots);
}

GlInfo Film::gl() const {
    const render::CanvasUse canvas(impl_->gl);
    const gl::Context& context = canvas->context();
    return {context.info().gl_renderer, context.info().gl_vendor, context.info().gl_version,
            context.platform()};
}

Film Film::with_look(const Scene& scene) const {
    const Scene& own = this->scene();
    const bool has_plots = std::ranges::all_of(scene.overlay.plots, [&own](LivePlot plot) {
        return std::ranges::find(own.overlay.plots, plot) != own.overlay.plots.end();
    });
    if (!has_plots || (scene.overlay.energy && !own.overlay.energy) ||
        scene.style.color_by != own.style.color_by || scene.style.arrows != own.style.arrows ||
        scene.style.trail_s > own.style.trail_s)
        throw Error(ExitCode::kInternal, "another look of a film needs what its motion does not have");
    return Film(std::make_shared<Impl>(Impl{impl_->gl, impl_->motion, film::look_at(scene, motion())}));
}

const film::Motion& Film::motion() const {
    return *impl_->motion;
}

const film::Look& Film::look() const {
    return impl_->look;
}

const gl::ContextDef& Film::context_def() const {
    return impl_->gl;
}

struct Renderer::Impl {
    Impl(const Scene& given, const std::string& backend)
        : system((check_definitions(given), system_of(given))),
          gl(gl::ContextDef::parse(backend)),
          look(film::look_within(given, system, bounds_of_start(system))) {
        const Scene& scene = look.scene;
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
    }
    System system;
    gl::ContextDef gl;
    film::Look look;
};

Renderer::Renderer(const Scene& scene, const std::string& backend) {
    try {
        impl_ = std::make_shared<Impl>(scene, backend);
    } catch (const Refusal& refusal) {
        throw film::explained(refusal, scene);
    }
}

const CameraDef& Renderer::camera() const {
    return impl_->look.camera;
}

Image Renderer::draw(std::span<const Vec2> positions_m) const {
    const System& system = impl_->system;
    const std::size_t count = system.particle_count();
    if (positions_m.size() != count) {
        throw_usage("{} positions for the {} particles of the scene; give one each", positions_m.size(),
                    count);
    }
    State state;
    for (std::size_t i = 0; i < count; ++i) {
        if (!std::isfinite(positions_m[i].x) || !std::isfinite(positions_m[i].y))
            throw_usage("position {} is not finite", i);
        state.x_m.push_back(positions_m[i].x - system.origin_m.x);
        state.y_m.push_back(positions_m[i].y - system.origin_m.y);
    }
    const render::CanvasUse canvas(impl_->gl);
    film::draw(impl_->look, state, canvas->list());
    canvas->paint(canvas->list());
    return canvas->image();
}

}  // namespace corda
