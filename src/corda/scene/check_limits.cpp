#include "corda/scene/check_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>

#include "corda/sim/solver.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::scene {
namespace {

/// A whole number; in scientific notation from a million on.
std::string about(double value) {
    constexpr double kMaxInFull = 1e6;
    return value < kMaxInFull ? fmt::format("{:.0f}", value) : fmt::format("{:.1e}", value);
}

struct Place {
    const TableReader* table;
    std::string_view key;
};

/// Adds a problem at the first of the keys that the file gives, otherwise at the first body.
void fail_at(const Sections& sections, std::initializer_list<Place> places, std::string_view problem) {
    for (const Place& place : places) {
        if (const auto value = place.table->find(place.key)) return value->add_problem(problem);
    }
    (sections.ropes.empty() ? sections.nets : sections.ropes).front().add_problem(problem);
}

bool check_frames(const Sections& sections, const Scene& scene) {
    if (!sections.world.is_sound("duration") || !sections.video.is_sound("fps") ||
        !sections.video.is_sound("speed"))
        return false;
    const double duration_s = scene.world.duration_s;
    const double frames = duration_s * scene.video.scene_rate().per_second();
    const std::initializer_list<Place> places{
        {&sections.world, "duration"}, {&sections.video, "fps"}, {&sections.video, "speed"}};
    std::string problem;
    if (frames > static_cast<double>(Limits::kFrames)) {
        problem = fmt::format(
            "{:g} s at {} frames per second are {:g} frames, over the limit of {}; give a shorter duration "
            "or fewer frames per second",
            duration_s, scene.video.scene_rate().rational().text(), frames, Limits::kFrames);
    } else if (scene.video.scene_rate().frame_count(duration_s) < 1) {
        problem = fmt::format("{:g} s hold no frame; give a longer duration", duration_s);
    }
    if (!problem.empty()) fail_at(sections, places, problem);
    return problem.empty();
}

/// The method of a solver; `auto` is estimated as `exact`.
MethodDef method_of(const SolverDef& solver) {
    return method_in(solver).value_or(ExactDef{});
}

/// Number of steps that the solver's key `step` gives; one per frame without it.
double step_count(const SolverDef& solver, const Scene& scene) {
    const std::optional<double> step_s = sim::fixed_step_s(method_of(solver));
    return scene.world.duration_s / step_s.value_or(scene.video.fps.interval_s());
}

int sweep_count(const SolverDef& solver) {
    const auto* relaxation = std::get_if<RelaxationDef>(&solver);
    return relaxation == nullptr ? 1 : relaxation->sweeps;
}

bool check_steps(const Sections& sections, const SolverGroup& group, const Scene& scene) {
    if (!group.table.is_sound("method") || !group.table.is_sound("step")) return false;
    const double steps = step_count(group.def, scene);
    if (steps <= static_cast<double>(Limits::kSteps)) return true;
    fail_at(
        sections, {{&group.table, "step"}, {&sections.world, "duration"}},
        fmt::format("{:g} s are {:g} steps, over the limit of {}; give a longer step or a shorter duration",
                    scene.world.duration_s, steps, Limits::kSteps));
    return false;
}

/// Adds the bar updates of a group to those of all groups. Returns true if they are within the limit.
bool check_bar_updates(const Sections& sections, const SolverGroup& group, const Scene& scene,
                       std::int64_t bars, double& all_updates) {
    if (!group.table.is_sound("sweeps")) return false;
    const double steps = step_count(group.def, scene);
    const bool is_first = all_updates == 0.0;
    all_updates += static_cast<double>(bars) * sweep_count(group.def) * steps;
    if (all_updates <= Limits::kBarUpdates) return true;
    fail_at(
        sections,
        {{&group.table, "sweeps"},
         {&group.table, "step"},
         {&group.table, "reach"},
         {&sections.world, "duration"}},
        fmt::format("{} bars, {} sweeps and {:g} steps{} are {:g} bar updates, over the limit of {:g}; give "
                    "fewer of one of them",
                    bars, sweep_count(group.def), steps, is_first ? "" : ", with those of other methods,",
                    all_updates, Limits::kBarUpdates));
    return false;
}

/// Total size of the bodies counted so far.
struct Demand {
    std::int64_t particles = 0;
    std::int64_t bars = 0;
    double bytes = 0.0;
};

/// Estimated upper bound of the memory, in bytes, for simulating a body: measured with 20 000 ropes of two
/// particles, chains of 1e5, relaxation at reach 20, and by rattle, whose factors fill in, nets of 40 x 40 to
/// 320 x 320.
double expected_bytes(const BodySize& size, const SolverDef& solver, bool is_net) {
    constexpr double kPerBody = 9e3;
    constexpr double kPerParticle = 1.7e3;
    constexpr double kPerBar = 140.0;
    constexpr double kPerFill = 500.0;
    const auto particles = static_cast<double>(size.particles);
    const bool fills = is_net && !std::holds_alternative<RelaxationDef>(solver);
    return kPerBody + (kPerParticle + (fills ? kPerFill * std::log2(particles) : 0.0)) * particles +
           kPerBar * static_cast<double>(size.bars);
}

/// Estimated upper bound of the memory, in bytes, for the trails of a body: a point per frame, at most 400 in
/// a trail, and in a picture the capsules of trails beyond view::kPiecesOfTrails.
double trail_bytes(const Scene& scene, std::int64_t particles) {
    if (scene.style.trail_s == 0.0) return 0.0;
    constexpr double kPerPoint = 2.0 * 40.0;  // a vector that grows has as much again
    constexpr double kPerPointInPicture = 2.0 * view::kMinPiecesPerPoint * view::kCapsuleBytes;
    constexpr double kMaxPoints = 400.0;
    const double in_trail = scene.style.trail_s * scene.video.scene_rate().per_second();
    const double stride = std::max(1.0, in_trail / kMaxPoints);
    // A film of more frames is refused for its duration.
    const double frames = std::min(scene.world.duration_s * scene.video.scene_rate().per_second(),
                                   static_cast<double>(Limits::kFrames));
    const double points = frames / stride;
    // Two indices can name one particle.
    const auto trails =
        static_cast<double>(std::clamp<std::int64_t>(std::ssize(scene.style.trail_of), 1, particles));
    return trails * (kPerPoint * points + kPerPointInPicture * std::min({in_trail, points, kMaxPoints}));
}

/// Adds one body to the total size. Returns true if that is within the limits.
bool add_size(const TableReader& body, const BodySize& size, double bytes, bool has_trail,
              std::string_view fewer_bars, Demand& all) {
    all.particles += size.particles;
    all.bars += size.bars;
    all.bytes += bytes;
    const auto too_many = [&](std::string_view what, std::int64_t count, std::int64_t limit,
                              std::string_view fewer) {
        if (count <= limit) return false;
        body.add_problem(
            fmt::format("the ropes and nets up to this one have {} {}, over the limit of {}; give {}", count,
                        what, limit, fewer));
        return true;
    };
    if (too_many("particles", all.particles, Limits::kParticles, "fewer") ||
        too_many("bars", all.bars, Limits::kBars, fewer_bars))
        return false;
    const double gibibytes = all.bytes / static_cast<double>(1 << 30);
    if (gibibytes <= Limits::kGibibytes) return true;
    body.add_problem(
        fmt::format("the ropes and nets up to this one take some {:.0f} GiB of memory, over the limit of "
                    "{:g}; give fewer particles, {}or method relaxation, which takes less",
                    gibibytes, Limits::kGibibytes, has_trail ? "no style.trail_s, " : ""));
    return false;
}

/// Adds a problem at the first of the keys that body `i` of the scene has, otherwise at the body.
void fail_in_body(const Sections& sections, std::size_t i, const std::vector<const char*>& keys,
                  std::string_view problem) {
    const bool is_rope = i < sections.ropes.size();
    const TableReader& body = is_rope ? sections.ropes[i] : sections.nets[i - sections.ropes.size()];
    for (const char* const key : keys) {
        if (const auto value = body.find(key)) return value->add_problem(problem);
    }
    body.add_problem(problem);
}

/// A reason for short steps in the motion of a body.
struct Pace {
    double frequency_1_s = 0.0;  ///< angular, of the motion to be followed
    std::string_view what;       ///< of the body, before "so fast that"
    std::string remedy;
    std::vector<const char*> keys_of_body;
    const char* key_of_world = nullptr;
    double mass_ratio = 1.0;  ///< of the heaviest and the lightest particle, if they are the reason
};

/// Rounded down to one digit.
std::string at_most(double value) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)));
    return fmt::format("{:g}", std::floor(value / unit) * unit);
}

