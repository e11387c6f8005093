#include "benchmark/study/swings.hpp"

#include <algorithm>
#include <cmath>

#include "benchmark/study/measure.hpp"
#include "benchmark/study/reference/pendulum.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "corda/core/basics.hpp"
#include "corda/sim/defs.hpp"

namespace corda::study {
namespace {

constexpr double kForceNewtons = 9.8;
constexpr double kStepSeconds = 1.0 / 60.0;

double length_m(int particles) {
    return sim::length(0.1, 1.0) * (particles - 1);
}

/// The rigid rod on which the force acts as gravity does.
reference::Pendulum rod_of(int particles, double mass_kg) {
    const double spacing_m = sim::length(0.1, 1.0);
    return {reference::rod_omega0_1_s(particles - 1, spacing_m, kForceNewtons / mass_kg), std::atan(0.1L)};
}

RopeDef rope_of(const SwingDef& def) {
    RopeDef rope = reference::report_rope(def.particles);
    rope.mass_kg.assign(rope.points_m.size(), def.mass_kg);
    rope.reach = def.reach;
    return rope;
}

RelaxationDef method_of(const SwingDef& def) {
    RelaxationDef method{kStepSeconds, def.sweeps};
    method.force_n = Vec2{0.0, -kForceNewtons};
    return method;
}

void watch(Probe& probe, const SwingDef& def, const std::vector<State>& truth, SwingFigures& figures) {
    const reference::Pendulum rod = rod_of(def.particles, def.mass_kg);
    const double total_m = length_m(def.particles);
    Vec2 last_tip_m = probe.tip_m();
    State on_rod = probe.state();
    for (const State& rope : truth) {
        probe.go(rope.time_s);
        const Vec2 moved_m = probe.tip_m() - last_tip_m;
        last_tip_m = probe.tip_m();
        figures.tip_speed_m_s =
            std::max(figures.tip_speed_m_s, sim::length(moved_m.x, moved_m.y) / kStepSeconds);
        const Vec2 along = rod.direction(rope.time_s);
        for (std::size_t i = 0; i < on_rod.x_m.size(); ++i) {
            const double radius_m = total_m * static_cast<double>(i) / (def.particles - 1);
            on_rod.x_m[i] = radius_m * along.x;
            on_rod.y_m[i] = radius_m * along.y;
        }
        figures.rope_error = std::max(figures.rope_error, rms_m(probe.state(), rope) / total_m);
        figures.rod_error = std::max(figures.rod_error, rms_m(probe.state(), on_rod) / total_m);
    }
    const Figures largest = probe.diagnostics().largest;
    figures.strain = largest.strain;
    figures.energy_error = largest.energy_error.value_or(0.0);
}

}  // namespace

std::vector<State> true_swing(int particles, double mass_kg) {
    constexpr double kPeriods = 2.0;
    constexpr double kTolerance = 1e-11;
    const WorldDef world{.gravity_m_s2 = {0.0, -kForceNewtons / mass_kg}};
    Probe probe(rope_of({particles, mass_kg, 1, 1}), world, ExactDef{kTolerance});
    std::vector<State> frames;
    const double duration_s = kPeriods * rod_of(particles, mass_kg).period_s();
    for (int k = 1; k * kStepSeconds <= duration_s; ++k) {
        probe.go(k * kStepSeconds);
        frames.push_back(probe.state());
    }
    return frames;
}

SwingFigures watch_swing(const SwingDef& def, const std::vector<State>& truth) {
    SwingFigures figures;
    try {
        Probe probe(rope_of(def), WorldDef{}, method_of(def));
        watch(probe, def, truth, figures);
    } catch (const Error& error) {
        figures.failure = error.what();
    }
    return figures;
}

double updates_per_second(const SwingDef& def, const Timing& timing) {
    Problem problem;
    problem.ropes = {rope_of(def)};
    problem.fps = FrameRate(Rational{1, 1});  // many steps per state that is read
    const Measurement run = measure(problem, method_of(def), "", kStepSeconds, timing);
    return 1e3 / (kStepSeconds * run.ms_per_simulated_s.median());
}

double difference_under_gravity(double mass_kg, double other_mass_kg) {
    constexpr int kFrames = 600;
    SwingDef def;
    const WorldDef world{.gravity_m_s2 = {0.0, -kForceNewtons}};
    const RelaxationDef method{kStepSeconds, def.sweeps};
    def.mass_kg = mass_kg;
    Probe probe(rope_of(def), world, method);
    def.mass_kg = other_mass_kg;
    Probe other(rope_of(def), world, method);
    double largest_m = 0.0;
    for (int k = 1; k <= kFrames; ++k) {
        probe.go(k * kStepSeconds);
        other.go(k * kStepSeconds);
        largest_m = std::max(largest_m, rms_m(probe.state(), other.state()));
    }
    return largest_m / length_m(def.particles);
}

std::optional<double> settling_time_s(const MethodDef& method, double drag_1_s, double limit_s) {
    constexpr double kSettledShare = 0.01;
    SwingDef def;
    if (!std::holds_alternative<RelaxationDef>(method)) def.reach = 1;
    const WorldDef world{.gravity_m_s2 = {0.0, -kForceNewtons}, .drag_1_s = drag_1_s};
    Probe probe(rope_of(def), world, method);
    double settled_s = 0.0;
    for (int k = 1; k * kStepSeconds <= limit_s; ++k) {
        probe.go(k * kStepSeconds);
        double widest_m = 0.0;
        for (const double x_m : probe.state().x_m) widest_m = std::max(widest_m, std::abs(x_m));
        if (widest_m > kSettledShare * length_m(def.particles)) settled_s = (k + 1) * kStepSeconds;
    }
    // In its last period before the limit the swing may only be on its way through the vertical.
    const double period_s = rod_of(def.particles, 1.0).period_s();
    return settled_s <= limit_s - period_s ? std::optional(settled_s) : std::nullopt;
}

}  // namespace corda::study
