#include "corda/sim/loose_particles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "corda/core/cancel.hpp"

namespace corda::sim {
namespace {

/// Terms of a series whose arguments are at most kArgument: the last are below a hundredth of a rounding.
constexpr std::size_t kTerms = 20;
constexpr double kArgument = 0.5;

}  // namespace

LooseParticles::LooseParticles(const System& system, const Forces& forces, const MethodDef& method)
    : Solver(0.0, false),
      forces_(forces),
      method_(method),
      pins_(moving_pins(system)),
      longest_s_(kArgument / std::max(forces.drag_1_s(), forces.frequency_1_s())) {
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        if (system.is_pinned(i)) continue;
        free_.push_back(
            {i, system.mass_kg[i], {system.x_m[i], system.y_m[i]}, {system.vx_m_s[i], system.vy_m_s[i]}});
    }
}

void LooseParticles::expand(double time_s) {
    time_s_ = time_s;
    const double unit_s = time_s - start_s_;
    std::array<Vec2, kTerms> push_m_s2;
    forces_.expand(start_s_, unit_s, push_m_s2);
    decay_ = 1.0;
    drift_s_ = 0.0;
    gain_m_s_ = fall_m_ = {};
    double decays = 1.0;  // the terms of this order
    Vec2 gains;
    for (std::size_t k = 0; k < kTerms; ++k) {
        const double share_s = unit_s / static_cast<double>(k + 1);
        drift_s_ += share_s * decays;
        fall_m_ = fall_m_ + share_s * gains;
        decays *= -share_s * forces_.drag_1_s();
        gains = share_s * (push_m_s2[k] - forces_.drag_1_s() * gains);
        decay_ += decays;
        gain_m_s_ = gain_m_s_ + gains;
    }
}

LooseParticles::Particle LooseParticles::moved(const Particle& from) const {
    return {from.index, from.mass_kg, from.at_m + (drift_s_ * from.velocity_m_s + fall_m_),
            decay_ * from.velocity_m_s + gain_m_s_};
}

Status LooseParticles::advance_to(double time_s, State& state) {
    if (!std::isfinite(time_s)) return Status::kDiverged;
    while (!free_.empty() && time_s > start_s_ + longest_s_) {
        count_work(1 + free_.size());
        expand(start_s_ + longest_s_);
        for (Particle& particle : free_) particle = moved(particle);
        if (!(time_s_ > start_s_)) return Status::kDiverged;
        start_s_ = time_s_;
        ++steps_;
    }
    expand(time_s);
    for (const Particle& particle : free_) {
        const Vec2 at_m = moved(particle).at_m;
        state.x_m[particle.index] = at_m.x;
        state.y_m[particle.index] = at_m.y;
    }
    for (const MovingPin& pin : pins_) {
        const Vec2 at_m = pin.place_m(time_s);
        state.x_m[pin.particle] = at_m.x;
        state.y_m[pin.particle] = at_m.y;
    }
    state.time_s = time_s;
    return Status::kOk;
}

double LooseParticles::energy_j() const {
    double energy_j = 0.0;
    for (const Particle& particle : free_) {
        const Particle now = moved(particle);
        energy_j +=
            now.mass_kg * (0.5 * dot(now.velocity_m_s, now.velocity_m_s) + forces_.potential_j_kg(now.at_m));
    }
    return energy_j;
}

void LooseParticles::velocities(State& state) {
    const auto write = [&](std::size_t i, Vec2 velocity_m_s) {
        state.vx_m_s[i] = velocity_m_s.x;
        state.vy_m_s[i] = velocity_m_s.y;
    };
    for (const Particle& particle : free_) write(particle.index, moved(particle).velocity_m_s);
    for (const MovingPin& pin : pins_) write(pin.particle, pin.velocity(time_s_));
}

bool LooseParticles::tensions(std::vector<double>& tension_n) {
    std::ranges::fill(tension_n, 0.0);
    return true;
}

}  // namespace corda::sim
