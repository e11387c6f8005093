#include "corda/scene/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>

namespace corda::scene {
namespace {

struct Place {
    const TableReader* table;
    std::string_view key;
};

/// Fails at the first of the keys that the file gives, else at the first body.
[[noreturn]] void fail_at(const Sections& sections, std::initializer_list<Place> places,
                          std::string_view problem) {
    for (const Place& place : places) {
        if (const auto value = place.table->find(place.key)) value->fail(problem);
    }
    (sections.ropes.empty() ? sections.nets : sections.ropes).front().fail(problem);
}

void check_frames(const Sections& sections, const Scene& scene) {
    const double duration_s = scene.world.duration_s;
    const double frames = duration_s * scene.video.fps.per_second();
    const std::initializer_list<Place> places{{&sections.world, "duration"}, {&sections.video, "fps"}};
    if (frames > static_cast<double>(Limits::kFrames)) {
        fail_at(
            sections, places,
            fmt::format("{:g} s at {} frames a second are {:g} frames, over the limit of {}; give a shorter "
                        "duration or fewer frames a second",
                        duration_s, scene.video.fps.rational().text(), frames, Limits::kFrames));
    }
    if (scene.video.fps.frame_count(duration_s) < 1) {
        fail_at(sections, places, fmt::format("{:g} s hold no frame; give a longer duration", duration_s));
    }
}

double step_count(const Scene& scene) {
    return scene.world.duration_s / scene.solver.step_s.value_or(scene.video.fps.interval_s());
}

void check_steps(const Sections& sections, const Scene& scene) {
    const double steps = step_count(scene);
    if (steps <= static_cast<double>(Limits::kSteps)) return;
    fail_at(
        sections, {{&sections.solver, "step"}, {&sections.world, "duration"}},
        fmt::format("{:g} s are {:g} steps, over the limit of {}; give a longer step or a shorter duration",
                    scene.world.duration_s, steps, Limits::kSteps));
}

void check_bar_updates(const Sections& sections, const Scene& scene, std::int64_t bars) {
    const double steps = step_count(scene);
    const double updates = static_cast<double>(bars) * scene.solver.sweeps * steps;
    if (updates <= Limits::kBarUpdates) return;
    fail_at(
        sections,
        {{&sections.solver, "sweeps"},
         {&sections.solver, "step"},
         {&sections.solver, "reach"},
         {&sections.world, "duration"}},
        fmt::format("{} bars, {} sweeps and {:g} steps are {:g} bar updates, over the limit of {:g}; give "
                    "fewer of one of them",
                    bars, scene.solver.sweeps, steps, updates, Limits::kBarUpdates));
}

/// Adds one body to what all ask for together.
void add_size(const TableReader& body, const BodySize& size, std::string_view fewer_bars, BodySize& all) {
    all.particles += size.particles;
    if (all.particles > Limits::kParticles) {
        body.fail(
            fmt::format("the ropes and nets up to this one have {} particles, over the limit of {}; give "
                        "fewer",
                        all.particles, Limits::kParticles));
    }
    all.bars += size.bars;
    if (all.bars > Limits::kBars) {
        body.fail(fmt::format("the ropes and nets up to this one have {} bars, over the limit of {}; give {}",
                              all.bars, Limits::kBars, fewer_bars));
    }
}

}  // namespace

SceneSize count_bodies(const Sections& sections, const sim::SolverDef& solver) {
    SceneSize size;
    BodySize all;
    for (const TableReader& rope : sections.ropes) {
        const BodySize own = read_rope_size(rope, solver.reach);
        add_size(rope, own, "fewer particles or a smaller solver.reach", all);
        size.rope_particles.push_back(own.particles);
    }
    for (const TableReader& net : sections.nets) add_size(net, read_net_size(net), "fewer", all);
    size.bars = all.bars;
    return size;
}

void check_work(const Sections& sections, const Scene& scene, std::int64_t bars) {
    check_frames(sections, scene);
    check_steps(sections, scene);
    check_bar_updates(sections, scene, bars);
}

}  // namespace corda::scene
