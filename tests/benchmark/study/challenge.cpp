// The chapter "The pendulum challenge": XPBD with small steps beside method exact, on Mueller's n-pendulum
// and three harder ones.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <limits>

#include "benchmark/peers/xpbd.hpp"
#include "benchmark/study/chapters.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/solver.hpp"
#include "support/extended_motion.hpp"

namespace corda::study {
namespace {

using nlohmann::json;

constexpr int kFramesPerSecond = 60;
constexpr int kEnergyFrames = 60 * kFramesPerSecond;

/// Of each timed run.
int repeats_of(const Options& options) {
    return options.quick ? 2 : 9;
}

struct Pendulum {
    std::string id;
    std::string name;
    RopeDef rope;
    double seconds = 2.0;  ///< errors are compared up to here, while the motion can be predicted
    WorldDef world = {};

    [[nodiscard]] int frames() const { return static_cast<int>(std::lround(seconds * kFramesPerSecond)); }
    [[nodiscard]] System system() const { return build_system({&rope, 1}); }
};

/// Straight to the right and at rest.
Pendulum horizontal(std::string id, std::string name, int links, double length_m) {
    Pendulum made{std::move(id), std::move(name), reference::straight_rope(links, length_m, 90.0)};
    made.rope.mass_kg.assign(made.rope.points_m.size(), 1.0);
    return made;
}

std::vector<Pendulum> pendulums() {
    std::vector<Pendulum> all{horizontal("three", "3 links", 3, 0.9),
                              horizontal("masses", "4 links, masses 0.1, 0.1, 0.1, 10 kg", 4, 1.2),
                              horizontal("ten", "10 links", 10, 1.0),
                              horizontal("forty", "40 links", 40, 1.0)};
    // The challenge's own gravity, and lengths of 0.3 m.
    all[0].world.gravity_m_s2 = all[1].world.gravity_m_s2 = {0.0, -10.0};
    all[0].seconds = 4.0;
    all[3].seconds = 1.5;
    all[1].rope.mass_kg = {1.0, 0.1, 0.1, 0.1, 10.0};
    return all;
}

/// Kinetic plus potential energy, in J.
double energy_j(const System& system, Vec2 gravity_m_s2, const peers::Xpbd& run) {
    double sum_j = 0.0;
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        if (system.is_pinned(i)) continue;
        const Vec2 v = run.velocity_m_s[i];
        sum_j += system.mass_kg[i] * (0.5 * dot(v, v) - dot(gravity_m_s2, run.position_m[i]));
    }
    return sum_j;
}

double largest_strain(const System& system, const std::vector<Vec2>& at) {
    double largest = 0.0;
    for (const Bar& bar : system.bars) {
        const Vec2 along = at[bar.b] - at[bar.a];
        largest = std::max(largest, std::abs(std::hypot(along.x, along.y) / bar.rest_m - 1.0));
    }
    return largest;
}

/// M g L of the free particles: a pendulum's full depth.
double energy_scale_j(const System& system, double gravity_m_s2) {
    double mass_kg = 0.0;
    for (std::size_t i = 0; i < system.particle_count(); ++i)
        mass_kg += system.is_pinned(i) ? 0.0 : system.mass_kg[i];
    return mass_kg * gravity_m_s2 * largest_length_m(system);
}

using Frames = std::vector<std::vector<Vec2>>;

std::vector<Vec2> positions(const State& state) {
    std::vector<Vec2> at;
    for (std::size_t i = 0; i < state.x_m.size(); ++i) at.push_back({state.x_m[i], state.y_m[i]});
    return at;
}

/// One method on one pendulum.
struct Run {
    std::string method;
    std::string setting;
    Frames frames = {};  ///< up to Pendulum::seconds
    double energy_error = 0.0;
    double strain = 0.0;
    std::function<void()> repeat = {};  ///< simulates these frames
    std::vector<double> repeat_s = {};  ///< CPU time of each repeat
    double error_m = 0.0;

