// The chapter "The pendulum challenge": XPBD with small steps beside method exact, on Mueller's n-pendulum
// and three harder ones.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <functional>
#include <limits>

#include "benchmark/peers/xpbd.hpp"
#include "benchmark/study/chapters.hpp"
#include "corda/reference/ropes.hpp"
#include "corda/sim/solver.hpp"
#include "support/extended_motion.hpp"

namespace corda::benchmark {
namespace {

constexpr int kFramesPerSecond = 60;
constexpr int kEnergyFrames = 60 * kFramesPerSecond;

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

report::Series pose_of(const Frames& frames, const std::string& name, std::size_t look) {
    report::Series pose{.name = name, .points = {}, .look = look};
    for (const Vec2 at : frames.back()) pose.points.emplace_back(at.x, at.y);
    return pose;
}

report::Plot plot_of(const Pendulum& pendulum, const Run& xpbd, const Run& exact, const Frames& truth) {
    report::Plot plot;
    plot.id = "challenge_" + pendulum.id;
    plot.title = fmt::format("{} after {:g} s", pendulum.name, pendulum.seconds);
    plot.x_title = "x [m]";
    plot.y_title = "y [m]";
    plot.log_x = plot.log_y = false;
    plot.has_equal_scales = true;
    plot.context_name = "truth, path of the end";
    report::Series path{.name = plot.context_name, .points = {}};
    path.is_context = true;
    for (const auto& frame : truth) path.points.emplace_back(frame.back().x, frame.back().y);
    // The truth comes last, as points on the lines of the methods.
    plot.series = {std::move(path), pose_of(xpbd.frames, "XPBD, " + xpbd.setting, 1),
                   pose_of(exact.frames, "exact, " + exact.setting, 2), pose_of(truth, "truth", 0)};
    plot.series.back().form = report::Series::Form::kPoints;
    return plot;
}

/// Lines of a source file with code on them.
int code_lines(const std::string& path) {
    std::ifstream file(std::string(CORDA_SOURCE) + "/" + path);
    if (!file) throw Error(ExitCode::kIo, path + ": cannot be read");
    int lines = 0;
    for (std::string line; std::getline(file, line);) {
        const std::size_t begin = line.find_first_not_of(' ');
        if (begin != std::string::npos && line.compare(begin, 2, "//") != 0) ++lines;
    }
    return lines;
}

report::Table lines_table() {
    report::Table table{"challenge_lines", "Simplicity: lines of code", {}, {}, {}};
    table.columns = {{"method", "method"}, {"lines", "lines"}, {"what", "of which files"}};
    table.add(
        {"XPBD", double(code_lines("tests/benchmark/peers/xpbd.hpp")), "tests/benchmark/peers/xpbd.hpp"});
    int exact = 0;
    for (const char* name : {"chain_dynamics", "chain_series", "dop853", "exact"}) {
        for (const char* ending : {".hpp", ".cpp"})
            exact += code_lines(std::string("src/corda/sim/exact/") + name + ending);
    }
    exact +=
        code_lines("src/corda/sim/exact/series_terms.hpp") + code_lines("src/corda/sim/chain_tensions.hpp");
    table.add({"Corda, exact", double(exact), "src/corda/sim/exact, what a rigid chain needs of it"});
    return table;
}

report::Table runs_table() {
    report::Table table{"challenge", "XPBD and Corda on four pendulums", {}, {}, {}};
    table.columns = {{"pendulum", "pendulum"},
                     {"method", "method"},
                     {"setting", "setting"},
                     {"seconds", "compared for [s]"},
                     {"error_m", "largest error [m]"},
                     {"energy_error_over_mgl", "energy after 60 s / (M g L)"},
                     {"strain_largest", "largest strain"},
                     {"us_per_frame", "CPU time per frame [us]"}};
    return table;
}

report::Table ratios_table() {
    report::Table table{"challenge_ratios", "Time at equal error", {}, {}, {}};
    table.columns = {{"pendulum", "pendulum"},           {"substeps", "XPBD"},
                     {"error_m", "its error [m]"},       {"tolerance", "exact, at most this error"},
                     {"exact_error_m", "its error [m]"}, {"ratio", "XPBD's time over exact's"}};
    return table;
}

}  // namespace

report::Chapter challenge_chapter(const Options& options) {
    report::Chapter chapter;
    chapter.title = "The pendulum challenge";
    report::Table runs = runs_table();
    report::Table ratios = ratios_table();
    report::Table lines = lines_table();
    for (const Pendulum& pendulum : pendulums()) {
        const Frames truth = true_frames(pendulum);
        std::vector<Run> all;
        for (const int substeps : {50, 500, 5000}) all.push_back(run_xpbd(pendulum, substeps));
        for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-9}) all.push_back(run_exact(pendulum, tolerance));
        time_in_turns(all, options.repeats);
        for (Run& run : all) {
            run.error_m = largest_distance_m(run.frames, truth);
            runs.add({pendulum.name, run.method, run.setting, pendulum.seconds, run.error_m, run.energy_error,
                      run.strain, run.microseconds_a_frame()});
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const auto best = std::find_if(all.begin() + 3, all.end(),
                                           [&](const Run& run) { return run.error_m <= all[i].error_m; });
            if (best == all.end()) continue;
            ratios.add({pendulum.name, all[i].setting, all[i].error_m, best->setting, best->error_m,
                        all[i].microseconds_a_frame() / best->microseconds_a_frame()});
        }
        chapter.plots.push_back(plot_of(pendulum, all[0], all[3], truth));
    }
    chapter.tables = {std::move(runs), std::move(ratios), std::move(lines)};
    return chapter;
}

}  // namespace corda::benchmark