/// Advice for a body that may take only this share of its steps. Steps grow with the root of the ratio of
/// masses.
std::string advice_for(const Pace& pace, double share) {
    constexpr double kEqual = 1.001;
    if (pace.mass_ratio < kEqual) return pace.remedy;
    const double allowed = std::max(1.0, share * share * pace.mass_ratio);
    return fmt::format("less unequal masses of free particles (a ratio of at most {}; it is {:.2g}), {}",
                       at_most(allowed), pace.mass_ratio, pace.remedy);
}

/// Angular frequency of the steps that follow a vibration of a body that stretches. Below some step, the
/// rounding of a stiff bar's length moves the velocities by more than the tolerance of `exact` in each step,
/// so that shorter steps are taken (ropes of 10 links and a compliance of 1e-12 to 1e-10: 0.9 to 1.1 times as
/// many steps).
double followed_frequency_1_s(const Scene& scene, const System& system, const Body& body,
                              const SolverDef& solver) {
    constexpr double kRounding = 5.6e-17;
    constexpr double kStepsPerTurn = 0.2;
    constexpr double kShareOfAStep = 0.01;
    constexpr double kOfAuto = 1e-9;  // its checks
    const double vibration_1_s = sim::vibration_frequency_1_s(system, body);
    if (body.material.compliance_1_n == 0.0 || std::holds_alternative<RattleDef>(solver))
        return vibration_1_s;
    const double swing_1_s =
        std::max(sim::Forces(scene.world).inverse_timescale_1_s(links_length_m(system, body), 0.0),
                 sim::angular_velocity_1_s(system, body));
    if (swing_1_s == 0.0) return vibration_1_s;
    const auto* exact = std::get_if<ExactDef>(&solver);
    const double error = kShareOfAStep * (exact == nullptr ? kOfAuto : exact->tolerance);
    return std::max(vibration_1_s,
                    kRounding * vibration_1_s * vibration_1_s / (kStepsPerTurn * error * swing_1_s));
}

