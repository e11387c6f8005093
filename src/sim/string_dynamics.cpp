#include "corda/sim/string_dynamics.hpp"

#include <algorithm>
#include <cmath>

#include "corda/sim/distance.hpp"

namespace corda::sim {
namespace {

/// x, y, vx and vy.
constexpr std::size_t kLooseSize = 4;

/// The runs of taut links as bodies.
std::vector<Body> runs_of(const std::vector<std::uint8_t>& is_taut) {
    std::vector<Body> runs;
    bool goes_on = false;
    for (std::size_t k = 0; k < is_taut.size(); ++k) {
        if (is_taut[k] != 0) {
            if (!goes_on) {
                Body run;
                run.first_particle = run.first_bar = k;
                run.particle_count = 1;
                runs.push_back(run);
            }
            ++runs.back().particle_count;
            ++runs.back().bar_count;
            ++runs.back().link_count;
        }
        goes_on = is_taut[k] != 0;
    }
    return runs;
}

}  // namespace

StringDynamics::StringDynamics(const System& string, const std::vector<std::uint8_t>& is_taut,
                               const WorldDef& world)
    : gravity_m_s2_(world.gravity_m_s2),
      drag_1_s_(world.drag_1_s),
      runs_(string, runs_of(is_taut), world),
      link_count_(is_taut.size()),
      first_loose_(runs_.initial_state().size()),
      initial_state_(runs_.initial_state()) {
    double mass_kg = 0.0;
    for (std::size_t i = 0; i < string.particle_count(); ++i) {
        if (string.is_pinned(i)) continue;
        mass_kg += string.mass_kg[i];
        const bool is_held = (i > 0 && is_taut[i - 1] != 0) || (i < is_taut.size() && is_taut[i] != 0);
        if (!is_held) add_loose(string, i);
    }
    for (const Bar& bar : string.bars) length_m_ += bar.rest_m;
    energy_scale_j_ = mass_kg * length(gravity_m_s2_.x, gravity_m_s2_.y) * length_m_;
    const double rate = rate_1_s(string, is_taut);
    if (rate > 0.0) largest_rate_1_s_ = rate;
}

void StringDynamics::add_loose(const System& string, std::size_t particle) {
    loose_.push_back({particle, {string.x_m[particle], string.y_m[particle]}, string.mass_kg[particle]});
    initial_state_.insert(initial_state_.end(), {0.0, 0.0, string.vx_m_s[particle], string.vy_m_s[particle]});
}

double StringDynamics::rate_1_s(const System& string, const std::vector<std::uint8_t>& is_taut) const {
    double rate = runs_.link_count() > 0 ? runs_.largest_rate_1_s() : 0.0;
    const double gravity = length(gravity_m_s2_.x, gravity_m_s2_.y);
    for (std::size_t k = 0; k < is_taut.size(); ++k) {
        if (is_taut[k] != 0 || (string.is_pinned(k) && string.is_pinned(k + 1))) continue;
        // A slack link must not get past its rest length and back within a small part of a step.
        const double rest_m = string.bars[k].rest_m;
        const double speed_m_s =
            length(string.vx_m_s[k + 1] - string.vx_m_s[k], string.vy_m_s[k + 1] - string.vy_m_s[k]);
        rate = std::max({rate, speed_m_s / rest_m, std::sqrt(gravity / rest_m)});
    }
    return rate;
}

std::vector<ErrorScale> StringDynamics::error_scales() const {
    std::vector<ErrorScale> scales = runs_.error_scales();
    for (std::size_t i = 0; i < loose_.size(); ++i) {
        scales.push_back({first_loose_ + kLooseSize * i, 2, length_m_, 0.0});
        scales.push_back({first_loose_ + kLooseSize * i + 2, 2, length_m_ * largest_rate_1_s_, 1.0});
    }
    return scales;
}

void StringDynamics::derivative(const double* y, double* slope) {
    runs_.derivative(y, slope);
    for (std::size_t i = first_loose_; i < initial_state_.size(); i += kLooseSize) {
        slope[i] = y[i + 2];
        slope[i + 1] = y[i + 3];
        slope[i + 2] = gravity_m_s2_.x - drag_1_s_ * y[i + 2];
        slope[i + 3] = gravity_m_s2_.y - drag_1_s_ * y[i + 3];
    }
}

void StringDynamics::positions(const double* y, State& state) const {
    runs_.positions(y, state);
    const double* moved = y + first_loose_;
    for (const Loose& loose : loose_) {
        state.x_m[loose.particle] = loose.start_m.x + moved[0];
        state.y_m[loose.particle] = loose.start_m.y + moved[1];
        moved += kLooseSize;
    }
}

void StringDynamics::velocities(const double* y, std::vector<double>& vx_m_s,
                                std::vector<double>& vy_m_s) const {
    runs_.velocities(y, vx_m_s, vy_m_s);
    const double* moved = y + first_loose_;
    for (const Loose& loose : loose_) {
        vx_m_s[loose.particle] = moved[2];
        vy_m_s[loose.particle] = moved[3];
        moved += kLooseSize;
    }
}

double StringDynamics::energy_j(const double* y) const {
    double energy_j = runs_.energy_j(y);
    const double* moved = y + first_loose_;
    for (const Loose& loose : loose_) {
        const Vec2 velocity{moved[2], moved[3]};
        const Vec2 position = loose.start_m + Vec2{moved[0], moved[1]};
        energy_j += loose.mass_kg * (0.5 * dot(velocity, velocity) - dot(gravity_m_s2_, position));
        moved += kLooseSize;
    }
    return energy_j;
}

void StringDynamics::tensions(const double* y, std::vector<double>& tension_n) {
    runs_.tensions(y, run_tension_n_);
    tension_n.resize(link_count_);
    for (std::size_t k = 0; k < link_count_; ++k) {
        const ChainLink& link = runs_.link(k);
        tension_n[k] = link.moves ? run_tension_n_[link.index] : 0.0;
    }
}

}  // namespace corda::sim
