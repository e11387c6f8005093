#include "corda/sim/exact/elastic_dynamics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "corda/sim/defs.hpp"

namespace corda::sim {
namespace {

/// Dop853 damps an oscillation of angular frequency omega for all omega h up to 5.9, where the modulus of its
/// stability function on the imaginary axis is at most 1. Only this bounds the steps of a motionless body;
/// with longer ones rounding would grow until the error control notices it.
constexpr double kStableOmegaH = 5.0;

/// The unit of errors of positions: the length of a rope, the diagonal of a net's bounding box.
double size_of(const System& system) {
    if (system.bodies.front().is_chain) return links_length_m(system, system.bodies.front());
    const auto extent = [](const std::vector<double>& x_m) {
        const auto [least, most] = std::ranges::minmax_element(x_m);
        return *most - *least;
    };
    return length(extent(system.x_m), extent(system.y_m));
}

}  // namespace

ElasticDynamics::ElasticDynamics(const System& system, const Forces& forces)
    : count_(system.particle_count()),
      origin_m_{system.x_m.front(), system.y_m.front()},
      forces_(forces),
      elastic_(system, 0, count_),
      moving_(moving_pins(system)),
      moved_m_(moving_.size()),
      size_m_(size_of(system)) {
    assert(system.bodies.size() == 1 && system.bodies.front().material.compliance_1_n > 0.0);
    initial_state_.resize(4 * count_);
    inverse_mass_1_kg_ = system.inverse_mass_1_kg;
    for (std::size_t i = 0; i < count_; ++i) {
        mass_kg_.push_back(system.is_pinned(i) ? 0.0 : system.mass_kg[i]);
        falls_.push_back(system.is_pinned(i) ? 0.0 : 1.0);
        if (system.is_pinned(i)) pins_.push_back({i, {system.x_m[i], system.y_m[i]}});
        initial_state_[i] = system.x_m[i] - origin_m_.x;
        initial_state_[count_ + i] = system.y_m[i] - origin_m_.y;
        if (system.is_pinned(i)) continue;
        initial_state_[2 * count_ + i] = system.vx_m_s[i];
        initial_state_[3 * count_ + i] = system.vy_m_s[i];
    }
    measure();
}

void ElasticDynamics::measure() {
    for (const double mass_kg : mass_kg_) energy_offset_j_ += mass_kg * forces_.potential_j_kg(origin_m_);
    const double* const y = initial_state_.data();
    std::vector<double> force_n(2 * count_, 0.0);
    frequency_1_s_ =
        std::sqrt(elastic_.add_forces({y, y + count_}, {force_n.data(), force_n.data() + count_}));
    double fastest_m_s = 0.0;
    double acceleration_m_s2 = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
        fastest_m_s = std::max(fastest_m_s, length(y[2 * count_ + i], y[3 * count_ + i]));
        acceleration_m_s2 =
            std::max(acceleration_m_s2, inverse_mass_1_kg_[i] * length(force_n[i], force_n[count_ + i]));
    }
    inverse_timescale_1_s_ = forces_.inverse_timescale_1_s(size_m_, fastest_m_s);
    if (inverse_timescale_1_s_ == 0.0) inverse_timescale_1_s_ = std::sqrt(acceleration_m_s2 / size_m_);
    if (inverse_timescale_1_s_ == 0.0) inverse_timescale_1_s_ = 1.0;
}

std::vector<ErrorScale> ElasticDynamics::error_scales() const {
    return {{0, 2 * count_, size_m_, 0.0}, {2 * count_, 2 * count_, size_m_ * inverse_timescale_1_s_, 1.0}};
}

double ElasticDynamics::inverse_stable_step_1_s() const {
    return frequency_1_s_ / kStableOmegaH;
}

void ElasticDynamics::set_time(double time_s) {
    forces_.set_time(time_s);
    time_s_ = time_s;
    for (std::size_t k = 0; k < moving_.size(); ++k) moved_m_[k] = moving_[k].displacement(time_s);
}

double ElasticDynamics::next_key_s(double time_s) const {
    return std::min(forces_.next_key_s(time_s), sim::next_key_s(moving_, time_s));
}

const double* ElasticDynamics::with_pins(const double* y) const {
    if (moving_.empty()) return y;
    place_m_.assign(y, y + 2 * count_);
    for (std::size_t k = 0; k < moving_.size(); ++k) {
        place_m_[moving_[k].particle] += moved_m_[k].x;
        place_m_[count_ + moving_[k].particle] += moved_m_[k].y;
    }
    return place_m_.data();
}

void ElasticDynamics::derivative(const double* y, double* slope) {
    double* __restrict const slope_vx = slope + 2 * count_;
    double* __restrict const slope_vy = slope + 3 * count_;
    const double* const vx = y + 2 * count_;
    const double* const vy = y + 3 * count_;
    std::copy_n(vx, 2 * count_, slope);
    std::fill_n(slope_vx, 2 * count_, 0.0);
    const double* const at = with_pins(y);
    elastic_.add_forces({at, at + count_}, {slope_vx, slope_vy});
    const double* const weight = inverse_mass_1_kg_.data();
    const double* const falls = falls_.data();
    const Vec2 uniform_m_s2 = forces_.uniform_m_s2();
    const double drag_1_s = forces_.drag_1_s();
    for (std::size_t i = 0; i < count_; ++i) {
        slope_vx[i] = falls[i] * uniform_m_s2.x + weight[i] * slope_vx[i] - drag_1_s * vx[i];
        slope_vy[i] = falls[i] * uniform_m_s2.y + weight[i] * slope_vy[i] - drag_1_s * vy[i];
    }
}

void ElasticDynamics::positions(const double* y, State& state) const {
    for (std::size_t i = 0; i < count_; ++i) {
        state.x_m[i] = origin_m_.x + y[i];
        state.y_m[i] = origin_m_.y + y[count_ + i];
    }
    for (const Pin& pin : pins_) {
        state.x_m[pin.particle] = pin.position_m.x;
        state.y_m[pin.particle] = pin.position_m.y;
    }
    for (std::size_t k = 0; k < moving_.size(); ++k) {
        state.x_m[moving_[k].particle] += moved_m_[k].x;
        state.y_m[moving_[k].particle] += moved_m_[k].y;
    }
}

double ElasticDynamics::energy_j(const double* y) const {
    const double* const at = with_pins(y);
    double energy_j = energy_offset_j_ + elastic_.energy_j(at, at + count_);
    for (std::size_t i = 0; i < count_; ++i) {
        const double vx = y[2 * count_ + i];
        const double vy = y[3 * count_ + i];
        energy_j += mass_kg_[i] * (0.5 * (vx * vx + vy * vy) + forces_.potential_j_kg({y[i], y[count_ + i]}));
    }
    return energy_j;
}

void ElasticDynamics::velocities(const double* y, State& state) const {
    std::copy_n(y + 2 * count_, count_, state.vx_m_s.begin());
    std::copy_n(y + 3 * count_, count_, state.vy_m_s.begin());
    for (const MovingPin& pin : moving_) {
        const Vec2 velocity_m_s = pin.velocity(time_s_);
        state.vx_m_s[pin.particle] = velocity_m_s.x;
        state.vy_m_s[pin.particle] = velocity_m_s.y;
    }
}

}  // namespace corda::sim