/// The reasons of a body, in the order in which messages name them.
std::vector<Pace> paces_of(const Scene& scene, const System& system, const Body& body,
                           const SolverDef& solver, bool is_moved_by_rounding = false) {
    // The steps of rattle on a chain follow from the weights alone.
    is_moved_by_rounding =
        is_moved_by_rounding || (std::holds_alternative<RattleDef>(solver) && body.is_chain);
    std::vector<Pace> paces{{followed_frequency_1_s(scene, system, body, solver),
                             "vibrates",
                             body.is_net ? "more compliance, heavier particles"
                                         : "more compliance, less bending, heavier particles",
                             {"compliance", "bending"}}};
    if (std::holds_alternative<RelaxationDef>(solver)) return paces;
    paces.push_back({scene.world.drag_1_s, "slows down", "less drag", {}, "drag"});
    // Links that throw one another about (4 links at 1e6 m/s: 1.8e7 steps per second).
    constexpr double kOfWhips = 20.0;
    paces.push_back({(body.link_count > 1 ? kOfWhips : 1.0) * sim::angular_velocity_1_s(system, body),
                     "turns",
                     "less speed, longer links",
                     {"velocity"}});
    const double pulled_1_s = sim::tension_frequency_1_s(system, body, scene.world, is_moved_by_rounding);
    const bool hangs_still = pulled_1_s == 0.0 && body.material.compliance_1_n == 0.0;
    paces.push_back({hangs_still ? 0.0 : sim::pendulum_frequency_1_s(system, body, scene.world),
                     "swings",
                     "less gravity, longer links",
                     {},
                     "gravity"});
    paces.push_back({pulled_1_s,
                     "is pulled so hard that its lightest particles vibrate",
                     body.is_net ? "less speed or gravity, fewer particles"
                                 : "less speed or gravity, fewer or longer links",
                     {"payload", "mass", "velocity"},
                     nullptr,
                     mass_ratio(system, body)});
    return paces;
}

/// The cost of following a body at this pace.
struct Work {
    double steps = 0.0;
    double updates = 0.0;  ///< of particles
};

Work work_of(const Scene& scene, const System& system, const Body& body, const SolverDef& solver,
             double frequency_1_s) {
    constexpr double kUsualTolerance = 1e-4;  // of `auto`, for 0.1 pixels
    MethodDef method = method_of(solver);
    if (std::holds_alternative<AutoDef>(solver) &&
        sim::implicit_pays(system, body, scene.world, kUsualTolerance))
        method = ExactDef{kUsualTolerance, true};
    Work work;
    // -0.0, which a drag of -0.0 gives, would have a limit of -inf.
    work.steps = std::max(0.0, sim::expected_steps(method, body, frequency_1_s, scene.world.duration_s));
    work.updates =
        work.steps * static_cast<double>(body.particle_count) * sim::relative_step_work(method, body);
    return work;
}

