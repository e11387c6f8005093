#include "corda/figures/summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace corda::figures {
namespace {

constexpr std::array<SummaryColumn, 9> kColumns{{{"period_s", &Summary::period_s},
                                                 {"angle_max_deg", &Summary::angle_max_deg},
                                                 {"tension_max_n", &Summary::tension_max_n},
                                                 {"speed_max_m_s", &Summary::speed_max_m_s},
                                                 {"strain_max", &Summary::strain_max},
                                                 {"energy_error", &Summary::energy_error},
                                                 {"error_estimate_m", &Summary::error_estimate_m},
                                                 {"error_estimate_px", &Summary::error_estimate_px},
                                                 {"horizon_s", &Summary::horizon_s}}};

/// The cubic polynomial of s, 0 .. 1, with these values and derivatives at its ends.
struct Cubic {
    double value0, slope0, value1, slope1;

    [[nodiscard]] double at(double s) const {
        const double rise = value1 - value0;
        return value0 +
               s * (slope0 + s * (3.0 * rise - 2.0 * slope0 - slope1 + s * (slope0 + slope1 - 2.0 * rise)));
    }
    [[nodiscard]] double slope_at(double s) const {
        const double rise = value1 - value0;
        return slope0 +
               s * (2.0 * (3.0 * rise - 2.0 * slope0 - slope1) + s * 3.0 * (slope0 + slope1 - 2.0 * rise));
    }
};

/// The place in 0 .. 1 where a function changes its sign. It does so between its ends.
template <class Function>
double root_of(const Function& function) {
    double low = 0.0;
    double high = 1.0;
    const bool rises = function(high) > 0.0;
    constexpr int kHalvings = 53;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        ((function(middle) > 0.0) == rises ? high : low) = middle;
    }
    return 0.5 * (low + high);
}

void include(std::optional<double>& largest, double value) {
    largest = std::max(largest.value_or(value), value);
}

}  // namespace

std::span<const SummaryColumn> summary_columns() {
    return kColumns;
}

SummaryReader::SummaryReader(Film& film) : film_(&film) {
    const auto tracked = pipeline::tracked_particles(film.system());
    if (!tracked.empty() && tracked.front().pin) tracked_ = tracked.front();
}

double SummaryReader::Arm::angle_rad() const {
    return std::atan2(x_m, -y_m);
}

double SummaryReader::Arm::rate_rad_s() const {
    return (x_m * vy_m_s - y_m * vx_m_s) / (x_m * x_m + y_m * y_m);
}

void SummaryReader::add(const State& state) {
    for (std::size_t i = 0; i < state.x_m.size(); ++i)
        include(summary_.speed_max_m_s,
                std::sqrt(state.vx_m_s[i] * state.vx_m_s[i] + state.vy_m_s[i] * state.vy_m_s[i]));
    for (const Body& body : film_->system().bodies)
        for (std::size_t k = 0; k < body.link_count; ++k)
            if (const double tension_n = std::abs(state.tension_n[body.first_bar + k]);
                !std::isnan(tension_n))
                include(summary_.tension_max_n, tension_n);
    if (!tracked_) return;
    const std::size_t i = tracked_->particle;
    const std::size_t pin = *tracked_->pin;
    add_arm({state.time_s, state.x_m[i] - state.x_m[pin], state.y_m[i] - state.y_m[pin], state.vx_m_s[i],
             state.vy_m_s[i]});
}

void SummaryReader::add_arm(const Arm& arm) {
    angle_max_rad_ = std::max(angle_max_rad_, std::abs(arm.angle_rad()));
    if (last_) {
        const double step_s = arm.time_s - last_->time_s;
        const double rate0 = last_->rate_rad_s();
        const double rate1 = arm.rate_rad_s();
        const double angle0 = last_->angle_rad();
        const double angle1 = arm.angle_rad();
        if (rate0 * rate1 < 0.0 && std::abs(angle1 - angle0) < 0.5 * std::numbers::pi) {
            const Cubic angle{angle0, step_s * rate0, angle1, step_s * rate1};
            const double turn = root_of([&](double s) { return angle.slope_at(s); });
            angle_max_rad_ = std::max(angle_max_rad_, std::abs(angle.at(turn)));
        }
        const bool crosses = (last_->x_m < 0.0) != (arm.x_m < 0.0) && last_->y_m < 0.0 && arm.y_m < 0.0;
        if (crosses) {
            const Cubic x{last_->x_m, step_s * last_->vx_m_s, arm.x_m, step_s * arm.vx_m_s};
            const double direction = arm.x_m < 0.0 ? -1.0 : 1.0;
            passes_s_.push_back(last_->time_s + step_s * root_of([&](double s) { return x.at(s); }));
            swings_ = swings_ && direction != last_direction_;
            last_direction_ = direction;
        }
    }
    last_ = arm;
}

Summary SummaryReader::summary() {
    if (tracked_) summary_.angle_max_deg = angle_max_rad_ * (180.0 / std::numbers::pi);
    if (passes_s_.size() > 1 && swings_)
        summary_.period_s =
            2.0 * (passes_s_.back() - passes_s_.front()) / static_cast<double>(passes_s_.size() - 1);
    const Figures& largest = film_->diagnostics().largest;
    summary_.strain_max = largest.strain;
    summary_.energy_error = largest.energy_error;
    summary_.error_estimate_m = film_->plan().error_estimate_m;
    summary_.error_estimate_px = film_->error_estimate_px();
    summary_.horizon_s = film_->plan().horizon_s;
    return summary_;
}

std::vector<double> SummaryReader::periods_s() const {
    std::vector<double> periods_s;
    for (std::size_t i = 2; swings_ && i < passes_s_.size(); ++i)
        periods_s.push_back(passes_s_[i] - passes_s_[i - 2]);
    return periods_s;
}

}  // namespace corda::figures
