#include "corda/scene/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

/// What an explicit method of high order bears.
constexpr double kFrequencyTimesStep = 5.0;

/// A bound on the frequencies with which a body stretches and bends: the square is at most twice the largest
/// sum over a particle of stiffness over mass; a bend acts on its particles like four springs of stiffness k
/// / length^2.
double largest_frequency_1_s(const sim::System& system, const sim::Body& body) {
    std::vector<double> stiffness_n_m(system.particle_count(), 0.0);
    if (body.material.compliance_1_n > 0.0) {
        for (std::size_t k = body.first_bar; k < body.first_bar + body.bar_count; ++k) {
            const sim::Bar& bar = system.bars[k];
            stiffness_n_m[bar.a] += 1.0 / (body.material.compliance_1_n * bar.rest_m);
            stiffness_n_m[bar.b] += 1.0 / (body.material.compliance_1_n * bar.rest_m);
        }
    }
    const std::size_t end = body.first_particle + body.particle_count;
    for (const sim::Bend& bend : system.bends) {
        if (bend.b < body.first_particle || bend.b >= end) continue;
        const double rest_m =
            std::hypot(system.x_m[bend.b] - system.x_m[bend.a], system.y_m[bend.b] - system.y_m[bend.a]);
        for (const std::uint32_t i : {bend.a, bend.b, bend.c})
            stiffness_n_m[i] += 4.0 * bend.stiffness_n_m / (rest_m * rest_m);
    }
    double largest = 0.0;
    for (std::size_t i = body.first_particle; i < end; ++i)
        largest = std::max(largest, stiffness_n_m[i] * system.inverse_mass_1_kg[i]);
    return std::sqrt(2.0 * largest);
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

void check_stiffness(const Sections& sections, const Scene& scene) {
    const sim::System system = system_of(scene);
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
        const double steps =
            scene.world.duration_s * largest_frequency_1_s(system, system.bodies[i]) / kFrequencyTimesStep;
        const double updates = steps * static_cast<double>(system.bodies[i].particle_count);
        if (updates <= Limits::kElasticUpdates) continue;
        const bool is_rope = i < sections.ropes.size();
        const TableReader& body = is_rope ? sections.ropes[i] : sections.nets[i - sections.ropes.size()];
        const std::string problem = fmt::format(
            "vibrates so fast that {:g} s take some {:g} steps, {:g} particle updates, over the limit of "
            "{:g}; "
            "give more compliance, less bending, heavier particles or a shorter duration",
            scene.world.duration_s, steps, updates, Limits::kElasticUpdates);
        for (const char* key : {"compliance", "bending"}) {
            if (!is_rope && key == std::string_view("bending")) continue;
            if (const auto value = body.find(key)) value->fail(problem);
        }
        body.fail(problem);
    }
}

void check_pace(const Sections& sections, const Scene& scene) {
    if (scene.solver.method == sim::Method::kRelaxation) return;
    const sim::System system = system_of(scene);
    const double gravity_m_s2 = std::hypot(scene.world.gravity_m_s2.x, scene.world.gravity_m_s2.y);
    const double updates_s =
        scene.video.fps.interval_s() * static_cast<double>(system.particle_count()) / kFrequencyTimesStep;
    const auto too_fast = [&](double rate_1_s) { return rate_1_s * updates_s > Limits::kFrameUpdates; };
    const auto problem = [&](std::string_view what, double rate_1_s, std::string_view remedy) {
        return fmt::format(
            "{} so fast that a frame takes some {:g} particle updates, over the limit of {:g}; give {}", what,
            rate_1_s * updates_s, Limits::kFrameUpdates, remedy);
    };
    if (too_fast(scene.world.drag_1_s))
        fail_at(sections, {{&sections.world, "drag"}},
                problem("slows down", scene.world.drag_1_s, "less drag"));
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
        const sim::Body& body = system.bodies[i];
        const bool is_rope = i < sections.ropes.size();
        const TableReader& table = is_rope ? sections.ropes[i] : sections.nets[i - sections.ropes.size()];
        double shortest_m = std::numeric_limits<double>::infinity();
        double turn_1_s = 0.0;
        for (std::size_t k = body.first_bar; k < body.first_bar + body.bar_count; ++k) {
            const sim::Bar& bar = system.bars[k];
            shortest_m = std::min(shortest_m, bar.rest_m);
            turn_1_s = std::max(turn_1_s, std::hypot(system.vx_m_s[bar.b] - system.vx_m_s[bar.a],
                                                     system.vy_m_s[bar.b] - system.vy_m_s[bar.a]) /
                                              bar.rest_m);
        }
        if (too_fast(turn_1_s)) {
            const std::string text =
                problem("turns", turn_1_s, "less speed, longer links or more frames a second");
            if (const auto value = table.find("velocity")) value->fail(text);
            table.fail(text);
        }
        const double swing_1_s = std::sqrt(gravity_m_s2 / shortest_m);
        if (too_fast(swing_1_s))
            fail_at(sections, {{&sections.world, "gravity"}},
                    problem("swings", swing_1_s, "less gravity or longer links"));
    }
}

}  // namespace corda::scene
