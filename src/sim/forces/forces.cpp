#include "corda/sim/forces/forces.hpp"

#include <algorithm>
#include <cmath>

#include "corda/sim/distance.hpp"
#include "corda/sim/forces/drag.hpp"
#include "corda/sim/forces/gravity.hpp"

namespace corda::sim {
namespace {

constexpr ForceTerm (*kTerms[])(const WorldDef&) = {gravity, drag};

}  // namespace

Forces::Forces(const WorldDef& world) {
    for (const auto term_of : kTerms) {
        const ForceTerm term = term_of(world);
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
