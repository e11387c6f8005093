#include "corda/sim/exact/bar_dynamics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

/// Corrections of lengths end when the error of every squared length is below this share of it, a few
/// roundings, or stops shrinking. From the error of a step two to four are needed.
constexpr double kProjectedExcess = 4e-15;
constexpr int kMaxProjections = 8;
/// Velocities that are corrected with the matrix of the step's end before the correction are off by the
/// square of its error; the second time removes that.
constexpr int kVelocityCorrections = 2;

}  // namespace

BarDynamics::BarDynamics(const System& system, const Forces& forces)
    : count_(system.particle_count()), forces_(forces), mass_kg_(system.mass_kg) {
    assert(system.bodies.size() == 1);
    if (!system.bends.empty())
        throw Refusal(Refusal::Reason::kRigidGraph, "method exact bends no closed ropes of rigid links");
    constraints_ = make_constraint_solver(system);
    motion_ = Motion::start_of(system);
    multiplier_.resize(constraints_->links().size());
    if (constraints_->determines_tensions()) bar_of_link_ = bars_of_links(system, constraints_->bars());
    for (const auto* part : {&system.x_m, &system.y_m, &system.vx_m_s, &system.vy_m_s})
        initial_state_.insert(initial_state_.end(), part->begin(), part->end());
    for (const std::uint32_t i : constraints_->bars().held) {
        mass_kg_[i] = 0.0;
        initial_state_[2 * count_ + i] = initial_state_[3 * count_ + i] = 0.0;
    }
    const auto [left, right] = std::ranges::minmax(system.x_m);
    const auto [low, high] = std::ranges::minmax(system.y_m);
    size_m_ = (right - left) + (high - low);
    project(initial_state_.data());
    double fastest_m_s = 0.0;
    for (std::size_t i = 0; i < count_; ++i)
        fastest_m_s =
            std::max(fastest_m_s, length(initial_state_[2 * count_ + i], initial_state_[3 * count_ + i]));
    const double inverse_1_s = forces_.inverse_timescale_1_s(size_m_, fastest_m_s);
    if (inverse_1_s > 0.0) inverse_timescale_1_s_ = inverse_1_s;
}

std::vector<ErrorScale> BarDynamics::error_scales() const {
    return {{0, 2 * count_, size_m_, 0.0}, {2 * count_, 2 * count_, size_m_ * inverse_timescale_1_s_, 1.0}};
}

void BarDynamics::read(const double* y) {
    std::copy_n(y, count_, motion_.x_m.begin());
    std::copy_n(y + count_, count_, motion_.y_m.begin());
    std::copy_n(y + 2 * count_, count_, motion_.vx_m_s.begin());
    std::copy_n(y + 3 * count_, count_, motion_.vy_m_s.begin());
}

bool BarDynamics::find_multipliers(const double* y) {
    read(y);
    multiplier_ = loads(constraints_->bars(), motion_, forces_.uniform_m_s2());
    return constraints_->solve(motion_, multiplier_) && constraints_->had_full_rank();
}

void BarDynamics::apply(double* x, double* y) const {
    const std::vector<double>& inverse_mass = constraints_->bars().inverse_mass_1_kg;
    const std::span<const Link> links = constraints_->links();
    for (std::size_t k = 0; k < links.size(); ++k) {
        const auto [a, b, rest_m] = links[k];
        const Vec2 pull = multiplier_[k] * along(links[k], motion_);
        x[a] += inverse_mass[a] * pull.x;
        y[a] += inverse_mass[a] * pull.y;
        x[b] -= inverse_mass[b] * pull.x;
        y[b] -= inverse_mass[b] * pull.y;
    }
}

void BarDynamics::derivative(const double* y, double* slope) {
    double* const slope_vx = slope + 2 * count_;
    double* const slope_vy = slope + 3 * count_;
    if (!find_multipliers(y)) {
        std::fill_n(slope, 4 * count_, std::numeric_limits<double>::quiet_NaN());
        return;
    }
    const std::vector<double>& inverse_mass = constraints_->bars().inverse_mass_1_kg;
    const Vec2 uniform_m_s2 = forces_.uniform_m_s2();
    const double drag_1_s = forces_.drag_1_s();
    std::copy_n(y + 2 * count_, 2 * count_, slope);
    for (std::size_t i = 0; i < count_; ++i) {
        const double falls = inverse_mass[i] > 0.0 ? 1.0 : 0.0;
        slope_vx[i] = falls * uniform_m_s2.x - drag_1_s * slope[i];
        slope_vy[i] = falls * uniform_m_s2.y - drag_1_s * slope[count_ + i];
    }
    apply(slope_vx, slope_vy);
}

void BarDynamics::project(double* y) {
    read(y);
    const std::span<const Link> links = constraints_->links();
    const auto between = [&](const double* x, const Link& link) {
        return Vec2{x[link.b] - x[link.a], x[count_ + link.b] - x[count_ + link.a]};
    };
    double last = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMaxProjections; ++i) {
        double largest = 0.0;
        for (std::size_t k = 0; k < links.size(); ++k) {
            const Vec2 d = between(y, links[k]);
            const double square = links[k].rest_m * links[k].rest_m;
            multiplier_[k] = 0.5 * (dot(d, d) - square);
            largest = std::max(largest, std::abs(dot(d, d) - square) / square);
        }
        if (!(largest > kProjectedExcess && largest < last)) break;
        last = largest;
        if (!constraints_->solve(motion_, multiplier_)) return;
        apply(y, y + count_);
    }
    for (int i = 0; i < kVelocityCorrections; ++i) {
        for (std::size_t k = 0; k < links.size(); ++k)
            multiplier_[k] = dot(between(y, links[k]), between(y + 2 * count_, links[k]));
        if (!constraints_->solve(motion_, multiplier_)) return;
        apply(y + 2 * count_, y + 3 * count_);
    }
}

void BarDynamics::positions(const double* y, State& state) const {
    std::copy_n(y, count_, state.x_m.begin());
    std::copy_n(y + count_, count_, state.y_m.begin());
}

double BarDynamics::energy_j(const double* y) const {
    double energy_j = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
        const double vx = y[2 * count_ + i];
        const double vy = y[3 * count_ + i];
        energy_j += mass_kg_[i] * (0.5 * (vx * vx + vy * vy) + forces_.potential_j_kg({y[i], y[count_ + i]}));
    }
    return energy_j;
}

void BarDynamics::velocities(const double* y, State& state) const {
    std::copy_n(y + 2 * count_, count_, state.vx_m_s.begin());
    std::copy_n(y + 3 * count_, count_, state.vy_m_s.begin());
}

void BarDynamics::tensions(const double* y, std::vector<double>& tension_n) {
    std::fill(tension_n.begin(), tension_n.end(), std::numeric_limits<double>::quiet_NaN());
    if (bar_of_link_.empty() || !find_multipliers(y)) return;
    std::fill(tension_n.begin(), tension_n.end(), 0.0);  // of bars between two pins
    for (std::size_t k = 0; k < bar_of_link_.size(); ++k) {
        const Vec2 d = along(constraints_->links()[k], motion_);
        tension_n[bar_of_link_[k]] = multiplier_[k] * length(d.x, d.y);
    }
}

}  // namespace corda::sim
