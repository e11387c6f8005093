#include "corda/sim/rattle/chain_constraints.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "corda/core/cancel.hpp"
#include "corda/sim/chain_tensions.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

/// Newton's method stops when the error of every squared length is below this share of it, far below the
/// rounding of the squares themselves. More than 1e-15 would be seen as strain.
constexpr double kSquareTolerance = 1e-16;
/// Two or three steps are normal. Where twenty do not suffice, more do not either.
constexpr int kMaxNewtonSteps = 20;
/// A chain between two pins counts as straight if the last pivot of its matrix is below this share of the
/// diagonal: angles of about 1e-6 radians. A straight chain leaves the square of rounding, 1e-32.
constexpr double kStraightPivot = 1e-12;
/// Particles that a stage moves per update of count_work(), with the forces of two bars that stretch each.
constexpr std::size_t kParticlesPerUpdate = 4;

}  // namespace

bool ChainConstraints::suits(std::span<const Bar> bars) {
    for (std::size_t k = 0; k < bars.size(); ++k) {
        const Bar& bar = bars[k];
        if (bar.b != bar.a + 1 || (k > 0 && bar.a <= bars[k - 1].a)) return false;
    }
    return true;
}

ChainConstraints::ChainConstraints(const System& system) : bars_(system, system.inverse_mass_1_kg) {
    assert(suits(rigid_bars(system)));
    std::size_t longest = 0;
    for (std::size_t k = 0; k < bars_.links.size(); ++k) {
        const Link& link = bars_.links[k];
        const bool goes_on = k > 0 && bars_.links[k - 1].b == link.a && !system.is_pinned(link.a);
        if (!goes_on) chains_.push_back({link.a, k, 0});
        square_m2_.push_back(link.rest_m * link.rest_m);
        longest = std::max(longest, ++chains_.back().count);
    }
    for (std::vector<double>* scratch : {&dx_m_, &dy_m_, &lower_, &diagonal_, &upper_, &right_})
        scratch->assign(longest + 2, 0.0);
    for (std::vector<double>* scratch :
         {&start_x_m_s_, &start_y_m_s_, &total_x_m_s_, &total_y_m_s_, &change_x_m_s_, &change_y_m_s_})
        scratch->assign(longest + 1, 0.0);
    refuse_straight_between_pins(system);
}

void ChainConstraints::refuse_straight_between_pins(const System& system) const {
    for (const Chain& chain : chains_) {
        const std::size_t last = chain.first_particle + chain.count;
        if (!system.is_pinned(chain.first_particle) || !system.is_pinned(last)) continue;
        InverseMassFraction fraction{0.0};
        for (std::size_t k = 1; k < chain.count; ++k) {
            const std::size_t i = chain.first_particle + k;
            const double weight = system.inverse_mass_1_kg[i];
            const double ax = system.x_m[i] - system.x_m[i - 1];
            const double ay = system.y_m[i] - system.y_m[i - 1];
            const double bx = system.x_m[i + 1] - system.x_m[i];
            const double by = system.y_m[i + 1] - system.y_m[i];
            const double cross = ax * by - ay * bx;
            const double square_sine = cross * cross / ((ax * ax + ay * ay) * (bx * bx + by * by));
            fraction.pass(weight, weight * weight * square_sine, fraction.divisor(weight));
        }
        if (fraction.p <= kStraightPivot * system.inverse_mass_1_kg[last - 1] * fraction.q) {
            throw Refusal(Refusal::Reason::kTautBetweenPins,
                          "the rope between particles " + std::to_string(chain.first_particle) + " and " +
                              std::to_string(last) +
                              " is pinned at both ends and straight: it cannot move, and its tension is not "
                              "determined");
        }
    }
}

void ChainConstraints::bar_vectors(const Chain& chain, const Motion& motion) {
    const double* const x = motion.x_m.data() + chain.first_particle;
    const double* const y = motion.y_m.data() + chain.first_particle;
    const double* const lost_x = motion.x_lost_m.data() + chain.first_particle;
    const double* const lost_y = motion.y_lost_m.data() + chain.first_particle;
    double* __restrict const dx = dx_m_.data() + 1;
    double* __restrict const dy = dy_m_.data() + 1;
    for (std::size_t k = 0; k < chain.count; ++k) {
        dx[k] = (x[k + 1] - x[k]) + (lost_x[k + 1] - lost_x[k]);
        dy[k] = (y[k + 1] - y[k]) + (lost_y[k + 1] - lost_y[k]);
    }
    dx[chain.count] = 0.0;
    dy[chain.count] = 0.0;
}

