#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "corda/reference/numbers.hpp"
#include "corda/reference/ropes.hpp"
#include "corda/report/writers.hpp"
#include "corda/study/hard_cases.hpp"
#include "corda/study/measure.hpp"

namespace corda::study {
namespace {

/// How long a motion is watched, and what its largest figures may be.
struct Limits {
    double duration_s;
    double strain;
    double energy_error;
    double frames_per_second = 60.0;
};

Outcome watch(const RopeDef& rope, const MethodDef& method, const Limits& limits) {
    Probe probe(rope, WorldDef{}, method);
    probe.go_by_frames(limits.duration_s, limits.frames_per_second);
    const Figures largest = probe.diagnostics().largest;
    const double energy_error = largest.energy_error.value_or(std::numeric_limits<double>::infinity());
    return {fmt::format("strain {:.1e}, energy error {:.1e}", largest.strain, energy_error),
            largest.strain < limits.strain && energy_error < limits.energy_error};
}

/// Adds a case that is watched.
void add(const std::string& name, const char* method_name, const RopeDef& rope, const MethodDef& method,
         const Limits& limits, bool is_slow, std::vector<HardCase>& cases) {
    cases.push_back({name, method_name,
                     fmt::format("strain < {}, energy error < {}", report::short_number(limits.strain),
                                 report::short_number(limits.energy_error)),
                     is_slow, [=] { return watch(rope, method, limits); }});
}

void add_payloads(std::vector<HardCase>& cases) {
    for (const double payload_kg : {1e3, 1e6}) {
        for (const double angle_deg : {45.0, 90.0}) {
            for (const int links : {10, 50}) {
                RopeDef rope = reference::straight_rope(links, 1.0, angle_deg);
                rope.payload_kg = payload_kg;
                const std::string name = fmt::format("payload {} kg, {:g} deg, N = {}, 10 s",
                                                     report::short_number(payload_kg), angle_deg, links);
                // A light rope under a heavy payload oscillates about 1e4 times per second.
                const bool is_slow = payload_kg > 1e5;
                add(name, "exact", rope, ExactDef{1e-7}, {10.0, 1e-9, 1e-6}, is_slow, cases);
                add(name, "rattle, order 6", rope, RattleDef{6}, {10.0, 1e-9, 1e-3}, is_slow, cases);
            }
        }
    }
}

/// Links of lengths 1 and 100 in turn, 1 m in all.
RopeDef unequal_rope(double angle_deg) {
    const RopeDef straight = reference::straight_rope(1010, 1.01, angle_deg);
    std::vector<Vec2> points_m = {straight.points_m.front()};
    for (std::size_t at = 0, i = 0; i < 20; ++i) points_m.push_back(straight.points_m[at += i % 2 ? 100 : 1]);
    return reference::rope_through(std::move(points_m));
}

void add_releases(std::vector<HardCase>& cases) {
    add("undamped from the horizontal, N = 50, 60 s", "exact, 1e-9", reference::straight_rope(50, 1.0, 90.0),
        ExactDef{1e-9}, {60.0, 1e-9, 1e-6}, true, cases);
    for (const double angle_deg : {45.0, 90.0}) {
        const std::string name = fmt::format("links 1:100, {:g} deg, 10 s", angle_deg);
        const Limits limits{10.0, 1e-12, 1e-8};
        add(name, "exact", unequal_rope(angle_deg), ExactDef{1e-9}, limits, false, cases);
        add(name, "rattle, order 8", unequal_rope(angle_deg), RattleDef{8}, limits, true, cases);
    }
    const RopeDef folded = reference::folded_rope(21);
    constexpr const char* kFolded = "folded by 180 deg (R7, N = 21), 1 s";
    add(kFolded, "exact", folded, ExactDef{1e-9}, {1.0, 1e-9, 1e-6}, false, cases);
    add(kFolded, "rattle, order 8", folded, RattleDef{8}, {1.0, 1e-9, 1e-6}, false, cases);
}

void add_throws(std::vector<HardCase>& cases) {
    RopeDef rope = reference::straight_rope(10, 1.0, 0.0);
    rope.velocity_m_s.back() = {100.0, 0.0};
    // The kinetic energy is 51 times the weight times the length: this is 1e-6 of it.
    const Limits limits{2.0, 1e-9, 5.1e-5};
    constexpr const char* kThrown = "tip thrown at 100 m/s, 2 s";
    add(kThrown, "exact", rope, ExactDef{1e-9}, limits, false, cases);
    add(kThrown, "rattle, order 8", rope, RattleDef{8}, limits, true, cases);
}

/// Positions do not depend on a mass that all particles share.
Outcome same_masses(const MethodDef& method, double mass_kg) {
    RopeDef rope = reference::straight_rope(10, 1.0, 45.0);
    Probe unit(rope, WorldDef{}, method);
    rope.mass_kg.assign(rope.points_m.size(), mass_kg);
    Probe other(rope, WorldDef{}, method);
    unit.go_by_frames(2.0);
    other.go_by_frames(2.0);
    const Vec2 apart_m = other.tip_m() - unit.tip_m();
    const double distance_m = std::hypot(apart_m.x, apart_m.y);
    return {fmt::format("tip {:.1e} m from that with 1 kg after 2 s", distance_m), distance_m < 1e-9};
}

void add_masses(std::vector<HardCase>& cases) {
    const std::initializer_list<std::pair<const char*, MethodDef>> methods{
        {"exact", ExactDef{1e-9}},
        {"rattle, order 4", RattleDef{4}},
        {"relaxation", RelaxationDef{1.0 / 960.0, 4}}};
    for (const double mass_kg : {1e-6, 1e6}) {
        for (const auto& [name, method] : methods) {
            cases.push_back({fmt::format("all masses {} kg", report::short_number(mass_kg)), name,
                             "moves like masses of 1 kg", false,
                             [=, method = method] { return same_masses(method, mass_kg); }});
        }
    }
    RopeDef rope = reference::straight_rope(6, 1.0, 45.0);
    for (std::size_t i = 0; i < rope.mass_kg.size(); ++i) rope.mass_kg[i] = i % 2 ? 1e-6 : 1e6;
    const Limits limits{0.02, 1e-9, 1e-6, 1000.0};
    constexpr const char* kMixed = "masses 1e-6 and 1e6 kg in turn, 0.02 s";
    add(kMixed, "exact", rope, ExactDef{1e-6}, limits, true, cases);
    add(kMixed, "rattle, order 8", rope, RattleDef{8}, limits, true, cases);
}

Outcome nearly_inverted(const MethodDef& method) {
    constexpr double kAngle = reference::kSwingPeriods.back().angle_deg;
    static_assert(kAngle == 179.99);
    constexpr double kQuarterSeconds =
        0.25 * reference::kSwingPeriods.back().ratio * reference::kSmallSwingSeconds;
    const double speed_m_s =
        std::sqrt(2.0 * reference::kGravity * (1.0 - std::cos(kAngle * std::numbers::pi / 180.0)));
    Probe probe(reference::straight_rope(1, 1.0, kAngle), WorldDef{}, method);
    probe.go(kQuarterSeconds);
    const double error = std::abs(probe.tip_m().x) / (speed_m_s * kQuarterSeconds);
    return {fmt::format("quarter period off by {:.1e}", error), error < 1e-6};
}

Outcome inverted(const MethodDef& method) {
    const RopeDef rope = reference::straight_rope(10, 1.0, 180.0);
    Probe probe(rope, WorldDef{}, method);
    probe.go_by_frames(10.0);
    double moved_m = 0.0;
    for (std::size_t i = 0; i < rope.points_m.size(); ++i) {
        moved_m = std::max(
            {moved_m, std::abs(probe.state().x_m[i]), std::abs(probe.state().y_m[i] - rope.points_m[i].y)});
    }
    return {fmt::format("moved by {:.1e} m in 10 s", moved_m), moved_m < 1e-12};
}

void add_inverted(std::vector<HardCase>& cases) {
    const auto add_nearly = [&](const char* name, const MethodDef& method) {
        cases.push_back({"pendulum from 179.99 deg", name, "R2's period to 1e-6", false,
                         [method] { return nearly_inverted(method); }});
    };
    add_nearly("exact", ExactDef{1e-13});
    add_nearly("rattle, order 8", RattleDef{8, 1.0 / 480.0});
    const auto add_exactly = [&](const char* name, const MethodDef& method) {
        cases.push_back({"exactly inverted, N = 10", name, "stays to 1e-12 m", false,
                         [method] { return inverted(method); }});
    };
    add_exactly("exact", ExactDef{1e-9});
    add_exactly("rattle, order 4", RattleDef{4});
}

}  // namespace

void add_hard_motions(std::vector<HardCase>& cases) {
    add_payloads(cases);
    add_releases(cases);
    add_throws(cases);
    add_masses(cases);
    add_inverted(cases);
}

}  // namespace corda::study
