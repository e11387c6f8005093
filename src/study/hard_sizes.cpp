#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "corda/core/error.hpp"
#include "corda/sim/exact.hpp"
#include "corda/sim/rattle.hpp"
#include "corda/study/hard_cases.hpp"
#include "corda/study/probe.hpp"
#include "corda/study/ropes.hpp"
#include "corda/study/truth.hpp"

namespace corda::study {
namespace {

struct SizeRun {
    double taken_s = 0.0;
    double ns_per_particle_step = 0.0;
    double energy_error = 0.0;
    bool went_through = false;
};

/// Seconds that the processor has worked for this program: a comparison of costs must not see who else uses
/// it.
double processor_s() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Costs are the least of slices.
constexpr int kSlices = 10;

/// Runs a solver in slices; `tried` counts what its time went into.
template <class AnySolver, class Count>
SizeRun run_slices(AnySolver& solver, const sim::System& system, double duration_s, const Count& tried) {
    sim::State state{0.0, system.x_m, system.y_m};
    const double start_j = solver.energy_j();
    const auto particles = static_cast<double>(system.particle_count());
    SizeRun result;
    result.ns_per_particle_step = std::numeric_limits<double>::infinity();
    for (int k = 1; k <= kSlices; ++k) {
        const std::uint64_t before = tried();
        const double from_s = processor_s();
        if (solver.advance_to(duration_s * k / kSlices, state) == sim::Status::kDiverged) return result;
        const double taken_s = processor_s() - from_s;
        result.taken_s += taken_s;
        const double ns = 1e9 * taken_s / static_cast<double>(tried() - before) / particles;
        result.ns_per_particle_step = std::min(result.ns_per_particle_step, ns);
    }
    result.went_through = true;
    result.energy_error = std::abs(solver.energy_j() - start_j) / solver.energy_scale_j();
    return result;
}

/// A chain from 45 degrees by method exact; its tried steps count.
SizeRun run_exact(int links, double duration_s) {
    const sim::RopeDef rope = straight_rope(links, 1.0, 45.0);
    const sim::System system = sim::build_system({&rope, 1}, 1);
    sim::Exact solver(system, sim::WorldDef{}, sim::exact_solver(1e-7), 1.0 / 60.0);
    return run_slices(solver, system, duration_s, [&] { return solver.steps() + solver.rejected_steps(); });
}

SizeRun run_rope(int links, double duration_s) {
    const sim::RopeDef rope = straight_rope(links, 1.0, 45.0);
    const sim::System system = sim::build_system({&rope, 1}, 1);
    sim::Rattle solver(system, sim::WorldDef{}, sim::rope_solver(2), 1.0 / 60.0);
    return run_slices(solver, system, duration_s, [&] { return solver.parts(); });
}

/// Whether a rope goes through at no more than 1.5 times the cost a particle and step of 20 links.
Outcome compare_sizes(SizeRun (*run)(int, double), int links, double duration_s) {
    constexpr double kMostTimes = 1.5;
    const SizeRun small = run(20, 20.0);
    const SizeRun large = run(links, duration_s);
    const double times = large.ns_per_particle_step / small.ns_per_particle_step;
    return {
        fmt::format(
            "{}, {:.0f} ns a particle and step, {:.2f} times that of N = 20; energy error {:.1e}; {:.3g} s "
            "of computing a simulated second",
            large.went_through ? "finished" : "diverged", large.ns_per_particle_step, times,
            large.energy_error, large.taken_s / duration_s),
        large.went_through && times <= kMostTimes};
}

void add_sizes(std::vector<HardCase>& cases) {
    constexpr const char* kCriterion = "finishes; cost a particle and step <= 1.5 times that of N = 20";
    cases.push_back(
        {"N = 1000, 5 s", "exact", kCriterion, true, [] { return compare_sizes(run_exact, 1000, 5.0); }});
    cases.push_back(
        {"N = 1000, 0.2 s", "exact", kCriterion, false, [] { return compare_sizes(run_exact, 1000, 0.2); }});
    cases.push_back({"N = 1000, 5 s", "rope, order 2", kCriterion, true,
                     [] { return compare_sizes(run_rope, 1000, 5.0); }});
    cases.push_back({"N = 100 000, 1e-3 s", "exact", kCriterion, true,
                     [] { return compare_sizes(run_exact, 100'000, 1e-3); }});
    cases.push_back({"N = 100 000, 1e-4 s", "rope, order 2", kCriterion, true,
                     [] { return compare_sizes(run_rope, 100'000, 1e-4); }});
}

Outcome long_step(double step_s) {
    constexpr sim::Vec2 kTip = released_tip_m(20, 45.0, 2.0);
    Probe probe(straight_rope(20, 1.0, 45.0), sim::WorldDef{}, sim::rope_solver(8, step_s));
    probe.go(2.0);
    const double error_m = std::hypot(probe.tip_m().x - kTip.x, probe.tip_m().y - kTip.y);
    return {fmt::format("divided; tip off by {:.1e} m after 2 s", error_m), error_m < 1e-6};
}

Outcome short_step() {
    constexpr double kSeconds = 1e-5;
    Probe probe(straight_rope(20, 1.0, 90.0), sim::WorldDef{}, sim::rope_solver(4, 1e-9));
    probe.go(kSeconds);
    const double error_m = std::abs(probe.tip_m().y + 0.5 * 9.81 * kSeconds * kSeconds);
    return {fmt::format("{} steps; fall off by {:.1e} m", probe.diagnostics().steps, error_m),
            error_m < 1e-12};
}

/// A particle thrown so that its first step ends exactly on another.
Outcome zero_length() {
    constexpr double kStepSeconds = 0.5;
    sim::RopeDef rope = rope_through({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}});
    rope.velocity_m_s[1] = {-1.0 / kStepSeconds, 0.0};
    Probe probe(rope, sim::WorldDef{}, sim::relaxation_solver(kStepSeconds, 2, 1));
    for (int k = 1; k <= 100; ++k) probe.go(k * kStepSeconds);
    const bool is_finite = std::isfinite(probe.tip_m().x) && std::isfinite(probe.tip_m().y);
    return {is_finite ? "goes on, all numbers finite" : "a number that is none", is_finite};
}

void add_steps_and_inputs(std::vector<HardCase>& cases) {
    cases.push_back(
        {"step 1 s", "rope, order 8", "substeps: R5 to 1e-6", false, [] { return long_step(1.0); }});
    cases.push_back({"step 1e-9 s", "rope, order 4", "works: free fall to 1e-12 m", false, short_step});
    cases.push_back({"zero length met at run time", "relaxation", "handled", false, zero_length});
}

Outcome refuses(const sim::SolverDef& solver) {
    sim::SolverDef with_bars = solver;
    with_bars.reach = 7;
    try {
        const Probe probe(straight_rope(20, 1.0, 0.0), sim::WorldDef{}, with_bars);
    } catch (const Error& error) {
        return {std::string("refused: ") + error.what(), error.code() == ExitCode::kInvalidScene};
    }
    return {"not refused", false};
}

struct MethodOf {
    const char* name = "";
    sim::SolverDef solver;
};

std::vector<MethodOf> every_method() {
    return {{"relaxation", sim::relaxation_solver(1.0 / 960.0, 1, 1)},
            {"rope, order 8", sim::rope_solver(8)},
            {"exact", sim::exact_solver(1e-9)}};
}

/// Largest distance of a particle at common times of runs at 24, 30, 60 and 120 frames a second.
Outcome compare_rates(const sim::SolverDef& solver) {
    const sim::RopeDef rope = straight_rope(20, 1.0, 45.0);
    double largest_m = 0.0;
    for (const int rate : {30, 60, 120}) {
        Probe first(rope, sim::WorldDef{}, solver, 1.0 / 24.0);
        Probe other(rope, sim::WorldDef{}, solver, 1.0 / rate);
        for (int k = 1; k <= 12; ++k) {  // sixths of a second are frame times of all of them
            for (int frame = 1; frame <= rate / 6; ++frame)
                other.go((k - 1) / 6.0 + static_cast<double>(frame) / rate);
            first.go(k / 6.0);
            for (std::size_t i = 0; i < rope.points_m.size(); ++i) {
                largest_m = std::max(largest_m, std::hypot(first.state().x_m[i] - other.state().x_m[i],
                                                           first.state().y_m[i] - other.state().y_m[i]));
            }
        }
    }
    return {fmt::format("{:.1e} m apart at most", largest_m), largest_m < 1e-9};
}

/// Whether two runs of ropes that should move alike have the same bits.
Outcome same_bits(const sim::SolverDef& solver, sim::Vec2 origin_m) {
    sim::RopeDef rope = straight_rope(10, 1.0, 70.0);
    Probe first(rope, sim::WorldDef{}, solver);
    rope.origin_m = origin_m;
    Probe second(rope, sim::WorldDef{}, solver);
    bool is_same = true;
    for (const double time_s : {0.1, 1.0, 3.0}) {
        first.go(time_s);
        second.go(time_s);
        is_same =
            is_same && first.state().x_m == second.state().x_m && first.state().y_m == second.state().y_m;
    }
    return {is_same ? "the same bits" : "other bits", is_same};
}

void add_bits(std::vector<HardCase>& cases) {
    for (const MethodOf& method : every_method()) {
        const sim::SolverDef solver = method.solver;
        cases.push_back({"pin at (1e6, 1e6)", method.name, "the same bits as at the origin", false, [solver] {
                             return same_bits(solver, {1e6, 1e6});
                         }});
        cases.push_back({"24, 30, 60, 120 frames a second", method.name,
                         "positions at common times within 1e-9 m", false,
                         [solver] { return compare_rates(solver); }});
        cases.push_back(
            {"two runs", method.name, "the same bytes", false, [solver] { return same_bits(solver, {}); }});
    }
    cases.push_back({"seven-neighbour bars", "rope", "refused with the reason", false,
                     [] { return refuses(sim::rope_solver(4)); }});
    cases.push_back({"seven-neighbour bars", "exact", "refused with the reason", false,
                     [] { return refuses(sim::exact_solver(1e-9)); }});
}

/// Cost of a step in the last tenth of a run that is damped to rest, over that in the first; each the least
/// of the slices of several runs, since others may use the machine.
Outcome damped(const sim::SolverDef& solver, double duration_s, double drag_1_s) {
    constexpr double kMostTimes = 1.2;
    constexpr int kRuns = 4;
    sim::WorldDef world;
    world.drag_1_s = drag_1_s;
    const sim::RopeDef rope = straight_rope(20, 1.0, 45.0);
    const auto measure_tenth = [&](Probe& probe, double from_s, double& least_s) {
        for (int k = 1; k <= kSlices; ++k) {
            const double before_s = probe.wall_s();
            const std::uint64_t before = probe.diagnostics().steps;
            probe.go(from_s + 0.1 * duration_s * k / kSlices);
            least_s = std::min(least_s, (probe.wall_s() - before_s) /
                                            static_cast<double>(probe.diagnostics().steps - before));
        }
    };
    double first_s = std::numeric_limits<double>::infinity();
    double last_s = first_s;
    std::uint64_t steps = 0;
    for (int run = 0; run < kRuns; ++run) {
        Probe probe(rope, world, solver);
        measure_tenth(probe, 0.0, first_s);
        probe.go(0.9 * duration_s);
        measure_tenth(probe, 0.9 * duration_s, last_s);
        steps = probe.diagnostics().steps;
    }
    const double times = last_s / first_s;
    return {fmt::format("{:.2f} times, {} steps", times, steps), times <= kMostTimes};
}

/// Largest energy error in the first tenth of many steps of a pendulum, and in all.
Outcome many_steps(double steps) {
    constexpr double kStepSeconds = 1e-3;
    constexpr int kLooks = 20'000;
    Probe probe(straight_rope(1, 1.0, 90.0), sim::WorldDef{}, sim::rope_solver(2, kStepSeconds));
    double early = 0.0;
    for (int k = 1; k <= kLooks; ++k) {
        probe.go(std::round(steps * k / kLooks) * kStepSeconds);
        if (10 * k == kLooks) early = probe.diagnostics().largest.energy_error.value_or(1.0);
    }
    const double all = probe.diagnostics().largest.energy_error.value_or(1.0);
    return {fmt::format("energy error {:.4e} in the first tenth, {:.4e} in all", early, all),
            all < 1e-5 && all < 1.01 * early};
}

void add_long_runs(std::vector<HardCase>& cases) {
    constexpr const char* kCost = "a step of the last tenth costs <= 1.2 times one of the first";
    constexpr const char* kDamped = "damped to rest, 1e6 steps, N = 20";
    cases.push_back({kDamped, "relaxation", kCost, true,
                     [] { return damped(sim::relaxation_solver(1.0 / 500.0, 7, 1), 2000.0, 5.0); }});
    cases.push_back({kDamped, "rope, order 2", kCost, true,
                     [] { return damped(sim::rope_solver(2, 1.0 / 500.0), 2000.0, 5.0); }});
    // Steps of exact follow the motion: this is as many at rest.
    cases.push_back({"damped to rest, N = 20", "exact", kCost, true,
                     [] { return damped(sim::exact_solver(1e-7), 20'000.0, 3.0); }});
    cases.push_back({"1e6 steps, N = 1", "rope, order 2", "energy error bounded, no trend", false,
                     [] { return many_steps(1e6); }});
    cases.push_back({"1e7 steps, N = 1", "rope, order 2", "energy error bounded, no trend", true,
                     [] { return many_steps(1e7); }});
}

}  // namespace

void add_hard_sizes(std::vector<HardCase>& cases) {
    add_sizes(cases);
    add_steps_and_inputs(cases);
    add_bits(cases);
    add_long_runs(cases);
}

}  // namespace corda::study
