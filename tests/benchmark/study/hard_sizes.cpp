#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "benchmark/study/hard_cases.hpp"
#include "benchmark/study/measure.hpp"
#include "benchmark/study/reference/numbers.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "corda/core/basics.hpp"

namespace corda::study {
namespace {

using Kind = HardCase::Kind;

/// Seconds of the processor per step on the way to `until_s`: the minimum of ten slices, because other
/// programs on the machine make some of them slower.
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

/// Passes if a step of a rope costs at most 1.5 times as much per particle as with 20 links.
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
                         double duration_s) {
        cases.push_back({name, method_name, "cost per particle and step <= 1.5 times that of N = 20",
                         Kind::kNotTested, [=] { return compare_sizes(method, links, duration_s); }});
    };
    add("N = 1000, 5 s", "exact", ExactDef{1e-7}, 1000, 5.0);
    add("N = 1000, 5 s", "rattle, order 2", RattleDef{2}, 1000, 5.0);
    add("N = 100 000, 1e-3 s", "exact", ExactDef{1e-7}, 100'000, 1e-3);
    add("N = 100 000, 1e-4 s", "rattle, order 2", RattleDef{2}, 100'000, 1e-4);

    // A cost that grew with the number of links would not finish here.
    const RopeDef thousand = reference::straight_rope(1000, 1.0, 45.0);
    const RopeDef many = reference::straight_rope(100'000, 1.0, 45.0);
    const auto watch = [&](const RopeDef& rope, bool is_exact, double duration_s, double strain, Kind kind) {
        const MethodDef method = is_exact ? MethodDef(ExactDef{1e-7}) : MethodDef(RattleDef{2});
        add_watched(fmt::format("{} links, {:g} s", rope.points_m.size() - 1, duration_s),
                    is_exact ? "exact" : "rattle, order 2", rope, method,
                    {duration_s, strain, is_exact ? 1e-9 : 1e-3, (is_exact ? 1.0 : 10.0) / duration_s}, kind,
                    cases);
    };
    watch(thousand, true, 0.5, 1e-9, Kind::kSlow);
    watch(thousand, true, 5.0, 1e-9, Kind::kLong);
    watch(thousand, false, 0.5, 1e-11, Kind::kSlow);
    watch(thousand, false, 5.0, 1e-11, Kind::kLong);
    watch(many, true, 2e-4, 1e-5, Kind::kSlow);
    watch(many, true, 0.1, 1e-5, Kind::kLong);
    // Links of 10 micrometres under a ton of weight each step by 0.6 microseconds. Measured after 50 steps:
    // strain 8e-12, rounding of positions over the links' length; energy 4e-16.
    watch(many, false, 3e-5, 1e-9, Kind::kSlow);
    watch(many, false, 0.1, 1e-9, Kind::kLong);
}

Outcome long_step(double step_s) {
    constexpr Vec2 kTip = reference::released_tip_m(20, 45.0, 2.0);
    Probe probe(reference::straight_rope(20, 1.0, 45.0), WorldDef{}, RattleDef{8, step_s});
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
    const Diagnostics run = probe.diagnostics();
    return {
        fmt::format("{} steps; fall off by {:.1e} m, strain {:.1e}", run.steps, error_m, run.largest.strain),
        run.steps == 10'000 && error_m < 1e-12 && run.largest.strain < 1e-13};
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
    return {is_finite ? "continues, all numbers are finite" : "a number is not finite", is_finite};
}

/// Passes if a method refuses a rope with a reason that contains a word.
Outcome refused(const RopeDef& rope, const MethodDef& method, const std::string& word) {
    try {
        const Probe probe(rope, WorldDef{}, method);
    } catch (const Error& error) {
        const std::string reason = error.what();
        return {"refused: " + reason,
                error.code() == ExitCode::kInvalidScene && reason.find(word) != std::string::npos};
    }
    return {"not refused", false};
}

void add_steps_and_refusals(std::vector<HardCase>& cases) {
    for (const double step_s : {1.0, 0.1}) {
        cases.push_back({fmt::format("step {:g} s", step_s), "rattle, order 8",
                         "divides the step: R5 to 1e-6", Kind::kQuick,
                         [step_s] { return long_step(step_s); }});
    }
    cases.push_back(
        {"step 1e-9 s", "rattle, order 4", "free fall to 1e-12 m, strain < 1e-13", Kind::kQuick, short_step});
    cases.push_back(
        {"two particles meet during the run", "relaxation", "continues", Kind::kQuick, zero_length});
    RopeDef reaching = reference::straight_rope(20, 1.0, 0.0);
    reaching.reach = 7;
    RopeDef taut = reference::straight_rope(10, 1.0, 90.0);
    taut.pinned = {0, 10};
    const auto add = [&](const char* name, const char* method_name, const RopeDef& rope,
                         const MethodDef& method, const char* word) {
        cases.push_back({name, method_name, fmt::format("refused, with the reason: \"{}\"", word),
                         Kind::kQuick, [=] { return refused(rope, method, word); }});
    };
    add("bars of reach 7", "rattle", reaching, RattleDef{}, "depend on each other");
    add("bars of reach 7", "exact", reaching, ExactDef{}, "reach");
    add("straight between two pins", "rattle", taut, RattleDef{4}, "straight");
}

/// Largest distance of a particle at common times of runs at 24, 30, 60 and 120 frames per second. Measured:
/// 0 for relaxation, 7e-16 for exact (the times themselves are rounded), 7e-15 for rattle.
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
    return {fmt::format("at most {:.1e} m apart", largest_m), largest_m <= 1e-13};
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
        cases.push_back(
            {"pin at (1e6, 1e6)", named.first, "the same bits as at the origin", Kind::kQuick, [method] {
                 return same_bits(method, {1e6, 1e6});
             }});
        cases.push_back({"24, 30, 60, 120 frames per second", named.first,
                         "positions at common times within 1e-13 m", Kind::kQuick,
                         [method] { return compare_frame_rates(method); }});
        cases.push_back({"two runs", named.first, "the same bits", Kind::kQuick,
                         [method] { return same_bits(method, {}); }});
    }
}

/// Ratio of the costs of a step in the last and in the first tenth of a run that is damped to rest, each the
/// minimum of several runs.
Outcome damped(const MethodDef& method, double duration_s, double drag_1_s, int reach) {
    constexpr int kRuns = 4;
    const WorldDef world{.drag_1_s = drag_1_s};
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

/// Largest energy error of a pendulum in the first tenth of many steps, and in all of them: a trend would
/// make ten times as much of it.
Outcome many_steps(const RattleDef& method, double steps, double bound) {
    constexpr int kLooks = 20'000;
    Probe probe(reference::straight_rope(1, 1.0, 90.0), WorldDef{}, method);
    double early = 0.0;
    for (int k = 1; k <= kLooks; ++k) {
        probe.go(std::round(steps * k / kLooks) * method.step_s.value());
        if (10 * k == kLooks) early = probe.diagnostics().largest.energy_error.value_or(1.0);
    }
    const double all = probe.diagnostics().largest.energy_error.value_or(1.0);
    return {fmt::format("energy error {:.4e} in the first tenth, {:.4e} in all", early, all),
            all < bound && (all < 1.01 * early || all < 1e-12)};
}

void add_long_runs(std::vector<HardCase>& cases) {
    constexpr const char* kCost = "a step of the last tenth costs <= 1.2 times one of the first";
    constexpr const char* kDamped = "damped to rest, 1e6 steps, N = 20";
    cases.push_back({kDamped, "relaxation", kCost, Kind::kNotTested,
                     [] { return damped(RelaxationDef{1.0 / 500.0}, 2000.0, 5.0, 7); }});
    cases.push_back({kDamped, "rattle, order 2", kCost, Kind::kNotTested, [] {
                         return damped(RattleDef{2, 1.0 / 500.0}, 2000.0, 5.0, 1);
                     }});
    // The steps of exact grow as the motion dies, so that there are fewer.
    cases.push_back({"damped to rest, N = 20", "exact", kCost, Kind::kNotTested,
                     [] { return damped(ExactDef{1e-7}, 20'000.0, 3.0, 1); }});
    // Measured: order 2 3.7e-6, the method's own; order 8 4e-15 after 2e5 steps and 8.9e-14 after 1e7, all of
    // it rounding.
    const auto add = [&](int order, double step_s, double steps, double bound, Kind kind) {
        cases.push_back({fmt::format("{:.0e} steps, N = 1", steps), fmt::format("rattle, order {}", order),
                         fmt::format("energy error < {:g}, no trend", bound), kind, [=] {
                             return many_steps({order, step_s}, steps, bound);
                         }});
    };
    add(2, 1e-3, 1e6, 1e-5, Kind::kQuick);
    add(2, 1e-3, 1e7, 1e-5, Kind::kLong);
    add(8, 1e-2, 2e5, 1e-12, Kind::kQuick);
    add(8, 1e-2, 1e7, 1e-12, Kind::kLong);
}

}  // namespace

void add_hard_sizes(std::vector<HardCase>& cases) {
    add_sizes(cases);
    add_steps_and_refusals(cases);
    add_bits(cases);
    add_long_runs(cases);
}

}  // namespace corda::study
