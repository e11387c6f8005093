#include "corda/sim/forces/forces.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "corda/sim/defs.hpp"

namespace corda::sim {
namespace {

/// One row per force that does not change with time. A new one needs nothing else but its field of WorldDef
/// and its key.
constexpr ForceKind kForces[] = {
    // Gravity: the same acceleration for every mass.
    {.term =
         [](const WorldDef& world) {
             return ForceTerm{world.gravity_m_s2, 0.0};
         },
     .problem = [](const WorldDef& world) -> const char* {
         const Vec2 g = world.gravity_m_s2;
         return std::isfinite(g.x) && std::isfinite(g.y) ? nullptr : "gravity_m_s2 is not finite";
     },
     .text =
         [](const WorldDef& world) {
             const Vec2 g = world.gravity_m_s2;
             return g == Vec2{} ? "no gravity" : fmt::format("gravity of ({}, {}) m/s2", g.x, g.y);
         }},
    // Linear drag in still air: velocities alone decay by exp(-drag t).
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
};

}  // namespace

std::span<const ForceKind> force_kinds() {
    return kForces;
}

Forces::Forces(const WorldDef& world) {
    for (const ForceKind& kind : kForces) {
        const ForceTerm term = kind.term(world);
        sum_.uniform_m_s2 = sum_.uniform_m_s2 + term.uniform_m_s2;
        sum_.drag_1_s += term.drag_1_s;
    }
}

double Forces::strength_m_s2() const {
    return length(sum_.uniform_m_s2.x, sum_.uniform_m_s2.y);
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
        if (!system.is_pinned(i)) force_n[i] = system.mass_kg[i] * sum_.uniform_m_s2;
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
