#include "corda/film/motion.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"
#include "corda/film/given.hpp"
#include "corda/film/live_plots.hpp"
#include "corda/film/look.hpp"
#include "corda/film/motion_input.hpp"
#include "corda/sim/auto/planner.hpp"
#include "corda/sim/moving_pins.hpp"
#include "corda/view/arrows.hpp"

namespace corda::film {
namespace {

[[noreturn]] void fail_diverged(const Motion& motion, double time_s) {
    const std::size_t states = motion.recording->size();
    const double last_s = states == 0 ? 0.0 : motion.timeline->time_s(states - 1);
    const bool has_step = std::ranges::any_of(motion.plan.bodies, [](const BodyPlan& body) {
        return !std::holds_alternative<ExactDef>(body.method);
    });
    const Divergence divergence = divergence_of(motion);
    throw Error(
        ExitCode::kDiverged,
        Problem{
            {},
            fmt::format("the simulation diverged before t = {:.6g} s (last good state at {:.6g} s{})", time_s,
                        last_s, divergence.cause),
            fmt::format("{} may help{}", divergence.remedy, has_step ? ", or a smaller solver.step" : "")});
}

/// Whose pins are farther apart at a time than the links between them reach, of chains of rigid links that
/// nothing is cut from; empty if there are none.
std::string pins_out_of_reach(const System& system, double time_s) {
    const auto distance = [](Vec2 a, Vec2 b) { return sim::length(a.x - b.x, a.y - b.y); };
    const auto place_of = [&](std::size_t pin) {
        Vec2 place_m{system.x_m[pin], system.y_m[pin]};
        for (const MoveDef& move : system.moves)
            if (move.pin == pin) place_m = place_m + sim::displacement_of(move)(time_s);
        return place_m;
    };
    if (system.has_events()) return "";
    for (std::size_t b = 0; b < system.bodies.size(); ++b) {
        const Body& body = system.bodies[b];
        if (!body.is_chain || body.material.compliance_1_n > 0.0) continue;
        std::optional<std::size_t> last;
        double reach_m = 0.0;
        for (std::size_t k = 0; k < body.particle_count; ++k) {
            const std::size_t i = body.first_particle + k;
            if (k > 0) reach_m += system.bars[body.first_bar + k - 1].rest_m;
            if (!system.is_pinned(i)) continue;
            const double apart_m = last ? distance(place_of(i), place_of(*last)) : 0.0;
            if (apart_m > reach_m)
                return fmt::format(
                    "; pins {} and {} of {} are then {:.4g} m apart, and the links between them reach {:.4g} "
                    "m",
                    *last - body.first_particle, k, body_name(system, b), apart_m, reach_m);
            last = i;
            reach_m = 0.0;
        }
    }
    return "";
}

/// The times to record.
Timeline timeline_of(const Scene& scene, const System& system, const RecordDef& def) {
    const VideoDef& video = scene.video;
    std::vector<double> times_s = def.times_s;
    const auto add_exposure = [&](double time_s, double shutter) {
        for (int i = 0; i < video.subframes && shutter > 0.0; ++i)
            times_s.push_back(subframe_s(video, time_s, shutter, scene.world.duration_s, i));
    };
    for (const double time_s : def.times_s) add_exposure(time_s, def.shutter);
    for (const std::vector<double>& more_s : {plot_times_s(scene, system), arrow_times_s(scene)})
        times_s.insert(times_s.end(), more_s.begin(), more_s.end());
    const std::int64_t last_frame = last_frame_of(scene);
    for (std::int64_t k = 0; k <= last_frame; ++k) add_exposure(video.scene_rate().time_s(k), video.shutter);
    return {video.scene_rate(), last_frame, std::move(times_s), video.fps.interval_s()};
}

/// Reports how many times are recorded. The motion and `on_progress` must outlive the scope.
CancelScope report_recorded(const Motion& motion, const OnProgress& on_progress) {
    return CancelScope([&] {
        report_progress(on_progress, static_cast<std::int64_t>(motion.recording->size()),
                        static_cast<std::int64_t>(motion.timeline->size()));
    });
}

/// Records positions that are given.
Plan record_given(Motion& motion, const OnProgress& on_progress) {
    const CancelScope progress = report_recorded(motion, on_progress);
    sim::Recording& recording = *motion.recording;
    while (recording.size() < motion.timeline->size()) {
        count_work(motion.system.particle_count());
        const double time_s = motion.timeline->time_s(recording.size());
        const State state = given_state(*motion.given, time_s, motion.system, recording.fields());
        recording.add(motion.system, state, given_figures(motion.system, state),
                      motion.timeline->is_frame(recording.size()));
    }
    Plan plan;
    plan.bodies.resize(motion.system.bodies.size());
    for (BodyPlan& body : plan.bodies) body.reason = PlanReason::kGiven;
    return plan;
}

/// Runs methods that the scene names for all bodies.
Plan run_named(Motion& motion, const std::vector<MethodDef>& methods, const RecordDef& def) {
    const Timeline& timeline = *motion.timeline;
    sim::Recording& recording = *motion.recording;
    const CancelScope progress = report_recorded(motion, def.on_progress);
    Simulation run(motion.system, motion.world, methods, timeline.step_s());
    Plan plan;
    for (const MethodDef& method : run.methods()) plan.bodies.emplace_back().method = method;
    plan.simulation_passes = 1;
    while (recording.size() < timeline.size()) {
        check_cancelled();
        if (recording.advance(run, timeline, def.clock_s) == Status::kDiverged) break;
    }
    return plan;
}

Plan run(Motion& motion, const Scene& scene, const RecordDef& def) {
    if (motion.given) return record_given(motion, def.on_progress);
    const sim::NamedMethods named = named_methods(scene);
    if (const std::vector<MethodDef> methods = if_all_named(named); !methods.empty())
        return run_named(motion, methods, def);
    const double tolerance_px = std::get<AutoDef>(scene.solver).tolerance_px;
    const PictureScale scale(scene, motion.system);
    const auto tolerance_m = [&](const MotionBounds& bounds) {
        return tolerance_px / scale.largest_error_px_per_metre(bounds);
    };
    return sim::plan_methods(motion.system, named, scene.world,
                             {tolerance_m, *motion.timeline, def.on_progress, def.clock_s, motion.duration_s},
                             *motion.recording);
}

}  // namespace

Divergence divergence_of(const Motion& motion) {
    const System& system = motion.system;
    constexpr double kUnequal = 1e6;
    double ratio = 1.0;
    for (const Body& body : system.bodies) ratio = std::max(ratio, mass_ratio(system, body));
    const std::size_t states = motion.recording->size();
    const double next_s = motion.diverges() ? motion.timeline->time_s(states) : motion.duration_s;
    Divergence divergence{.cause = pins_out_of_reach(system, next_s), .remedy = ""};
    bool loses_lines = false;
    for (std::size_t b = 0; b < system.bodies.size(); ++b) {
        const Body& body = system.bodies[b];
        loses_lines =
            loses_lines || (std::holds_alternative<ExactDef>(motion.plan.bodies[b].method) &&
                            body.material.compliance_1_n == 0.0 && !sim::moves_as_chains(system, body));
    }
    if (loses_lines) divergence.remedy = "method rattle, which passes lines of bars, ";
    if (!system.moves.empty())
        divergence.remedy += "pins that stay within reach of each other, a compliance, ";
    if (ratio >= kUnequal)
        divergence.remedy +=
            fmt::format("less unequal masses of free particles (they differ by a factor of {:.2g}), ", ratio);
    divergence.remedy += "less speed or force";
    return divergence;
}

double Motion::end_s() const {
    const std::size_t states = recording->size();
    return diverges() && states > 0 ? timeline->time_s(states - 1) : duration_s;
}

std::vector<double> Motion::times_of(const Timeline& times, std::size_t stride) const {
    const double until_s = end_s();
    std::vector<double> times_s;
    for (std::size_t i = 0; i < times.size() && times.time_s(i) <= until_s; i += stride)
        times_s.push_back(times.time_s(i));
    return times_s;
}

std::vector<MethodDef> Motion::methods() const {
    std::vector<MethodDef> methods;
    for (const BodyPlan& body : plan.bodies) methods.push_back(body.method);
    return methods;
}

void Motion::for_each(std::span<const double> times_s,
                      const std::function<void(const State&, const Figures&)>& visit) const {
    std::optional<Simulation> run;
    State state;
    for (const double time_s : times_s) {
        count_work(system.particle_count());
        const auto index = timeline->find(time_s);
        if (index && *index < recording->size()) {
            recording->read(*index, state);
            visit(state, recording->figures(*index));
            continue;
        }
        if (index || time_s > end_s()) fail_diverged(*this, time_s);
        if (given) {
            const State at = given_state(*given, time_s, system, recording->fields());
            visit(at, given_figures(system, at));
            continue;
        }
        if (!run) {
            run.emplace(system, world, methods(), timeline->step_s());
            run->set_outputs(recording->fields());
        }
        if (run->advance_to(time_s) == Status::kDiverged) fail_diverged(*this, time_s);
        visit(run->state(), run->figures());
    }
}

State Motion::at(double time_s) const {
    State state;
    for_each({&time_s, 1}, [&](const State& read, const Figures& /*figures*/) { state = read; });
    return state;
}

Energy Motion::energy_of(const State& state) const {
    if (state.vx_m_s.empty())
        throw Error(ExitCode::kUsage, "the energy of a state needs FilmDef::readings.velocities");
    Energy energy = meter->of(state);
    energy.weight_j -= weight_at_start_j;
    return energy;
}

std::shared_ptr<const Motion> simulate(const Scene& scene, const RecordDef& def) {
    std::shared_ptr<Motion> motion;
    {
        const CancelScope starting([&] { report_progress(def.on_progress, 0, last_frame_of(scene) + 1); });
        motion = std::make_shared<Motion>(system_of(scene), scene.world);
        motion->duration_s = scene.world.duration_s;
        motion->given = scene.given;
        if (scene.given) start_as_given(*scene.given, motion->system);
        motion->timeline = timeline_of(scene, motion->system, def);
        motion->recording.emplace(motion->system.particle_count(), motion->timeline->size(),
                                  motion->system.bars.size(), quantity_of(scene.style.color_by),
                                  def.fields.with(plot_fields(scene))
                                      .with(view::fields_of(scene.style.arrows))
                                      .with({.velocities = scene.style.trail_s > 0.0}));
    }
    motion->plan = run(*motion, scene, def);
    const auto all = static_cast<std::int64_t>(motion->timeline->size());
    const CancelScope ending([&] { report_progress(def.on_progress, all, all); });
    const System& system = motion->system;
    motion->plan.notes = input_notes(scene, system, motion->plan);
    motion->meter.emplace(system, scene.world, motion->methods());
    const State start{0.0, system.x_m, system.y_m, system.vx_m_s, system.vy_m_s};
    motion->weight_at_start_j = motion->meter->of(start).weight_j;
    return motion;
}

}  // namespace corda::film