constexpr double kUpdatesPerSecond = 7e6;

/// "40 s", "5 min" or "2.5 h".
std::string duration_text(double seconds) {
    if (seconds < 100.0) return fmt::format("{:.0f} s", seconds);
    if (seconds < 6000.0) return fmt::format("{:.0f} min", seconds / 60.0);
    return fmt::format("{:.2g} h", seconds / 3600.0);
}

/// Adds at most one problem of a body for its vibrations and one for the rest: each of them is about the same
/// keys.
void check_pace(const Sections& sections, const Scene& scene, const System& system, const SolverDef& solver,
                std::size_t i) {
    const Body& body = system.bodies[i];
    const std::vector<Pace> paces = paces_of(scene, system, body, solver);
    std::vector<Work> works;
    std::vector<double> shares;
    const double frames = scene.world.duration_s * scene.video.scene_rate().per_second();
    const double most_steps = std::max(Limits::kStepsOfAMotion, Limits::kStepsOfAFrame * frames);
    double allowed_s = scene.world.duration_s;
    for (const Pace& pace : paces) {
        const Work& work = works.emplace_back(work_of(scene, system, body, solver, pace.frequency_1_s));
        const double most_updates = Limits::kParticleUpdates / work.updates;
        shares.push_back(std::min(most_steps / work.steps, most_updates));
        allowed_s = std::min(
            allowed_s, scene.world.duration_s * std::min(Limits::kStepsOfAMotion / work.steps, most_updates));
    }
    bool has_problem = false;
    for (std::size_t k = 0; k < paces.size() && !has_problem; ++k) {
        if (shares[k] >= 1.0) continue;
        const Pace& pace = paces[k];
        std::string advice = advice_for(pace, shares[k]);
        if (scene.video.scene_rate().frame_count(allowed_s) >= 2)
            advice += fmt::format(" or a duration of at most {} s", at_most(allowed_s));
        else if (const std::size_t comma = advice.rfind(", "); comma != std::string::npos)
            advice.replace(comma, 2, " or ");
        const std::string problem = fmt::format(
            "{} so fast that {:g} s take some {:.2g} steps or {}, {} times the limit; give {}", pace.what,
            scene.world.duration_s, works[k].steps, duration_text(works[k].updates / kUpdatesPerSecond),
            about(std::ceil(1.0 / shares[k])), advice);
        if (pace.key_of_world != nullptr)
            fail_at(sections, {{&sections.world, pace.key_of_world}}, problem);
        else
            fail_in_body(sections, i, pace.keys_of_body, problem);
        has_problem = k > 0;
    }
}

/// Cost of a net whose bars stretch relative to that of a chain of as many particles: it has more bars, and
/// shorter steps. If they are strings, some always come taut or slack, and the error of such a step falls
/// slowly with its length. Measured with 10 x 10 to 70 x 70 particles: without strings 5 times; with strings,
/// `exact` took 9 to 22 times as long as without, and `auto`, whose checks are tighter, 60 to 300 times.
double cost_of_elastic_net(const Body& body, const SolverDef& solver) {
    constexpr double kOfNet = 5.0;
    constexpr double kOfExact = 20.0;
    constexpr double kOfAuto = 200.0;
    const bool is_auto = std::holds_alternative<AutoDef>(solver);
    if (body.is_chain || body.material.compliance_1_n == 0.0) return 1.0;
    if (!is_auto && !std::holds_alternative<ExactDef>(solver)) return 1.0;
    return kOfNet * (!body.material.is_string ? 1.0 : is_auto ? kOfAuto : kOfExact);
}

}  // namespace

