#include "corda/scene/readers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>

#include "corda/sim/solver.hpp"

namespace corda::scene {
namespace {

struct KeyOf {
    const TableReader* table;
    std::string_view key;
};

/// Adds a problem at the first of the keys that the file gives, otherwise at the first body.
void fail_at(const Sections& sections, std::initializer_list<KeyOf> keys, const std::string& what,
             const std::string& remedy) {
    for (const auto& [table, key] : keys) {
        if (const auto value = table->find(key)) return value->add_problem(what, remedy);
    }
    (sections.ropes.empty() ? sections.nets : sections.ropes).front().add_problem(what, remedy);
}

bool check_frames(const Sections& sections, const Scene& scene) {
    if (!sections.world.is_sound("duration") || !sections.video.is_sound("fps") ||
        !sections.video.is_sound("speed"))
        return false;
    const double duration_s = scene.world.duration_s;
    const double frames = duration_s * scene.video.scene_rate().per_second();
    const std::initializer_list<KeyOf> keys{
        {&sections.world, "duration"}, {&sections.video, "fps"}, {&sections.video, "speed"}};
    if (frames > static_cast<double>(Limits::kFrames)) {
        fail_at(sections, keys,
                fmt::format("{:g} s at {} frames per second are {:g} frames, over the limit of {}",
                            duration_s, scene.video.scene_rate().rational().text(), frames, Limits::kFrames),
                "give a shorter duration or fewer frames per second");
        return false;
    }
    if (scene.video.scene_rate().frame_count(duration_s) >= 1) return true;
    fail_at(sections, keys, fmt::format("{:g} s hold no frame", duration_s), "give a longer duration");
    return false;
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
    fail_at(sections, {{&group.table, "step"}, {&sections.world, "duration"}},
            fmt::format("{:g} s are {:g} steps, over the limit of {}", scene.world.duration_s, steps,
                        Limits::kSteps),
            "give a longer step or a shorter duration");
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
    fail_at(sections,
            {{&group.table, "sweeps"},
             {&group.table, "step"},
             {&group.table, "reach"},
             {&sections.world, "duration"}},
            fmt::format("{} bars, {} sweeps and {:g} steps{} are {:g} bar updates, over the limit of {:g}",
                        bars, sweep_count(group.def), steps, is_first ? "" : ", with those of other methods,",
                        all_updates, Limits::kBarUpdates),
            "give fewer of one of them");
    return false;
}

/// Total size of the bodies counted so far.
struct Demand {
    std::int64_t particles = 0;
    std::int64_t bars = 0;
    double trail_points = 0.0;
};

/// Points of trails that are recorded: as film::Paths, one per frame, fewer if a trail is long.
double trail_points(const Scene& scene, std::int64_t particles) {
    if (scene.style.trail_s == 0.0) return 0.0;
    constexpr double kMaxPoints = 400.0;
    const double in_trail = scene.style.trail_s * scene.video.scene_rate().per_second();
    // A film of more frames is refused for its duration.
    const double frames = std::min(scene.world.duration_s * scene.video.scene_rate().per_second(),
                                   static_cast<double>(Limits::kFrames));
    const double points = frames / std::max(1.0, in_trail / kMaxPoints);
    // Two indices can name one particle.
    return points *
           static_cast<double>(std::clamp<std::int64_t>(std::ssize(scene.style.trail_of), 1, particles));
}

/// Adds one body to the total size. Returns true if that is within the limits.
bool add_size(const TableReader& body, const BodySize& size, double trail_points, std::string_view fewer_bars,
              Demand& all) {
    all.particles += size.particles;
    all.bars += size.bars;
    all.trail_points += trail_points;
    const auto too_many = [&](std::string_view what, auto count, auto limit, std::string_view fewer) {
        if (count <= limit) return false;
        body.add_problem(fmt::format("the ropes and nets up to this one have {} {}, over the limit of {}",
                                     count, what, limit),
                         fmt::format("give {}", fewer));
        return true;
    };
    return !too_many("particles", all.particles, Limits::kParticles, "fewer") &&
           !too_many("bars", all.bars, Limits::kBars, fewer_bars) &&
           !too_many("points in trails", all.trail_points, Limits::kTrailPoints,
                     "style.trail_of fewer particles, or a shorter duration");
}

/// The factors of a net's bars fill in.
bool check_factored(const TableReader& net, const BodySize& size, const SolverDef& solver) {
    if (std::holds_alternative<RelaxationDef>(solver) || size.particles <= Limits::kFactoredParticles)
        return true;
    net.add_problem(
        fmt::format("{} particles are over the limit of {} for a net that relaxation does not move",
                    size.particles, Limits::kFactoredParticles),
        "give fewer, or method relaxation");
    return false;
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
        if (!size.fits || !own) return;
        const bool has_trail = !is_net || !scene.style.trail_of.empty();
        size.fits =
            add_size(body, *own, has_trail ? trail_points(scene, own->particles) : 0.0, fewer_bars, all) &&
            (!is_net || check_factored(body, *own, method));
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

}  // namespace corda::scene
