#include "corda/study/swings.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>

#include "corda/sim/distance.hpp"
#include "corda/study/pendulum.hpp"
#include "corda/study/ropes.hpp"
#include "corda/study/truth.hpp"

namespace corda::study {
namespace {

constexpr double kForceNewtons = 9.8;
constexpr double kStepSeconds = 1.0 / 60.0;
constexpr double kPeriods = 2.0;
constexpr double kTruthTolerance = 1e-11;
constexpr double kSettledShare = 0.01;

Pendulum rod_of(int particles, double mass_kg) {
    const double spacing_m = sim::length(0.1, 1.0);
    return {rod_omega0_1_s(particles - 1, spacing_m, kForceNewtons / mass_kg), std::atan(0.1L)};
}

std::int64_t frames_of(int particles, double mass_kg) {
    return std::llround(kPeriods * rod_of(particles, mass_kg).period_s() / kStepSeconds);
}

sim::System system_of(const SwingDef& def) {
    sim::RopeDef rope = report_rope(def.particles);
    rope.mass_kg.assign(rope.points_m.size(), def.mass_kg);
    return sim::build_system({&rope, 1}, def.reach);
}

double strain_of(const sim::System& system, const sim::State& state) {
    double largest = 0.0;
    for (std::size_t k = 0; k < system.bodies.front().link_count; ++k) {
        const sim::Bar& bar = system.bars[k];
        const double now_m =
            sim::length(state.x_m[bar.b] - state.x_m[bar.a], state.y_m[bar.b] - state.y_m[bar.a]);
        largest = std::max(largest, std::abs(now_m / bar.rest_m - 1.0));
    }
    return largest;
}

/// RMS distance of the particles from `place(i)`, in metres.
double rms_m(const sim::State& state, const std::function<sim::Vec2(std::size_t)>& place) {
    double sum_m2 = 0.0;
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        const sim::Vec2 truth = place(i);
        const double dx = state.x_m[i] - truth.x;
        const double dy = state.y_m[i] - truth.y;
        sum_m2 += dx * dx + dy * dy;
    }
    return std::sqrt(sum_m2 / static_cast<double>(state.x_m.size()));
}

/// Energy of the start above that of hanging straight, in joules.
double swing_energy_j(int particles) {
    double sum_m = 0.0;
    for (int i = 0; i < particles; ++i) sum_m += i * (sim::length(0.1, 1.0) - 1.0);
    return kForceNewtons * sum_m;
}

}  // namespace

std::vector<sim::State> true_swing(int particles, double mass_kg) {
    SwingDef def;
    def.particles = particles;
    def.mass_kg = mass_kg;
    def.reach = 1;
    const sim::System system = system_of(def);
    sim::WorldDef world;
    world.gravity_m_s2 = {0.0, -kForceNewtons / mass_kg};
    const auto solver = sim::make_solver(system, world, sim::exact_solver(kTruthTolerance), kStepSeconds);
    std::vector<sim::State> frames;
    sim::State state{0.0, system.x_m, system.y_m};
    for (std::int64_t k = 1; k <= frames_of(particles, mass_kg); ++k) {
        if (solver->advance_to(static_cast<double>(k) * kStepSeconds, state) == sim::Status::kDiverged) break;
        frames.push_back(state);
    }
    return frames;
}

SwingFigures watch_swing(const SwingDef& def, const std::vector<sim::State>& truth) {
    const sim::System system = system_of(def);
    const Pendulum rod = rod_of(def.particles, def.mass_kg);
    const double length_m = sim::length(0.1, 1.0) * (def.particles - 1);
    sim::SolverDef method = sim::relaxation_solver(kStepSeconds, def.reach, def.sweeps);
    method.force_n = sim::Vec2{0.0, -kForceNewtons};
    const auto solver = sim::make_solver(system, sim::WorldDef{}, method, kStepSeconds);
    const double start_j = solver->energy_j();
    SwingFigures figures;
    sim::State state{0.0, system.x_m, system.y_m};
    sim::Vec2 last_tip_m{state.x_m.back(), state.y_m.back()};
    for (std::size_t k = 1; k <= truth.size(); ++k) {
        const double time_s = static_cast<double>(k) * kStepSeconds;
        if (solver->advance_to(time_s, state) == sim::Status::kDiverged ||
            !std::isfinite(state.x_m.back() + state.y_m.back())) {
            figures.failure = "diverged before " + std::to_string(time_s) + " s";
            return figures;
        }
        const sim::Vec2 tip_m{state.x_m.back(), state.y_m.back()};
        const sim::Vec2 moved_m = tip_m - last_tip_m;
        figures.tip_speed_m_s =
            std::max(figures.tip_speed_m_s, sim::length(moved_m.x, moved_m.y) / kStepSeconds);
        last_tip_m = tip_m;
        const sim::State& rope = truth[k - 1];
        const sim::Vec2 along = rod.direction(time_s);
        const auto on_rope = [&](std::size_t i) { return sim::Vec2{rope.x_m[i], rope.y_m[i]}; };
        const auto on_rod = [&](std::size_t i) {
            return length_m * static_cast<double>(i) / (def.particles - 1) * along;
        };
        figures.strain = std::max(figures.strain, strain_of(system, state));
        figures.rope_error = std::max(figures.rope_error, rms_m(state, on_rope) / length_m);
        figures.rod_error = std::max(figures.rod_error, rms_m(state, on_rod) / length_m);
    }
    figures.energy_lost = (start_j - solver->energy_j()) / (kPeriods * swing_energy_j(def.particles));
    return figures;
}

