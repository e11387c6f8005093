#include "corda/scene/check_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>

#include "corda/sim/work.hpp"

namespace corda::scene {
namespace {

/// A whole number in words that can be read: in scientific notation from a million on.
std::string about(double value) {
    constexpr double kMostInFull = 1e6;
    return value < kMostInFull ? fmt::format("{:.0f}", value) : fmt::format("{:.1e}", value);
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
    if (!sections.world.is_sound("duration") || !sections.video.is_sound("fps")) return false;
    const double duration_s = scene.world.duration_s;
    const double frames = duration_s * scene.video.fps.per_second();
    const std::initializer_list<Place> places{{&sections.world, "duration"}, {&sections.video, "fps"}};
    std::string problem;
    if (frames > static_cast<double>(Limits::kFrames)) {
        problem = fmt::format(
            "{:g} s at {} frames per second are {:g} frames, over the limit of {}; give a shorter duration "
            "or fewer frames per second",
            duration_s, scene.video.fps.rational().text(), frames, Limits::kFrames);
    } else if (scene.video.fps.frame_count(duration_s) < 1) {
        problem = fmt::format("{:g} s hold no frame; give a longer duration", duration_s);
    }
    if (!problem.empty()) fail_at(sections, places, problem);
    return problem.empty();
}

/// Steps that the solver asks for by name; a frame takes one otherwise.
double step_count(const SolverDef& solver, const Scene& scene) {
    std::optional<double> step_s;
    if (const auto* rattle = std::get_if<RattleDef>(&solver)) step_s = rattle->step_s;
    if (const auto* relaxation = std::get_if<RelaxationDef>(&solver)) step_s = relaxation->step_s;
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

/// Adds a group of that many bars to the bar updates of all. Returns whether they are few enough.
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

/// What all bodies so far ask for together.
struct Demand {
    std::int64_t particles = 0;
    std::int64_t bars = 0;
    double bytes = 0.0;
};

/// About the most memory in bytes that simulating a body takes: measured with 20 000 ropes of two particles,
/// chains of 1e5, relaxation at reach 20, and by rattle, whose factors fill in, nets of 40 x 40 to 320 x 320.
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

/// About the most memory that the trail of a rope takes: a point per frame, at most 400 in a trail, and in a
/// picture half of 12 layers of 4 capsules per point.
double trail_bytes(const Scene& scene) {
    if (scene.style.trail_s == 0.0) return 0.0;
    constexpr double kPerPoint = 2.0 * sizeof(Vec2);  // a vector that grows has as much again
    constexpr double kPerPointInPicture = 2.0 * 26.0 * 32.0;
    constexpr double kMostPoints = 400.0;
    const double in_trail = scene.style.trail_s * scene.video.fps.per_second();
    const double stride = std::max(1.0, in_trail / kMostPoints);
    // A film of more frames is refused for its duration.
    const double frames =
        std::min(scene.world.duration_s * scene.video.fps.per_second(), static_cast<double>(Limits::kFrames));
    const double points = frames / stride;
    return kPerPoint * points + kPerPointInPicture * std::min({in_trail, points, kMostPoints});
}

/// Adds one body to what all ask for together. Returns whether that is within the limits.
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
void fail_in_body(const Sections& sections, std::size_t i, std::initializer_list<const char*> keys,
                  std::string_view problem) {
    const bool is_rope = i < sections.ropes.size();
    const TableReader& body = is_rope ? sections.ropes[i] : sections.nets[i - sections.ropes.size()];
    for (const char* const key : keys) {
        if (const auto value = body.find(key)) return value->add_problem(problem);
    }
    body.add_problem(problem);
}

/// What following a motion of this angular frequency costs a body, if that is over the limit: the problem
/// that `what` begins and `remedy` ends. Empty if it is not.
std::string too_much_work(const Scene& scene, const Body& body, double frequency_1_s, std::string_view what,
                          std::string_view remedy) {
    constexpr double kUpdatesPerHour = 2.5e10;
    const double steps = sim::expected_steps(frequency_1_s, scene.world.duration_s);
    const double updates = steps * static_cast<double>(body.particle_count);
    if (updates <= Limits::kParticleUpdates) return {};
    return fmt::format(
        "{} so fast that {:g} s take some {:g} steps, {:g} particle updates or {} hours, over the limit "
        "of {:g}; give {} or a shorter duration",
        what, scene.world.duration_s, steps, updates, about(updates / kUpdatesPerHour),
        Limits::kParticleUpdates, remedy);
}

void check_stiffness(const Sections& sections, const Scene& scene, const System& system) {
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
        const Body& body = system.bodies[i];
        const std::string problem =
            too_much_work(scene, body, sim::vibration_frequency_1_s(system, body), "vibrates",
                          "more compliance, less bending, heavier particles");
        if (!problem.empty()) fail_in_body(sections, i, {"compliance", "bending"}, problem);
    }
}

/// Adds at most one problem of a body: each of them is about the same keys.
void check_pace(const Sections& sections, const Scene& scene, const System& system, std::size_t i) {
    const Body& body = system.bodies[i];
    const double drag_1_s = scene.world.drag_1_s;
    if (const std::string problem = too_much_work(scene, body, drag_1_s, "slows down", "less drag");
        !problem.empty())
        return fail_at(sections, {{&sections.world, "drag"}}, problem);
    const double turn_1_s = sim::angular_velocity_1_s(system, body);
    if (const std::string problem = too_much_work(scene, body, turn_1_s, "turns", "less speed, longer links");
        !problem.empty())
        return fail_in_body(sections, i, {"velocity"}, problem);
    const double swing_1_s = sim::pendulum_frequency_1_s(system, body, scene.world);
    if (const std::string problem =
            too_much_work(scene, body, swing_1_s, "swings", "less gravity, longer links");
        !problem.empty())
        return fail_at(sections, {{&sections.world, "gravity"}}, problem);
    const std::string problem =
        too_much_work(scene, body, sim::tension_frequency_1_s(system, body, scene.world),
                      "is pulled so hard that its lightest particles vibrate",
                      "less unequal masses, less speed or gravity, fewer or longer links");
    if (!problem.empty()) fail_in_body(sections, i, {"payload", "mass", "velocity"}, problem);
}

}  // namespace

SceneSize count_bodies(const Sections& sections, const SolverSection& solver, const Scene& scene) {
    SceneSize size;
    Demand all;
    size.has_bars = sections.solver.is_sound("method") && sections.solver.is_sound("reach") &&
                    sections.solver.is_sound("bodies");
    const auto add = [&](const TableReader& body, const std::optional<BodySize>& own,
                         std::string_view fewer_bars, bool is_net) {
        const SolverDef& method = solver.group_of(size.bodies.size()).def;
        size.bodies.push_back(own);
        size.has_bars = size.has_bars && own;
        const double of_trail = is_net ? 0.0 : trail_bytes(scene);
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
    check_stiffness(sections, scene, system);
    const std::vector<SolverDef> solvers = solvers_of(scene);
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
        if (!std::holds_alternative<RelaxationDef>(solvers[i])) check_pace(sections, scene, system, i);
    }
}

}  // namespace corda::scene
