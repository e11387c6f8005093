#include "corda/sim/relaxation.hpp"

#include <cassert>
#include <cmath>
#include <utility>

#include "corda/sim/distance.hpp"

namespace corda::sim {
namespace {

/// A time within this share of a step of n steps is n steps: times that come from a fraction or from a decimal text
/// are rounded. The state there is the stored one, not an interpolated one.
constexpr double kGridTolerance = 1e-9;

}  // namespace

Relaxation::Relaxation(const System& system, const WorldDef& world, const SolverDef& def, double default_step_s)
    : step_s_(def.step_s.value_or(default_step_s)), sweeps_(def.sweeps), start_vx_m_s_(system.vx_m_s),
      start_vy_m_s_(system.vy_m_s), mass_kg_(system.mass_kg) {
    assert(step_s_ > 0.0 && sweeps_ >= 1);
    keep_ = (1.0 - def.delta) * std::exp(-world.drag_1_s * step_s_);
    const std::size_t count = system.particle_count();
    current_ = {system.x_m, system.y_m};
    previous_ = current_;
    older_ = current_;
    for (std::size_t i = 0; i < count; ++i) {
        const bool free = !system.is_pinned(i);
        const Vec2 weight = mass_kg_[i] * world.gravity_m_s2;
        const Vec2 force = free ? def.force_n.value_or(weight) : Vec2{};
        is_free_.push_back(free ? 1 : 0);
        force_x_n_.push_back(force.x);
        force_y_n_.push_back(force.y);
        push_x_m_.push_back(step_s_ * step_s_ / mass_kg_[i] * force.x);
        push_y_m_.push_back(step_s_ * step_s_ / mass_kg_[i] * force.y);
    }
    for (const Bar& bar : system.bars) {
        if (is_free_[bar.a] == 0 && is_free_[bar.b] == 0) continue;
        const double share_a = is_free_[bar.a] == 0 ? 0.0 : (is_free_[bar.b] == 0 ? 1.0 : 0.5);
        constraints_.push_back({bar.a, bar.b, bar.rest_m, share_a, 1.0 - share_a});
    }
    for (const RopeRange& rope : system.ropes) {
        double force_n = 0.0;
        double length_m = 0.0;
        for (std::size_t i = 0; i < rope.particle_count; ++i) {
            force_n += length(force_x_n_[rope.first_particle + i], force_y_n_[rope.first_particle + i]);
        }
        for (std::size_t i = 0; i < rope.link_count; ++i) length_m += system.bars[rope.first_bar + i].rest_m;
        energy_scale_j_ += force_n * length_m;
    }
}

void Relaxation::advance_to(double time_s, State& state) {
    const double steps = time_s / step_s_;
    const double nearest = std::round(steps);
    const bool on_grid = std::abs(steps - nearest) <= kGridTolerance * std::max(1.0, nearest);
    const auto target = static_cast<std::uint64_t>(on_grid ? nearest : std::ceil(steps));
    assert(step_ <= target);
    while (step_ < target) step();
    state.time_s = time_s;
    if (on_grid) {
        state.x_m = current_.x;
        state.y_m = current_.y;
    } else {
        interpolate(steps - std::floor(steps), state);
    }
}

void Relaxation::step() {
    if (step_ == 0) {
        euler_start();
    } else {
        verlet_update();
    }
    relax();
    ++step_;
}

void Relaxation::euler_start() {
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        if (is_free_[i] == 0) continue;
        current_.x[i] = previous_.x[i] + step_s_ * start_vx_m_s_[i];
        current_.y[i] = previous_.y[i] + step_s_ * start_vy_m_s_[i];
    }
}

void Relaxation::verlet_update() {
    std::swap(older_, previous_);
    std::swap(previous_, current_);
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        if (is_free_[i] == 0) continue;
        current_.x[i] = previous_.x[i] + keep_ * (previous_.x[i] - older_.x[i]) + push_x_m_[i];
        current_.y[i] = previous_.y[i] + keep_ * (previous_.y[i] - older_.y[i]) + push_y_m_[i];
    }
}

void Relaxation::relax() {
    for (int sweep = 0; sweep < sweeps_; ++sweep) relax_once();
}

void Relaxation::relax_once() {
    double* const x = current_.x.data();
    double* const y = current_.y.data();
    for (const Constraint& bar : constraints_) {
        const double dx = x[bar.b] - x[bar.a];
        const double dy = y[bar.b] - y[bar.a];
        const double distance = length(dx, dy);
        // Two particles in one place have no direction to be pushed along; other bars part them.
        if (distance == 0.0) continue;
        const double adjust = distance - bar.rest_m;
        const double move_x = dx / distance * adjust;
        const double move_y = dy / distance * adjust;
        x[bar.a] += bar.share_a * move_x;
        y[bar.a] += bar.share_a * move_y;
        x[bar.b] -= bar.share_b * move_x;
        y[bar.b] -= bar.share_b * move_y;
    }
}

void Relaxation::interpolate(double fraction, State& state) const {
    // Newton's form through the states at (step_ - 2), (step_ - 1) and step_; a straight line in the first step.
    const double second = step_ >= 2 ? 0.5 * fraction * (fraction - 1.0) : 0.0;
    const auto at = [&](double older, double previous, double current) {
        return previous + fraction * (current - previous) + second * (current - 2.0 * previous + older);
    };
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        state.x_m[i] = at(older_.x[i], previous_.x[i], current_.x[i]);
        state.y_m[i] = at(older_.y[i], previous_.y[i], current_.y[i]);
    }
}

double Relaxation::energy_j() const {
    // At the middle of the last step, where (current - previous) / h is the velocity to second order.
    double energy_j = 0.0;
    for (std::size_t i = 0; i < mass_kg_.size(); ++i) {
        if (is_free_[i] == 0) continue;
        const double vx = step_ == 0 ? start_vx_m_s_[i] : (current_.x[i] - previous_.x[i]) / step_s_;
        const double vy = step_ == 0 ? start_vy_m_s_[i] : (current_.y[i] - previous_.y[i]) / step_s_;
        energy_j += 0.5 * mass_kg_[i] * (vx * vx + vy * vy);
        energy_j -= 0.5 * force_x_n_[i] * (current_.x[i] + previous_.x[i]);
        energy_j -= 0.5 * force_y_n_[i] * (current_.y[i] + previous_.y[i]);
    }
    return energy_j;
}

double Relaxation::energy_scale_j() const { return energy_scale_j_; }

}  // namespace corda::sim