void ChainConstraints::assemble(const Chain& chain, double span_s, const Motion& motion) {
    const double* const vx = motion.vx_m_s.data() + chain.first_particle;
    const double* const vy = motion.vy_m_s.data() + chain.first_particle;
    const double* const w = bars_.inverse_mass_1_kg.data() + chain.first_particle;
    const double* const square = square_m2_.data() + chain.first_link;
    const double* const dx = dx_m_.data();
    const double* const dy = dy_m_.data();
    const double factor = 0.5 / span_s;
    for (std::size_t k = 0; k < chain.count; ++k) {
        // The bar at the end of the stage.
        const double ex = dx[k + 1] + span_s * (vx[k + 1] - vx[k]);
        const double ey = dy[k + 1] + span_s * (vy[k + 1] - vy[k]);
        right_[k + 1] = factor * (ex * ex + ey * ey - square[k]);
        lower_[k + 1] = -w[k] * (ex * dx[k] + ey * dy[k]);
        diagonal_[k + 1] = (w[k] + w[k + 1]) * (ex * dx[k + 1] + ey * dy[k + 1]);
        upper_[k + 1] = -w[k + 1] * (ex * dx[k + 2] + ey * dy[k + 2]);
    }
}

bool ChainConstraints::apply(const Chain& chain, double span_s, const double* impulse, Motion& motion) {
    double* __restrict const vx = motion.vx_m_s.data() + chain.first_particle;
    double* __restrict const vy = motion.vy_m_s.data() + chain.first_particle;
    const double* const w = bars_.inverse_mass_1_kg.data() + chain.first_particle;
    const double* const square = square_m2_.data() + chain.first_link;
    const double* const dx = dx_m_.data();
    const double* const dy = dy_m_.data();
    const double* const start_x = start_x_m_s_.data();
    const double* const start_y = start_y_m_s_.data();
    double* __restrict const total_x = total_x_m_s_.data();
    double* __restrict const total_y = total_y_m_s_.data();
    double* __restrict const cx = change_x_m_s_.data();
    double* __restrict const cy = change_y_m_s_.data();
    for (std::size_t i = 0; i <= chain.count; ++i) {
        cx[i] = w[i] * (impulse[i + 1] * dx[i + 1] - impulse[i] * dx[i]);
        cy[i] = w[i] * (impulse[i + 1] * dy[i + 1] - impulse[i] * dy[i]);
        total_x[i] += cx[i];
        total_y[i] += cy[i];
        vx[i] = start_x[i] + total_x[i];
        vy[i] = start_y[i] + total_y[i];
    }
    const double factor = span_s * span_s / kSquareTolerance;
    int all_met = 1;
    for (std::size_t k = 0; k < chain.count; ++k) {
        const double ux = cx[k + 1] - cx[k];
        const double uy = cy[k + 1] - cy[k];
        all_met &= static_cast<int>(factor * (ux * ux + uy * uy) <= square[k]);
    }
    return all_met != 0;
}

bool ChainConstraints::meet_lengths(const Chain& chain, double span_s, Motion& motion, double* impulse) {
    bar_vectors(chain, motion);
    const std::size_t particles = chain.count + 1;
    std::copy_n(motion.vx_m_s.data() + chain.first_particle, particles, start_x_m_s_.data());
    std::copy_n(motion.vy_m_s.data() + chain.first_particle, particles, start_y_m_s_.data());
    std::fill_n(total_x_m_s_.data(), particles, 0.0);
    std::fill_n(total_y_m_s_.data(), particles, 0.0);
    std::copy_n(impulse, chain.count, right_.data() + 1);
    right_[chain.count + 1] = 0.0;
    (void)apply(chain, span_s, right_.data(), motion);
    bool met = false;
    for (int i = 0; i < kMaxNewtonSteps && !met; ++i) {
        assemble(chain, span_s, motion);
        solve_tridiagonal(chain.count, lower_.data() + 1, diagonal_.data() + 1, upper_.data() + 1,
                          right_.data() + 1);
        for (std::size_t k = 0; k < chain.count; ++k) impulse[k] += right_[k + 1];
        met = apply(chain, span_s, right_.data(), motion);
    }
    if (!met) return false;
    add_total(chain, motion);
    // A bar that turns by an angle changes by |e - d|^2 = 2 rest_m^2 (1 - cos(angle)).
    const double* const vx = motion.vx_m_s.data() + chain.first_particle;
    const double* const vy = motion.vy_m_s.data() + chain.first_particle;
    const double factor = span_s * span_s / (2.0 * (1.0 - Stage::kMinTurnCosine));
    int all_gentle = 1;
    for (std::size_t k = 0; k < chain.count; ++k) {
        const double ux = vx[k + 1] - vx[k];
        const double uy = vy[k + 1] - vy[k];
        all_gentle &= static_cast<int>(factor * (ux * ux + uy * uy) <= square_m2_[chain.first_link + k]);
    }
    return all_gentle != 0;
}

