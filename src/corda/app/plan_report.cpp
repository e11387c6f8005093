#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/machine.hpp"
#include "corda/film/motion.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/sim/solver.hpp"

namespace corda::app {

namespace {

/// Shows how far the simulation of a film is once it takes more than a second.
OnProgress show_progress(const Console& console, const std::string& what) {
    constexpr double kSilentSeconds = 1.0;
    constexpr unsigned kCallsPerLook = 16;  // at the clock; calls are a millisecond apart, or less
    const double start_s = now_s();
    return [&console, what, start_s, progress = std::shared_ptr<Progress>(), last = std::int64_t{0},
            calls = 0U](std::int64_t done, std::int64_t total) mutable {
        if (done < last || !progress) progress = std::make_shared<Progress>(console, what, total);
        last = done;
        const bool looks = ++calls % kCallsPerLook == 0 || done == total;
        if (looks && now_s() - start_s > kSilentSeconds) progress->update(done);
        return true;
    };
}

/// Shows notes; of many, as ten thousand copies of a rope may have, the first ones.
void warn_of_notes(const Console& console, const std::vector<std::string>& notes) {
    constexpr std::size_t kMost = 10;
    const std::size_t shown = std::min(notes.size(), kMost);
    for (std::size_t i = 0; i < shown; ++i) console.warning(notes[i]);
    if (shown < notes.size())
        console.warning(
            fmt::format("{} more, which `corda plan --json` lists as notes", notes.size() - shown));
}

/// Reports the bodies for which `auto` has no error estimate.
void warn_of_no_estimate(const Console& console, const Film& film) {
    const Plan& plan = film.plan();
    for (const MethodGroup& group : groups_of(plan)) {
        const BodyPlan& body = plan.bodies[group.bodies.front()];
        if (body.reason == PlanReason::kNamed || body.error_estimate_m) continue;
        const std::string whose =
            plan.bodies.size() == 1 ? "" : bodies_text(film.system(), group.bodies) + ": ";
        console.warning(
            fmt::format("auto: {}{}: {}", whose, sim::method_text(group.method), reason_text(body)));
    }
}

/// Warns of nets that stand still, probably by mistake.
void warn_of_still_nets(const Console& console, const Film& film) {
    const Plan& plan = film.plan();
    for (std::size_t i = 0; i < plan.bodies.size(); ++i) {
        const bool is_alone = plan.bodies.size() == 1;
        if (const std::optional<std::string> text = still_text(plan.bodies[i], is_alone))
            console.warning(fmt::format("{} stands still: {}", body_name(film.system(), i), *text));
    }
}

void warn_of_horizon(const Console& console, const Film& film) {
    const Plan& plan = film.plan();
    if (!plan.horizon_s) return;
    const auto is_first = [&](const BodyPlan& body) { return body.horizon_s == plan.horizon_s; };
    const auto first = std::ranges::find_if(plan.bodies, is_first);
    const std::string whose =
        plan.bodies.size() == 1
            ? ""
            : " of " + body_name(film.system(), static_cast<std::size_t>(first - plan.bodies.begin()));
    if (first->diverges) {
        const auto [cause, remedy] = film::divergence_of(film.motion());
        console.warning(fmt::format("the simulation{} diverges after {:.6g} s{}; {} may help", whose,
                                    *plan.horizon_s, cause, remedy));
    } else if (first->unchecked) {
        console.warning(fmt::format("the error estimate{} ends at {:.6g} s: {}", whose, *plan.horizon_s,
                                    *horizon_reason(*first)));
    } else {
        const double tolerance_px = std::get<AutoDef>(film.scene().solver).tolerance_px;
        console.warning(fmt::format(
            "predictability{} ends at {:.6g} s: from there two runs of high precision {}differ by "
            "more than {:.3g} px, because {}; later frames show one possible motion",
            whose, *plan.horizon_s, first->undecided ? "can " : "", tolerance_px, *horizon_reason(*first)));
    }
}

}  // namespace

Film make_film(const Console& console, const Scene& scene, FilmDef def, const std::string& what) {
    def.on_progress = show_progress(console, what);
    Film film(scene, def);
    warn_of_notes(console, film.plan().notes);
    if (film.scene().given || !std::holds_alternative<AutoDef>(film.scene().solver)) return film;
    if (const auto estimate = error_estimate_text(film)) {
        console.info(fmt::format("auto: {}; error estimate {}, from tighter runs",
                                 plan_text(film.system(), film.plan()), *estimate));
    }
    warn_of_no_estimate(console, film);
    warn_of_still_nets(console, film);
    warn_of_horizon(console, film);
    return film;
}

void warn_of_room(const Console& console, const Film& film) {
    for (const std::string& problem : film.left_out())
        console.warning(fmt::format("{}: {}", film.scene().source, problem));
    constexpr double kFar = 20.0;  // extents of the start: of 1080 pixels, it takes 54
    const MotionBounds start = whole_bounds_of_start(film.system());
    const Vec2 extent = start.max_m() - start.min_m();
    const CameraDef& given = film.scene().camera;
    const double extent_m = std::max(extent.x, extent.y);
    const double height_m = *film.camera().height_m;
    if (!given.height_m && given.path.empty() && extent_m > 0.0 && height_m > kFar * extent_m)
        console.warning(fmt::format(
            "{}: the camera is {:.3g} m high to show the whole motion, {:.0f} times the extent of the start; "
            "give camera.center and camera.height to show a part of it",
            film.scene().source, height_m, height_m / extent_m));
}

void warn_of_branch(const Console& console, const Film& film) {
    const std::optional<double> branched_s = film.diagnostics().branched_s;
    const bool is_named =
        std::any_of(film.plan().bodies.begin(), film.plan().bodies.end(), [](const auto& body) {
            return body.reason == PlanReason::kNamed;  // the plan says it of the others
        });
    if (!branched_s || !is_named) return;
    console.warning(
        fmt::format("before {:.6g} s bars of a net lay in line, from where several motions are possible; the "
                    "pictures show one of them; another solver.step may avoid that, and method auto finds "
                    "how far its own motion is right",
                    *branched_s));
}

ExitCode report_empty(const Console& console, const EmptyPictures& empty, bool fails,
                      const CameraDef& camera) {
    const auto& [count, all, first_s] = empty;
    if (count == 0) return ExitCode::kOk;
    const std::string which =
        all == 1 ? fmt::format("the picture at {:.6g} s is empty", first_s)
                 : fmt::format("{} of {} pictures are empty, the first at {:.6g} s", count, all, first_s);
    if (!camera.center_m && !camera.height_m && camera.path.empty())
        console.warning(fmt::format(
            "{}: letters and plots leave the scene no room; give a larger picture, or fewer or smaller ones",
            which));
    else
        console.warning(fmt::format(
            "{}: nothing is in view of the camera; change {}, or leave them out, and all is in view", which,
            camera.path.empty() ? "camera.center and camera.height"
                                : "center and height of the keys of camera.path"));
    return fails ? ExitCode::kMismatch : ExitCode::kOk;
}

void report_gl(const Console& console, const GlInfo& gl) {
    console.detail(fmt::format("drawing with {} ({}), OpenGL {}, by {}", gl.renderer, gl.vendor, gl.version,
                               gl.platform));
}

nlohmann::json film_json(const Film& film) {
    const Plan& plan = film.plan();
    const System& system = film.system();
    const bool is_known = plan.horizon_s != 0.0;  // the estimate is not of the start alone
    nlohmann::json json = {{"schema", 1},
                           {"method", method_names(plan)},
                           {"solver", plan_text(system, plan)},
                           {"particles", system.particle_count()},
                           {"bars", system.bars.size()},
                           {"links", system.link_count()},
                           {"error_estimate_m", is_known ? or_null(plan.error_estimate_m) : nullptr},
                           {"error_estimate_px", is_known ? or_null(film.error_estimate_px()) : nullptr},
                           {"horizon_s", or_null(plan.horizon_s)}};
    const CameraDef& camera = film.camera();
    json["camera"] = {{"center", {camera.center_m->x, camera.center_m->y}}, {"height", *camera.height_m}};
    json["notes"] = plan.notes;
    json["simulation_passes"] = film.plan().simulation_passes;
    return json;
}

}  // namespace corda::app