    [[nodiscard]] double microseconds_a_frame() const {
        return 1e6 * *std::min_element(repeat_s.begin(), repeat_s.end()) /
               static_cast<double>(frames.size() - 1);
    }
};

Run run_xpbd(const Pendulum& pendulum, int substeps) {
    Run run{"XPBD", fmt::format("{} substeps", substeps)};
    const System system = pendulum.system();
    const double step_s = 1.0 / kFramesPerSecond / substeps;
    peers::Xpbd xpbd(system, pendulum.world.gravity_m_s2);
    const double start_j = energy_j(system, pendulum.world.gravity_m_s2, xpbd);
    run.frames.push_back(xpbd.position_m);
    for (int frame = 1; frame <= kEnergyFrames; ++frame) {
        for (int k = 0; k < substeps; ++k) xpbd.step(step_s);
        if (frame <= pendulum.frames()) run.frames.push_back(xpbd.position_m);
        run.strain = std::max(run.strain, largest_strain(system, xpbd.position_m));
    }
    run.energy_error = (energy_j(system, pendulum.world.gravity_m_s2, xpbd) - start_j) /
                       energy_scale_j(system, -pendulum.world.gravity_m_s2.y);
    run.repeat = [system, gravity = pendulum.world.gravity_m_s2, steps = pendulum.frames() * substeps,
                  step_s] {
        peers::Xpbd timed(system, gravity);
        for (int k = 0; k < steps; ++k) timed.step(step_s);
    };
    return run;
}

Run run_exact(const Pendulum& pendulum, double tolerance) {
    Run run{"Corda, exact", fmt::format("tolerance {:.0e}", tolerance)};
    const System system = pendulum.system();
    const MethodDef method = ExactDef{tolerance};
    Simulation simulation(system, pendulum.world, method);
    run.frames.push_back(positions(simulation.state()));
    for (int frame = 1; frame <= kEnergyFrames; ++frame) {
        if (simulation.advance_to(static_cast<double>(frame) / kFramesPerSecond) == Status::kDiverged)
            throw Error(ExitCode::kDiverged, pendulum.name + ": method exact diverged");
        if (frame <= pendulum.frames()) run.frames.push_back(positions(simulation.state()));
    }
    run.energy_error = simulation.energy_change_j() / energy_scale_j(system, -pendulum.world.gravity_m_s2.y);
    run.strain = simulation.diagnostics().largest.strain;
    run.repeat = [system, world = pendulum.world, method, frames = pendulum.frames()] {
        const auto solver = sim::make_solver(system, world, {&method, 1}, 1.0 / kFramesPerSecond);
        State state{0.0, system.x_m, system.y_m};
        for (int frame = 1; frame <= frames; ++frame)
            (void)solver->advance_to(static_cast<double>(frame) / kFramesPerSecond, state);
    };
    return run;
}

/// By an independent formulation in extended precision.
Frames true_frames(const Pendulum& pendulum) {
    const System system = pendulum.system();
    test::ExtendedMotion motion(system, pendulum.world);
    Frames frames;
    for (int frame = 0; frame <= pendulum.frames(); ++frame) {
        if (!motion.advance_to(static_cast<double>(frame) / kFramesPerSecond))
            throw Error(ExitCode::kInternal, pendulum.name + ": " + motion.failure());
        frames.emplace_back();
        for (std::size_t i = 0; i < system.particle_count(); ++i)
            frames.back().push_back({static_cast<double>(motion.x_m(i)), static_cast<double>(motion.y_m(i))});
    }
    return frames;
}

double largest_distance_m(const Frames& a, const Frames& b) {
    double largest_m = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        for (std::size_t i = 0; i < a[k].size(); ++i) {
            const Vec2 apart = a[k][i] - b[k][i];
            largest_m = std::max(largest_m, std::hypot(apart.x, apart.y));
        }
    }
    return largest_m;
}

/// Times runs in turns, so that all meet the same load of the machine.
void time_in_turns(std::vector<Run>& runs, int repeats) {
    for (int repeat = 0; repeat < repeats; ++repeat) {
        for (Run& run : runs) {
            const std::clock_t start = std::clock();
            int times = 0;
            do {
                run.repeat();
                ++times;
            } while (std::clock() - start < CLOCKS_PER_SEC / 100);
            run.repeat_s.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / times);
        }
    }
}

json points_json(const std::vector<Vec2>& points) {
    json rows = json::array();
    for (const Vec2 at : points) rows.push_back({at.x, at.y});
    return rows;
}

json run_json(const Run& run) {
    return {{"method", run.method},
            {"setting", run.setting},
            {"error_m", run.error_m},
            {"energy_error_over_mgl", run.energy_error},
            {"strain_largest", run.strain},
            {"us_per_frame", run.microseconds_a_frame()},
            {"last_pose_m", points_json(run.frames.back())}};
}

json measure_pendulum(const Pendulum& pendulum, const Options& options) {
    const Frames truth = true_frames(pendulum);
    std::vector<Run> all;
    for (const int substeps : {50, 500, 5000}) {
        if (substeps <= 500 || !options.quick) all.push_back(run_xpbd(pendulum, substeps));
    }
    for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-9}) all.push_back(run_exact(pendulum, tolerance));
    time_in_turns(all, repeats_of(options));
    json runs = json::array();
    for (Run& run : all) {
        run.error_m = largest_distance_m(run.frames, truth);
        runs.push_back(run_json(run));
    }
    std::vector<Vec2> path;
    for (const auto& frame : truth) path.push_back(frame.back());
    return {{"id", pendulum.id},
            {"pendulum", pendulum.name},
            {"compared_s", pendulum.seconds},
            {"true_last_pose_m", points_json(truth.back())},
            {"true_path_of_the_end_m", points_json(path)},
            {"runs", std::move(runs)}};
}

}  // namespace

json measure_challenge(const Options& options, const OnRun& on_run) {
    json rows = json::array();
    for (const Pendulum& pendulum : pendulums()) {
        on_run(pendulum.name);
        rows.push_back(measure_pendulum(pendulum, options));
    }
    return {{"times", fmt::format("CPU time of one thread: the minimum of {} repeats of at least 10 ms, the "
                                  "methods in turns",
                                  repeats_of(options))},
            {"pendulums", std::move(rows)}};
}

}  // namespace corda::study