double updates_per_second(int particles, double shortest_s) {
    using Clock = std::chrono::steady_clock;
    constexpr int kTries = 5;
    constexpr int kStepsAtOnce = 64;
    SwingDef def;
    def.particles = particles;
    const sim::System system = system_of(def);
    sim::SolverDef method = sim::relaxation_solver(kStepSeconds, def.reach, def.sweeps);
    method.force_n = sim::Vec2{0.0, -kForceNewtons};
    double best = 0.0;
    for (int attempt = 0; attempt < kTries; ++attempt) {
        const auto solver = sim::make_solver(system, sim::WorldDef{}, method, kStepSeconds);
        sim::State state{0.0, system.x_m, system.y_m};
        const Clock::time_point from = Clock::now();
        double taken_s = 0.0;
        while (taken_s <= shortest_s) {
            const double time_s = static_cast<double>(solver->steps() + kStepsAtOnce) * kStepSeconds;
            if (solver->advance_to(time_s, state) == sim::Status::kDiverged) return 0.0;
            taken_s = std::chrono::duration<double>(Clock::now() - from).count();
        }
        best = std::max(best, static_cast<double>(solver->steps()) / taken_s);
    }
    return best;
}

double difference_under_gravity(double mass_kg, double other_mass_kg) {
    constexpr int kFrames = 600;
    SwingDef def;
    sim::WorldDef world;
    world.gravity_m_s2 = {0.0, -kForceNewtons};
    const sim::SolverDef method = sim::relaxation_solver(kStepSeconds, def.reach, def.sweeps);
    def.mass_kg = mass_kg;
    const sim::System system = system_of(def);
    def.mass_kg = other_mass_kg;
    const sim::System other_system = system_of(def);
    const auto solver = sim::make_solver(system, world, method, kStepSeconds);
    const auto other_solver = sim::make_solver(other_system, world, method, kStepSeconds);
    sim::State state{0.0, system.x_m, system.y_m};
    sim::State other = state;
    double largest_m = 0.0;
    for (int k = 1; k <= kFrames; ++k) {
        if (solver->advance_to(k * kStepSeconds, state) == sim::Status::kDiverged ||
            other_solver->advance_to(k * kStepSeconds, other) == sim::Status::kDiverged) {
            return std::numeric_limits<double>::infinity();
        }
        largest_m = std::max(largest_m, rms_m(state, [&](std::size_t i) {
                                 return sim::Vec2{other.x_m[i], other.y_m[i]};
                             }));
    }
    return largest_m / (sim::length(0.1, 1.0) * (def.particles - 1));
}

std::optional<double> settling_time_s(const sim::SolverDef& solver, double drag_1_s, double limit_s) {
    SwingDef def;
    def.reach = solver.reach;
    const sim::System system = system_of(def);
    sim::WorldDef world;
    world.gravity_m_s2 = {0.0, -kForceNewtons};
    world.drag_1_s = drag_1_s;
    const auto run = sim::make_solver(system, world, solver, kStepSeconds);
    const double length_m = sim::length(0.1, 1.0) * (def.particles - 1);
    sim::State state{0.0, system.x_m, system.y_m};
    double settled_s = 0.0;
    const std::int64_t frames = std::llround(limit_s / kStepSeconds);
    for (std::int64_t k = 1; k <= frames; ++k) {
        if (run->advance_to(static_cast<double>(k) * kStepSeconds, state) == sim::Status::kDiverged)
            return std::nullopt;
        double widest_m = 0.0;
        for (const double x_m : state.x_m) widest_m = std::max(widest_m, std::abs(x_m));
        if (!(widest_m <= kSettledShare * length_m)) settled_s = static_cast<double>(k + 1) * kStepSeconds;
    }
    // A swing that ends at the limit may be at its turning point's other side.
    const double period_s = rod_of(def.particles, 1.0).period_s();
    return settled_s <= limit_s - period_s ? std::optional(settled_s) : std::nullopt;
}

}  // namespace corda::study