void ChainConstraints::add_total(const Chain& chain, Motion& motion) const {
    double* __restrict const vx = motion.vx_m_s.data() + chain.first_particle;
    double* __restrict const vy = motion.vy_m_s.data() + chain.first_particle;
    double* __restrict const lost_x = motion.vx_lost_m_s.data() + chain.first_particle;
    double* __restrict const lost_y = motion.vy_lost_m_s.data() + chain.first_particle;
    for (std::size_t i = 0; i <= chain.count; ++i) {
        vx[i] = start_x_m_s_[i];
        vy[i] = start_y_m_s_[i];
        add_unrounded(vx[i], lost_x[i], total_x_m_s_[i]);
        add_unrounded(vy[i], lost_y[i], total_y_m_s_[i]);
    }
}

bool ChainConstraints::move(const Stage& stage, Motion& motion, std::span<double> impulse) {
    kick(bars_, stage, motion);
    count_work(1 + motion.x_m.size() / kParticlesPerUpdate + links().size());
    for (const Chain& chain : chains_) {
        if (!meet_lengths(chain, stage.span_s, motion, impulse.data() + chain.first_link)) return false;
    }
    drift(stage.span_s, motion);
    return true;
}

bool ChainConstraints::solve(const Motion& motion, std::span<double> right) {
    count_work(1 + links().size());
    bool is_finite = true;
    for (const Chain& chain : chains_) {
        const double* const w = bars_.inverse_mass_1_kg.data() + chain.first_particle;
        bar_vectors(chain, motion);
        const double* const dx = dx_m_.data();
        const double* const dy = dy_m_.data();
        for (std::size_t k = 0; k < chain.count; ++k) {
            right_[k + 1] = right[chain.first_link + k];
            lower_[k + 1] = -w[k] * (dx[k + 1] * dx[k] + dy[k + 1] * dy[k]);
            diagonal_[k + 1] = (w[k] + w[k + 1]) * (dx[k + 1] * dx[k + 1] + dy[k + 1] * dy[k + 1]);
            upper_[k + 1] = -w[k + 1] * (dx[k + 1] * dx[k + 2] + dy[k + 1] * dy[k + 2]);
        }
        solve_tridiagonal(chain.count, lower_.data() + 1, diagonal_.data() + 1, upper_.data() + 1,
                          right_.data() + 1);
        for (std::size_t k = 0; k < chain.count; ++k) {
            right[chain.first_link + k] = right_[k + 1];
            is_finite = is_finite && std::isfinite(right_[k + 1]);
        }
    }
    return is_finite;
}

double ChainConstraints::square_frequency(std::span<const double> multiplier) const {
    double largest = 0.0;
    for (const Chain& chain : chains_) {
        const double* const w = bars_.inverse_mass_1_kg.data() + chain.first_particle;
        double before = 0.0;
        for (std::size_t k = 0; k < chain.count; ++k) {
            const double here = std::abs(multiplier[chain.first_link + k]);
            const double bound = w[k] * (before + here);
            largest = largest > bound ? largest : bound;
            before = here;
        }
        largest = std::max(largest, w[chain.count] * before);
    }
    return 2.0 * largest;
}

std::vector<double> ChainConstraints::carried_mass(std::span<const double> mass_kg) const {
    std::vector<double> carried(bars_.links.size(), 0.0);
    for (const Chain& chain : chains_) {
        const bool first_is_pinned = bars_.inverse_mass_1_kg[chain.first_particle] == 0.0;
        const bool last_is_pinned = bars_.inverse_mass_1_kg[chain.first_particle + chain.count] == 0.0;
        double all_kg = 0.0;
        for (std::size_t i = first_is_pinned ? 1 : 0; i + (last_is_pinned ? 1 : 0) <= chain.count; ++i)
            all_kg += mass_kg[chain.first_particle + i];
        double before_kg = 0.0;  // free particles up to the link
        for (std::size_t k = 0; k < chain.count; ++k) {
            if (k > 0 || !first_is_pinned) before_kg += mass_kg[chain.first_particle + k];
            double& mass = carried[chain.first_link + k];
            if (first_is_pinned) mass = last_is_pinned ? all_kg : all_kg - before_kg;
            if (last_is_pinned && !first_is_pinned) mass = before_kg;
        }
    }
    return carried;
}

}  // namespace corda::sim
