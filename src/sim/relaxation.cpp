#include "corda/sim/relaxation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "corda/core/error.hpp"
#include "corda/sim/distance.hpp"

namespace corda::sim {
namespace {

/// A time within this share of a step of n steps is n steps: times that come from a fraction or from a
/// decimal text are rounded. The state there is the stored one, not an interpolated one.
constexpr double kGridTolerance = 1e-9;

void refuse_materials(const System& system) {
    const bool plain =
        system.bends.empty() && std::all_of(system.bodies.begin(), system.bodies.end(), [](const Body& body) {
            return body.material.compliance_1_n == 0.0 && !body.material.is_string;
        });
    if (plain) return;
    throw Error(
        ExitCode::kInvalidScene,
        "method relaxation knows bars of one kind alone, as its source describes them; remove compliance, "
        "string and bending, or use method exact");
}

}  // namespace

Relaxation::Relaxation(const System& system, const WorldDef& world, const SolverDef& def,
                       double default_step_s)
    : step_s_(def.step_s.value_or(default_step_s)),
      sweeps_(def.sweeps),
      x_m_(system.x_m),
      y_m_(system.y_m),
      unrelaxed_x_m_(x_m_),
      unrelaxed_y_m_(y_m_),
      mass_kg_(system.mass_kg) {
    assert(step_s_ > 0.0 && sweeps_ >= 1);
    refuse_materials(system);
    keep_ = (1.0 - def.delta) * std::exp(-world.drag_1_s * step_s_);
    const std::size_t count = system.particle_count();
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2 weight = mass_kg_[i] * world.gravity_m_s2;
        const Vec2 force = system.is_pinned(i) ? Vec2{} : def.force_n.value_or(weight);
        force_x_n_.push_back(force.x);
        force_y_n_.push_back(force.y);
        push_x_m_.push_back(step_s_ * step_s_ / mass_kg_[i] * force.x);
        push_y_m_.push_back(step_s_ * step_s_ / mass_kg_[i] * force.y);
        move_x_m_.push_back(step_s_ * system.vx_m_s[i]);
        move_y_m_.push_back(step_s_ * system.vy_m_s[i]);
    }
    last_move_x_m_ = move_x_m_;
    last_move_y_m_ = move_y_m_;
    for (const Bar& bar : system.bars) {
        const bool a_is_pinned = system.is_pinned(bar.a);
        const bool b_is_pinned = system.is_pinned(bar.b);
        if (a_is_pinned && b_is_pinned) continue;
        const double share_a = a_is_pinned ? 0.0 : (b_is_pinned ? 1.0 : 0.5);
        constraints_.push_back({bar.a, bar.b, bar.rest_m, share_a, 1.0 - share_a});
    }
    for (const Body& body : system.bodies) {
        double force_n = 0.0;
        double length_m = 0.0;
        for (std::size_t i = 0; i < body.particle_count; ++i) {
            force_n += length(force_x_n_[body.first_particle + i], force_y_n_[body.first_particle + i]);
        }
        for (std::size_t i = 0; i < body.link_count; ++i) length_m += system.bars[body.first_bar + i].rest_m;
        energy_scale_j_ += force_n * length_m;
    }
}

Status Relaxation::advance_to(double time_s, State& state) {
    const double steps = time_s / step_s_;
    const double nearest = std::round(steps);
    const bool on_grid = std::abs(steps - nearest) <= kGridTolerance * std::max(1.0, nearest);
    const auto target = static_cast<std::uint64_t>(on_grid ? nearest : std::ceil(steps));
    assert(step_ <= target);
    while (step_ < target) step();
    state.time_s = time_s;
    if (on_grid) {
        state.x_m = x_m_;
        state.y_m = y_m_;
    } else {
        interpolate(steps - std::floor(steps), state);
    }
    return Status::kOk;
}

void Relaxation::step() {
    const std::size_t count = x_m_.size();
    // The first step is Euler's: its move, h v(0), is there from the start.
    if (step_ > 0) {
        std::swap(last_move_x_m_, move_x_m_);
        std::swap(last_move_y_m_, move_y_m_);
        for (std::size_t i = 0; i < count; ++i) {
            move_x_m_[i] = keep_ * last_move_x_m_[i] + push_x_m_[i];
            move_y_m_[i] = keep_ * last_move_y_m_[i] + push_y_m_[i];
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        x_m_[i] += move_x_m_[i];
        y_m_[i] += move_y_m_[i];
        unrelaxed_x_m_[i] = x_m_[i];
        unrelaxed_y_m_[i] = y_m_[i];
    }
    for (int sweep = 0; sweep < sweeps_; ++sweep) relax();
    for (std::size_t i = 0; i < count; ++i) {
        move_x_m_[i] += x_m_[i] - unrelaxed_x_m_[i];
        move_y_m_[i] += y_m_[i] - unrelaxed_y_m_[i];
    }
    ++step_;
}

void Relaxation::relax() {
    double* const x = x_m_.data();
    double* const y = y_m_.data();
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
    // Newton's form through the states at step_ - 2, step_ - 1 and step_; a straight line in the first step.
    const double second = step_ >= 2 ? 0.5 * fraction * (fraction - 1.0) : 0.0;
    const auto at = [&](double current, double move, double last_move) {
        return current - (1.0 - fraction) * move + second * (move - last_move);
    };
    for (std::size_t i = 0; i < x_m_.size(); ++i) {
        state.x_m[i] = at(x_m_[i], move_x_m_[i], last_move_x_m_[i]);
        state.y_m[i] = at(y_m_[i], move_y_m_[i], last_move_y_m_[i]);
    }
}

double Relaxation::energy_j() const {
    // At the middle of the last step, where move / h is the velocity to second order; at the start, at the
    // start.
    const double back = step_ == 0 ? 0.0 : 0.5;
    double energy_j = 0.0;
    for (std::size_t i = 0; i < x_m_.size(); ++i) {
        const double vx = move_x_m_[i] / step_s_;
        const double vy = move_y_m_[i] / step_s_;
        energy_j += 0.5 * mass_kg_[i] * (vx * vx + vy * vy);
        energy_j -= force_x_n_[i] * (x_m_[i] - back * move_x_m_[i]);
        energy_j -= force_y_n_[i] * (y_m_[i] - back * move_y_m_[i]);
    }
    return energy_j;
}

double Relaxation::energy_scale_j() const {
    return energy_scale_j_;
}

}  // namespace corda::sim
