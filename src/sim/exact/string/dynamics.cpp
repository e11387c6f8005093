#include "corda/sim/exact/string/dynamics.hpp"

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
                               const Forces& forces)
    : forces_(forces),
      length_m_(links_length_m(string, string.bodies.front())),
      runs_(string, runs_of(is_taut), forces),
      first_loose_(runs_.initial_state().size()),
      initial_state_(runs_.initial_state()) {
    for (std::size_t i = 0; i < string.particle_count(); ++i) {
        if (string.is_pinned(i)) continue;
        const bool is_held = (i > 0 && is_taut[i - 1] != 0) || (i < is_taut.size() && is_taut[i] != 0);
        if (!is_held) add_loose(string, i);
    }
    const double fastest_1_s = inverse_timescale_of(string, is_taut);
    if (fastest_1_s > 0.0) inverse_timescale_1_s_ = fastest_1_s;
}

void StringDynamics::add_loose(const System& string, std::size_t particle) {
    loose_.push_back({particle, {string.x_m[particle], string.y_m[particle]}, string.mass_kg[particle]});
    initial_state_.insert(initial_state_.end(), {0.0, 0.0, string.vx_m_s[particle], string.vy_m_s[particle]});
}

double StringDynamics::inverse_timescale_of(const System& string,
                                            const std::vector<std::uint8_t>& is_taut) const {
    double fastest_1_s = runs_.link_count() > 0 ? runs_.inverse_timescale_1_s() : 0.0;
    for (std::size_t k = 0; k < is_taut.size(); ++k) {
        if (is_taut[k] != 0 || (string.is_pinned(k) && string.is_pinned(k + 1))) continue;
        // A slack link must not exceed its rest length and come back within a small part of a step.
        const double speed_m_s =
            length(string.vx_m_s[k + 1] - string.vx_m_s[k], string.vy_m_s[k + 1] - string.vy_m_s[k]);
        fastest_1_s = std::max(fastest_1_s, forces_.inverse_timescale_1_s(string.bars[k].rest_m, speed_m_s));
    }
    return fastest_1_s;
}

std::vector<ErrorScale> StringDynamics::error_scales() const {
    std::vector<ErrorScale> scales = runs_.error_scales();
    for (std::size_t i = 0; i < loose_.size(); ++i) {
        scales.push_back({first_loose_ + kLooseSize * i, 2, length_m_, 0.0});
        scales.push_back({first_loose_ + kLooseSize * i + 2, 2, length_m_ * inverse_timescale_1_s_, 1.0});
    }
    return scales;
}

void StringDynamics::derivative(const double* y, double* slope) {
    runs_.derivative(y, slope);
    const Vec2 uniform_m_s2 = forces_.uniform_m_s2();
    const double drag_1_s = forces_.drag_1_s();
    for (std::size_t i = first_loose_; i < initial_state_.size(); i += kLooseSize) {
        slope[i] = y[i + 2];
        slope[i + 1] = y[i + 3];
        slope[i + 2] = uniform_m_s2.x - drag_1_s * y[i + 2];
        slope[i + 3] = uniform_m_s2.y - drag_1_s * y[i + 3];
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
        energy_j += loose.mass_kg * (0.5 * dot(velocity, velocity) + forces_.potential_j_kg(position));
        moved += kLooseSize;
    }
    return energy_j;
}

}  // namespace corda::sim