SceneSize count_bodies(const Sections& sections, const SolverSection& solver, const Scene& scene) {
    SceneSize size;
    Demand all;
    if (scene.style.trail_s > 0.0) all.bytes = 2.0 * view::kPiecesOfTrails * view::kCapsuleBytes;
    size.has_bars = sections.solver.is_sound("method") && sections.solver.is_sound("reach") &&
                    sections.solver.is_sound("bodies");
    const auto add = [&](const TableReader& body, const std::optional<BodySize>& own,
                         std::string_view fewer_bars, bool is_net) {
        const SolverDef& method = solver.group_of(size.bodies.size()).def;
        size.bodies.push_back(own);
        size.has_bars = size.has_bars && own;
        const double of_trail =
            !own || (is_net && scene.style.trail_of.empty()) ? 0.0 : trail_bytes(scene, own->particles);
        if (size.fits && own)
            size.fits = add_size(body, *own, expected_bytes(*own, method, is_net) + of_trail, of_trail > 0.0,
                                 fewer_bars, all);
    };
    for (const TableReader& rope : sections.ropes) {
        const int reach = solver.group_of(size.bodies.size()).reach;
        add(rope, read_rope_size(rope, reach), "fewer particles, or the solver a smaller reach", false);
    }
    for (const TableReader& net : sections.nets) add(net, read_net_size(net), "fewer", true);
    size.has_bars = size.has_bars && size.fits;
    return size;
}

void check_work(const Sections& sections, const SolverSection& solver, const SceneSize& size,
                const Scene& scene) {
    if (!check_frames(sections, scene)) return;
    std::vector<std::optional<std::int64_t>> bars(solver.groups.size());  // empty: it moves no body
    for (std::size_t i = 0; i < size.bodies.size(); ++i) {
        auto& sum = bars[solver.group_of_body[i]];
        sum = sum.value_or(0) + (size.has_bars ? size.bodies[i]->bars : 0);
    }
    double updates = 0.0;
    for (std::size_t g = 0; g < bars.size(); ++g) {
        const SolverGroup& group = solver.groups[g];
        if (!bars[g] || !check_steps(sections, group, scene) || !size.has_bars) continue;
        if (!check_bar_updates(sections, group, scene, *bars[g], updates)) return;
    }
}

void check_motion(const Sections& sections, const Scene& scene) {
    const System system = system_of(scene);
    const std::vector<SolverDef> solvers = solvers_of(scene);
    for (std::size_t i = 0; i < system.bodies.size(); ++i) check_pace(sections, scene, system, solvers[i], i);
}

}  // namespace corda::scene

namespace corda {

std::string cost_notice(const Scene& scene) {
    using namespace scene;
    constexpr double kMinNoticeSeconds = 5.0;
    constexpr double kBarUpdatesPerSecond = 1.2e8;
    const System system = system_of(scene);
    const std::vector<SolverDef> solvers = solvers_of(scene);
    double all_s = 0.0;
    double slowest_s = 0.0;
    std::string reason;
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
        const Body& body = system.bodies[i];
        const double steps = step_count(solvers[i], scene);
        double body_s = 0.0;
        std::string why = fmt::format("takes {:g} steps", steps);
        std::string remedy = "a longer step";
        if (std::holds_alternative<RelaxationDef>(solvers[i])) {
            body_s =
                steps * sweep_count(solvers[i]) * static_cast<double>(body.bar_count) / kBarUpdatesPerSecond;
        } else if (std::holds_alternative<RattleDef>(solvers[i])) {
            body_s = steps * static_cast<double>(body.particle_count) *
                     sim::relative_step_work(method_of(solvers[i]), body) / kUpdatesPerSecond;
        }
        const double of_net = cost_of_elastic_net(body, solvers[i]);
        // The checks of `auto` see the rounding of long ropes at rest.
        constexpr std::size_t kLongRope = 3000;
        const bool is_moved_by_rounding =
            std::holds_alternative<AutoDef>(solvers[i]) && body.particle_count > kLongRope;
        for (const Pace& pace : paces_of(scene, system, body, solvers[i], is_moved_by_rounding)) {
            const Work work = work_of(scene, system, body, solvers[i], pace.frequency_1_s);
            const double pace_s = work.updates * of_net / kUpdatesPerSecond;
            if (pace_s <= body_s) continue;
            body_s = pace_s;
            why = fmt::format("{} so fast that it takes up to {:.2g} steps", pace.what, work.steps);
            remedy = advice_for(pace, kMinNoticeSeconds / pace_s);
        }
        all_s += body_s;
        if (body_s <= slowest_s) continue;
        slowest_s = body_s;
        reason = fmt::format("{} {}; give {} or a shorter duration", body_name(system, i), why, remedy);
    }
    if (all_s < kMinNoticeSeconds) return {};
    return fmt::format("computing {:g} s of motion may take {}: {}", scene.world.duration_s,
                       duration_text(all_s), reason);
}

}  // namespace corda
