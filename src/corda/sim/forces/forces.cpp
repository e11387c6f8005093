#include "corda/sim/forces/forces.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "corda/sim/cosine_sine.hpp"
#include "corda/sim/defs.hpp"

namespace corda::sim {
namespace {

/// One row per force. A new one needs nothing else but its field of WorldDef and its key.
constexpr ForceKind kForces[] = {
    // Gravity: the same acceleration for every mass.
    {.term =
         [](const WorldDef& world) {
             return ForceTerm{world.gravity_m_s2, 0.0};
         },
     .problem = [](const WorldDef& world) -> const char* {
         return is_finite(world.gravity_m_s2) ? nullptr : "gravity_m_s2 is not finite";
     },
     .text =
         [](const WorldDef& world) {
             const Vec2 g = world.gravity_m_s2;
             return g == Vec2{} ? "no gravity" : fmt::format("gravity of ({}, {}) m/s2", g.x, g.y);
         }},
    // Linear drag: in still air velocities alone decay by exp(-drag t).
    {.term =
         [](const WorldDef& world) {
             return ForceTerm{{}, world.drag_1_s};
         },
     .problem = [](const WorldDef& world) -> const char* {
         return world.drag_1_s >= 0.0 && std::isfinite(world.drag_1_s) ? nullptr : "drag_1_s is not >= 0";
     },
     .text =
         [](const WorldDef& world) {
             return world.drag_1_s == 0.0 ? "" : fmt::format("linear drag of {} 1/s, exact", world.drag_1_s);
         }},
    // Wind: moving air adds drag times its velocity.
    {.term =
         [](const WorldDef& world) {
             return ForceTerm{{}, 0.0, world.drag_1_s * world.wind_m_s};
         },
     .problem = [](const WorldDef& world) -> const char* {
         return is_finite(world.wind_m_s) ? nullptr : "wind_m_s is not finite";
     },
     .text =
         [](const WorldDef& world) {
             const Vec2 wind = world.wind_m_s;
             return wind == Vec2{} ? "" : fmt::format("wind of ({}, {}) m/s", wind.x, wind.y);
         }},
    {.term =
         [](const WorldDef& world) {
             ForceTerm term;
             TimeFunction gusts;
             gusts.add_wave(world.gusts);
             term.change_m_s2.add(world.drag_1_s, gusts);
             return term;
         },
     .problem = [](const WorldDef& world) -> const char* { return problem_of(world.gusts); },
     .text =
         [](const WorldDef& world) {
             const auto [by, frequency_hz, phase_deg] = world.gusts;
             return by == Vec2{} ? ""
                                 : fmt::format("gusts of ({}, {}) m/s at {} Hz", by.x, by.y, frequency_hz);
         }},
};

}  // namespace

std::span<const ForceKind> force_kinds() {
    return kForces;
}

bool is_finite(Vec2 v) {
    return std::isfinite(v.x) && std::isfinite(v.y);
}

const char* problem_of(const WaveDef& wave) {
    if (!is_finite(wave.amplitude) || !std::isfinite(wave.phase_deg)) return "a wave is not finite";
    const bool is_in_range = wave.frequency_hz > 0.0 && wave.frequency_hz <= WaveDef::kMaxFrequencyHz;
    return is_in_range ? nullptr : "frequency_hz is not within its range";
}

Forces::Forces(ForceTerm sum) : sum_(std::move(sum)) {
    measure();
}

Forces::Forces(const WorldDef& world) {
    for (const ForceKind& kind : kForces) {
        const ForceTerm term = kind.term(world);
        sum_.weight_m_s2 = sum_.weight_m_s2 + term.weight_m_s2;
        sum_.drag_1_s += term.drag_1_s;
        sum_.push_m_s2 = sum_.push_m_s2 + term.push_m_s2;
        sum_.change_m_s2.add(1.0, term.change_m_s2);
    }
    measure();
}

void Forces::measure() {
    uniform_m_s2_ = sum_.weight_m_s2 + sum_.push_m_s2;
    strength_m_s2_ = length(uniform_m_s2_.x, uniform_m_s2_.y) + sum_.change_m_s2.bound();
    set_time(0.0);
}

void Forces::expand(double time_s, double unit_s, std::span<Vec2> coefficients) const {
    sum_.change_m_s2.expand(zero_s_ + time_s, unit_s, coefficients);
    coefficients[0] = sum_.weight_m_s2 + sum_.push_m_s2 + coefficients[0];
}

Forces Forces::from(double time_s) const {
    Forces forces = *this;
    forces.zero_s_ += time_s;
    forces.set_time(0.0);
    return forces;
}

Forces Forces::until(double time_s) const {
    Forces forces = *this;
    forces.end_s_ = zero_s_ + time_s;
    return forces;
}

Forces Forces::seen_from(const TimeFunction& displacement) const {
    const TimeFunction velocity = displacement.derivative().from(-zero_s_);
    Forces forces = *this;
    forces.sum_.change_m_s2.add(-1.0, velocity.derivative());
    forces.sum_.change_m_s2.add(-sum_.drag_1_s, velocity);
    forces.measure();
    return forces;
}

Forces Forces::turned(Vec2 cosine_sine) const {
    Forces forces(ForceTerm{sim::turned(sum_.weight_m_s2, cosine_sine), sum_.drag_1_s,
                            sim::turned(sum_.push_m_s2, cosine_sine), sum_.change_m_s2.turned(cosine_sine)});
    forces.zero_s_ = zero_s_;
    forces.end_s_ = end_s_;
    return forces;
}

double Forces::decay(double time_s) const {
    double x = sum_.drag_1_s * time_s;
    if (x == 0.0) return 1.0;
    if (x > 700.0) return 0.0;
    // The series of exp(-x / 2^n), squared n times.
    int halvings = 0;
    while (std::abs(x) > 0.25) {
        x *= 0.5;
        ++halvings;
    }
    double sum = 1.0;
    for (int k = 12; k > 0; --k) sum = 1.0 - x / k * sum;
    for (; halvings > 0; --halvings) sum *= sum;
    return sum;
}

double Forces::inverse_timescale_1_s(double length_m, double speed_m_s) const {
    return std::max(std::sqrt(strength_m_s2() / length_m), speed_m_s / length_m);
}

std::vector<Vec2> Forces::on_particles(const System& system) const {
    std::vector<Vec2> force_n(system.particle_count());
    for (std::size_t i = 0; i < force_n.size(); ++i) {
        if (!system.stays_pinned(i)) force_n[i] = system.mass_kg[i] * sum_.weight_m_s2;
    }
    return force_n;
}

double energy_scale_j(const System& system, const std::vector<Vec2>& force_n) {
    double scale_j = 0.0;
    for (const Body& body : system.bodies) {
        double sum_n = 0.0;
        for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i)
            sum_n += length(force_n[i].x, force_n[i].y);
        scale_j += sum_n * links_length_m(system, body);
    }
    return scale_j;
}

}  // namespace corda::sim
