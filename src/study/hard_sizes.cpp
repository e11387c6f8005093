#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/reference/numbers.hpp"
#include "corda/reference/ropes.hpp"
#include "corda/study/hard_cases.hpp"
#include "corda/study/measure.hpp"

namespace corda::study {
namespace {

/// Seconds of the processor per step on the way to `until_s`: the least of ten slices, because other programs
/// on the machine make some of them slower.
double step_cost_s(Probe& probe, double until_s) {
    constexpr int kSlices = 10;
    const double from_s = probe.state().time_s;
    double least_s = std::numeric_limits<double>::infinity();
    for (int k = 1; k <= kSlices; ++k) {
        const std::uint64_t steps = probe.diagnostics().steps;
        const std::clock_t start = std::clock();
        probe.go(from_s + (until_s - from_s) * k / kSlices);
        const double taken_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        least_s = std::min(least_s, taken_s / static_cast<double>(probe.diagnostics().steps - steps));
    }
    return least_s;
}

/// Whether a rope finishes, at a cost per particle and step of at most 1.5 times that of 20 links.
Outcome compare_sizes(const MethodDef& method, int links, double duration_s) {
    constexpr int kFewLinks = 20;
    Probe small(reference::straight_rope(kFewLinks, 1.0, 45.0), WorldDef{}, method);
    Probe large(reference::straight_rope(links, 1.0, 45.0), WorldDef{}, method);
    const double small_ns = 1e9 * step_cost_s(small, 20.0) / (kFewLinks + 1);
    const double large_ns = 1e9 * step_cost_s(large, duration_s) / (links + 1);
    const double ratio = large_ns / small_ns;
    return {fmt::format("{:.0f} ns per particle and step, {:.2f} times that of N = 20; energy error {:.1e}; "
                        "{:.3g} s of computing per simulated second",
                        large_ns, ratio, large.diagnostics().largest.energy_error.value_or(0.0),
                        large.wall_s() / duration_s),
            ratio <= 1.5};
}

void add_sizes(std::vector<HardCase>& cases) {
    const auto add = [&](const char* name, const char* method_name, const MethodDef& method, int links,
                         double duration_s, bool is_slow) {
        cases.push_back({name, method_name,
                         "finishes; cost per particle and step <= 1.5 times that of N = 20", is_slow,
                         [=] { return compare_sizes(method, links, duration_s); }});
    };
    add("N = 1000, 5 s", "exact", ExactDef{1e-7}, 1000, 5.0, true);
    add("N = 1000, 0.2 s", "exact", ExactDef{1e-7}, 1000, 0.2, false);
    add("N = 1000, 5 s", "rattle, order 2", RattleDef{2}, 1000, 5.0, true);
    add("N = 100 000, 1e-3 s", "exact", ExactDef{1e-7}, 100'000, 1e-3, true);
    add("N = 100 000, 1e-4 s", "rattle, order 2", RattleDef{2}, 100'000, 1e-4, true);
}

Outcome long_step() {
    constexpr Vec2 kTip = reference::released_tip_m(20, 45.0, 2.0);
    Probe probe(reference::straight_rope(20, 1.0, 45.0), WorldDef{}, RattleDef{8, 1.0});
    probe.go(2.0);
    const Vec2 apart_m = probe.tip_m() - kTip;
    const double error_m = std::hypot(apart_m.x, apart_m.y);
    return {fmt::format("tip off by {:.1e} m after 2 s", error_m), error_m < 1e-6};
}

Outcome short_step() {
    constexpr double kSeconds = 1e-5;
    Probe probe(reference::straight_rope(20, 1.0, 90.0), WorldDef{}, RattleDef{4, 1e-9});
    probe.go(kSeconds);
    const double error_m = std::abs(probe.tip_m().y + 0.5 * reference::kGravity * kSeconds * kSeconds);
    return {fmt::format("{} steps; fall off by {:.1e} m", probe.diagnostics().steps, error_m),
            error_m < 1e-12};
}

/// A particle whose first step ends exactly on another one.
Outcome zero_length() {
    constexpr double kStepSeconds = 0.5;
    RopeDef rope = reference::rope_through({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}});
    rope.velocity_m_s[1] = {-1.0 / kStepSeconds, 0.0};
    rope.reach = 2;
    Probe probe(rope, WorldDef{}, RelaxationDef{kStepSeconds});
    for (int k = 1; k <= 100; ++k) probe.go(k * kStepSeconds);
    const bool is_finite = std::isfinite(probe.tip_m().x) && std::isfinite(probe.tip_m().y);
    return {is_finite ? "goes on, all numbers are finite" : "a number is not finite", is_finite};
}

Outcome refused(const MethodDef& method) {
    RopeDef rope = reference::straight_rope(20, 1.0, 0.0);
    rope.reach = 7;
    try {
        const Probe probe(rope, WorldDef{}, method);
    } catch (const Error& error) {
        return {std::string("refused: ") + error.what(), error.code() == ExitCode::kInvalidScene};
    }
    return {"not refused", false};
}

void add_steps_and_refusals(std::vector<HardCase>& cases) {
    cases.push_back({"step 1 s", "rattle, order 8", "divides the step: R5 to 1e-6", false, long_step});
    cases.push_back({"step 1e-9 s", "rattle, order 4", "free fall to 1e-12 m", false, short_step});
    cases.push_back({"two particles meet during the run", "relaxation", "goes on", false, zero_length});
    constexpr const char* kBars = "seven-neighbour bars";
    constexpr const char* kRefused = "refused with the reason";
    cases.push_back({kBars, "rattle", kRefused, false, [] { return refused(RattleDef{}); }});
    cases.push_back({kBars, "exact", kRefused, false, [] { return refused(ExactDef{}); }});
}

/// Largest distance of a particle at common times of runs at 24, 30, 60 and 120 frames per second.
Outcome compare_frame_rates(const MethodDef& method) {
    const RopeDef rope = reference::straight_rope(20, 1.0, 45.0);
    double largest_m = 0.0;
    for (const int frames_per_second : {30, 60, 120}) {
        Probe first(rope, WorldDef{}, method, 1.0 / 24.0);
        Probe other(rope, WorldDef{}, method, 1.0 / frames_per_second);
        for (int k = 1; k <= 12; ++k) {  // sixths of a second are frame times of all of them
            first.go_by_frames(k / 6.0, 24.0);
            other.go_by_frames(k / 6.0, frames_per_second);
            for (std::size_t i = 0; i < rope.points_m.size(); ++i) {
                largest_m = std::max(largest_m, std::hypot(first.state().x_m[i] - other.state().x_m[i],
                                                           first.state().y_m[i] - other.state().y_m[i]));
            }
        }
    }
    return {fmt::format("at most {:.1e} m apart", largest_m), largest_m < 1e-9};
}

/// Whether two runs of a rope have the same bits, one of them with another origin.
Outcome same_bits(const MethodDef& method, Vec2 origin_m) {
    RopeDef rope = reference::straight_rope(10, 1.0, 70.0);
    Probe first(rope, WorldDef{}, method);
    rope.origin_m = origin_m;
    Probe second(rope, WorldDef{}, method);
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
    const std::initializer_list<std::pair<const char*, MethodDef>> methods{
        {"relaxation", RelaxationDef{1.0 / 960.0}},
        {"rattle, order 8", RattleDef{8}},
        {"exact", ExactDef{1e-9}}};
    for (const auto& named : methods) {
        const MethodDef& method = named.second;
        cases.push_back({"pin at (1e6, 1e6)", named.first, "the same bits as at the origin", false, [method] {
                             return same_bits(method, {1e6, 1e6});
                         }});
        cases.push_back({"24, 30, 60, 120 frames per second", named.first,
                         "positions at common times within 1e-9 m", false,
                         [method] { return compare_frame_rates(method); }});
        cases.push_back(
            {"two runs", named.first, "the same bits", false, [method] { return same_bits(method, {}); }});
    }
}

/// Cost of a step in the last tenth of a run that is damped to rest over that in the first, the least of
/// several runs each.
Outcome damped(const MethodDef& method, double duration_s, double drag_1_s, int reach) {
    constexpr int kRuns = 4;
    WorldDef world;
    world.drag_1_s = drag_1_s;
    RopeDef rope = reference::straight_rope(20, 1.0, 45.0);
    rope.reach = reach;
    double first_s = std::numeric_limits<double>::infinity();
    double last_s = first_s;
    std::uint64_t steps = 0;
    for (int run = 0; run < kRuns; ++run) {
        Probe probe(rope, world, method);
        first_s = std::min(first_s, step_cost_s(probe, 0.1 * duration_s));
        probe.go(0.9 * duration_s);
        last_s = std::min(last_s, step_cost_s(probe, duration_s));
        steps = probe.diagnostics().steps;
    }
    const double ratio = last_s / first_s;
    return {fmt::format("{:.2f} times, {} steps", ratio, steps), ratio <= 1.2};
}

/// Largest energy error of a pendulum in the first tenth of many steps, and in all of them.
Outcome many_steps(double steps) {
    constexpr double kStepSeconds = 1e-3;
    constexpr int kLooks = 20'000;
    Probe probe(reference::straight_rope(1, 1.0, 90.0), WorldDef{}, RattleDef{2, kStepSeconds});
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
                     [] { return damped(RelaxationDef{1.0 / 500.0}, 2000.0, 5.0, 7); }});
    cases.push_back({kDamped, "rattle, order 2", kCost, true, [] {
                         return damped(RattleDef{2, 1.0 / 500.0}, 2000.0, 5.0, 1);
                     }});
    // The steps of exact grow as the motion dies, so that there are fewer.
    cases.push_back({"damped to rest, N = 20", "exact", kCost, true,
                     [] { return damped(ExactDef{1e-7}, 20'000.0, 3.0, 1); }});
    constexpr const char* kTrend = "energy error bounded, no trend";
    cases.push_back({"1e6 steps, N = 1", "rattle, order 2", kTrend, false, [] { return many_steps(1e6); }});
    cases.push_back({"1e7 steps, N = 1", "rattle, order 2", kTrend, true, [] { return many_steps(1e7); }});
}

}  // namespace

void add_hard_sizes(std::vector<HardCase>& cases) {
    add_sizes(cases);
    add_steps_and_refusals(cases);
    add_bits(cases);
    add_long_runs(cases);
}

}  // namespace corda::study
