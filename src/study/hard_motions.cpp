#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "corda/study/hard_cases.hpp"
#include "corda/study/probe.hpp"
#include "corda/study/ropes.hpp"
#include "corda/study/truth.hpp"

namespace corda::study {
namespace {

/// Runs by frames and holds the largest strain and energy error against their limits.
Outcome watch(const sim::RopeDef& rope, const sim::SolverDef& solver, double duration_s, double most_strain,
              double most_energy) {
    Probe probe(rope, sim::WorldDef{}, solver);
    probe.go_by_frames(duration_s);
    const sim::Figures largest = probe.diagnostics().largest;
    const double energy = largest.energy_error.value_or(std::numeric_limits<double>::infinity());
    return {fmt::format("strain {:.1e}, energy error {:.1e}", largest.strain, energy),
            largest.strain < most_strain && energy < most_energy};
}

void add_payloads(std::vector<HardCase>& cases) {
    constexpr double kDurationSeconds = 10.0;
    for (const double payload_kg : {1e3, 1e6}) {
        for (const double angle_deg : {45.0, 90.0}) {
            for (const int links : {10, 50}) {
                sim::RopeDef rope = straight_rope(links, 1.0, angle_deg);
                rope.payload_kg = payload_kg;
                const std::string name =
                    fmt::format("payload {:.0e} kg, {:g} deg, N = {}, 10 s", payload_kg, angle_deg, links);
                // A light rope under a heavy load moves some 1e4 times a second.
                const bool is_stiff = payload_kg > 1e5;
                cases.push_back(
                    {name, "exact", "strain < 1e-9, energy error < 1e-6", is_stiff,
                     [rope] { return watch(rope, sim::exact_solver(1e-7), kDurationSeconds, 1e-9, 1e-6); }});
                cases.push_back(
                    {name, "rope, order 6", "strain < 1e-9, energy error < 1e-3", is_stiff,
                     [rope] { return watch(rope, sim::rope_solver(6), kDurationSeconds, 1e-9, 1e-3); }});
            }
        }
    }
}

/// Links of 1 and 100 in turn, 1 m in all.
sim::RopeDef unequal_rope(double angle_deg) {
    const sim::RopeDef straight = straight_rope(1010, 1.01, angle_deg);
    std::vector<sim::Vec2> points_m = {straight.points_m.front()};
    for (std::size_t at = 0, i = 0; i < 20; ++i) points_m.push_back(straight.points_m[at += i % 2 ? 100 : 1]);
    return rope_through(std::move(points_m));
}

void add_releases(std::vector<HardCase>& cases) {
    cases.push_back(
        {"undamped from the horizontal, N = 50, 60 s", "exact, 1e-9", "energy error < 1e-6", true,
         [] { return watch(straight_rope(50, 1.0, 90.0), sim::exact_solver(1e-9), 60.0, 1e-9, 1e-6); }});
    for (const double angle_deg : {45.0, 90.0}) {
        const std::string name = fmt::format("links 1:100, {:g} deg, 10 s", angle_deg);
        constexpr const char* kBoth = "strain < 1e-12, energy error < 1e-8";
        const sim::RopeDef rope = unequal_rope(angle_deg);
        cases.push_back({name, "exact", kBoth, false,
                         [rope] { return watch(rope, sim::exact_solver(1e-9), 10.0, 1e-12, 1e-8); }});
        cases.push_back({name, "rope, order 8", kBoth, true,
                         [rope] { return watch(rope, sim::rope_solver(8), 10.0, 1e-12, 1e-8); }});
    }
}

/// Energy error over the energy at the start, which is motion for the most part.
Outcome throw_tip(const sim::SolverDef& solver) {
    constexpr double kSpeed = 100.0;  // m/s
    sim::RopeDef rope = straight_rope(10, 1.0, 0.0);
    rope.velocity_m_s.back() = {kSpeed, 0.0};
    const sim::System system = sim::build_system({&rope, 1}, 1);
    const auto run = sim::make_solver(system, sim::WorldDef{}, solver, 1.0 / 60.0);
    sim::State state{0.0, system.x_m, system.y_m};
    const double start_j = run->energy_j();
    double largest = 0.0;
    for (int k = 1; k <= 120; ++k) {
        if (run->advance_to(k / 60.0, state) == sim::Status::kDiverged) return {"diverged", false};
        largest = std::max(largest, std::abs(run->energy_j() - start_j) / std::abs(start_j));
    }
    return {fmt::format("relative energy error {:.1e}", largest), largest < 1e-6};
}

/// Three in turn; positions do not depend on a mass that all particles share.
Outcome same_masses(const sim::SolverDef& solver, double mass_kg) {
    const sim::RopeDef unit = straight_rope(10, 1.0, 45.0);
    sim::RopeDef rope = unit;
    rope.mass_kg.assign(rope.points_m.size(), mass_kg);
    Probe expected(unit, sim::WorldDef{}, solver);
    Probe probe(rope, sim::WorldDef{}, solver);
    expected.go_by_frames(2.0);
    probe.go_by_frames(2.0);
    const double apart_m =
        std::hypot(probe.tip_m().x - expected.tip_m().x, probe.tip_m().y - expected.tip_m().y);
    return {fmt::format("tip {:.1e} m from that of 1 kg after 2 s", apart_m), apart_m < 1e-9};
}

Outcome mixed_masses(const sim::SolverDef& solver) {
    sim::RopeDef rope = straight_rope(6, 1.0, 45.0);
    for (std::size_t i = 0; i < rope.mass_kg.size(); ++i) rope.mass_kg[i] = i % 2 ? 1e-6 : 1e6;
    Probe probe(rope, sim::WorldDef{}, solver);
    for (int k = 1; k <= 20; ++k) probe.go(1e-3 * k);
    const sim::Figures largest = probe.diagnostics().largest;
    const double energy = largest.energy_error.value_or(1.0);
    return {fmt::format("strain {:.1e}, energy error {:.1e} in 0.02 s", largest.strain, energy),
            largest.strain < 1e-9 && energy < 1e-6};
}

void add_throws_and_masses(std::vector<HardCase>& cases) {
    constexpr const char* kRelative = "relative energy error < 1e-6";
    cases.push_back({"tip thrown at 100 m/s, 2 s", "exact", kRelative, false,
                     [] { return throw_tip(sim::exact_solver(1e-9)); }});
    cases.push_back({"tip thrown at 100 m/s, 2 s", "rope, order 8", kRelative, true,
                     [] { return throw_tip(sim::rope_solver(8)); }});
    for (const double mass_kg : {1e-6, 1e6}) {
        const std::string name = fmt::format("all masses {:.0e} kg", mass_kg);
        constexpr const char* kWorks = "works: as 1 kg";
        cases.push_back(
            {name, "exact", kWorks, false, [=] { return same_masses(sim::exact_solver(1e-9), mass_kg); }});
        cases.push_back({name, "rope, order 4", kWorks, false,
                         [=] { return same_masses(sim::rope_solver(4), mass_kg); }});
        cases.push_back({name, "relaxation", kWorks, false,
                         [=] { return same_masses(sim::relaxation_solver(1.0 / 960.0, 1, 4), mass_kg); }});
    }
    constexpr const char* kInTurn = "masses 1e-6 and 1e6 kg in turn, 0.02 s";
    constexpr const char* kBoth = "strain < 1e-9, energy error < 1e-6";
    cases.push_back({kInTurn, "exact", kBoth, true, [] { return mixed_masses(sim::exact_solver(1e-6)); }});
    cases.push_back(
        {kInTurn, "rope, order 8", kBoth, true, [] { return mixed_masses(sim::rope_solver(8)); }});
}

Outcome nearly_inverted(const sim::SolverDef& solver) {
    constexpr double kAngle = kSwingPeriods.back().angle_deg;
    static_assert(kAngle == 179.99);
    constexpr double kQuarterSeconds = 0.25 * kSwingPeriods.back().ratio * kSmallSwingSeconds;
    const double speed_m_s = std::sqrt(2.0 * 9.81 * (1.0 - std::cos(kAngle * std::numbers::pi / 180.0)));
    Probe probe(straight_rope(1, 1.0, kAngle), sim::WorldDef{}, solver);
    probe.go(kQuarterSeconds);
    const double error = std::abs(probe.tip_m().x) / (speed_m_s * kQuarterSeconds);
    return {fmt::format("quarter period off by {:.1e}", error), error < 1e-6};
}

Outcome inverted(const sim::SolverDef& solver) {
    const sim::RopeDef rope = straight_rope(10, 1.0, 180.0);
    Probe probe(rope, sim::WorldDef{}, solver);
    probe.go_by_frames(10.0);
    double moved_m = 0.0;
    for (std::size_t i = 0; i < rope.points_m.size(); ++i) {
        moved_m = std::max(
            {moved_m, std::abs(probe.state().x_m[i]), std::abs(probe.state().y_m[i] - rope.points_m[i].y)});
    }
    return {fmt::format("moved by {:.1e} m in 10 s", moved_m), moved_m < 1e-12};
}

void add_inverted(std::vector<HardCase>& cases) {
    constexpr const char* kFolded = "folded by 180 deg (R7, N = 21), 1 s";
    constexpr const char* kEnergy = "strain < 1e-9, energy error < 1e-6";
    cases.push_back({kFolded, "exact", kEnergy, false,
                     [] { return watch(folded_rope(21), sim::exact_solver(1e-9), 1.0, 1e-9, 1e-6); }});
    cases.push_back({kFolded, "rope, order 8", kEnergy, false,
                     [] { return watch(folded_rope(21), sim::rope_solver(8), 1.0, 1e-9, 1e-6); }});
    constexpr const char* kR2 = "R2's period to 1e-6";
    constexpr const char* kName = "pendulum from 179.99 deg";
    cases.push_back({kName, "exact", kR2, false, [] { return nearly_inverted(sim::exact_solver(1e-13)); }});
    cases.push_back({kName, "rope, order 8", kR2, false,
                     [] { return nearly_inverted(sim::rope_solver(8, 1.0 / 480.0)); }});
    constexpr const char* kStays = "stays";
    cases.push_back({"exactly inverted, N = 10", "exact", kStays, false,
                     [] { return inverted(sim::exact_solver(1e-9)); }});
    cases.push_back({"exactly inverted, N = 10", "rope, order 4", kStays, false,
                     [] { return inverted(sim::rope_solver(4)); }});
}

}  // namespace

void add_hard_motions(std::vector<HardCase>& cases) {
    add_payloads(cases);
    add_releases(cases);
    add_throws_and_masses(cases);
    add_inverted(cases);
}

}  // namespace corda::study
