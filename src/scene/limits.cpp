#include "corda/scene/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>

#include "corda/sim/system.hpp"

namespace corda::scene {
namespace {

struct Place {
    const TableReader* table;
    std::string_view key;
};

/// Fails at the first of the keys that the file gives, else at the first rope.
[[noreturn]] void fail_at(const Sections& sections, std::initializer_list<Place> places,
                          std::string_view problem) {
    for (const Place& place : places) {
        if (const auto value = place.table->find(place.key)) value->fail(problem);
    }
    sections.ropes.front().fail(problem);
}

std::int64_t bars_of(std::int64_t particles, int reach) {
    return static_cast<std::int64_t>(
        sim::bar_count(static_cast<std::uint64_t>(particles), static_cast<std::uint64_t>(reach)));
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

}  // namespace

std::vector<std::int64_t> count_particles(const Sections& sections, const sim::SolverDef& solver) {
    std::vector<std::int64_t> counts;
    std::int64_t particles = 0;
    std::int64_t bars = 0;
    for (const TableReader& rope : sections.ropes) {
        counts.push_back(read_particle_count(rope));
        particles += counts.back();
        if (particles > Limits::kParticles) {
            rope.fail(
                fmt::format("the ropes up to this one have {} particles, over the limit of {}; give fewer",
                            particles, Limits::kParticles));
        }
        bars += bars_of(counts.back(), solver.reach);
        if (bars > Limits::kBars) {
            rope.fail(
                fmt::format("the ropes up to this one have {} bars, over the limit of {}; give fewer "
                            "particles or a smaller solver.reach",
                            bars, Limits::kBars));
        }
    }
    return counts;
}

void check_work(const Sections& sections, const Scene& scene, const std::vector<std::int64_t>& particles) {
    std::int64_t bars = 0;
    for (const std::int64_t count : particles) bars += bars_of(count, scene.solver.reach);
    check_frames(sections, scene);
    check_steps(sections, scene);
    check_bar_updates(sections, scene, bars);
}

}  // namespace corda::scene
