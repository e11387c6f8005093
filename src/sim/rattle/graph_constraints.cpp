#include "corda/sim/rattle/graph_constraints.hpp"

#include <algorithm>
#include <cmath>

#include "corda/sim/refusal.hpp"

namespace corda::sim {
namespace {

/// Corrections end when no squared length is off by more than this share of it, a few roundings. Much less is
/// never reached; more would be seen as strain.
constexpr double kExcessTolerance = 4e-15;
/// Five to ten are normal. If it takes more than forty, the bars turn too far for the matrix.
constexpr int kMaxCorrections = 40;
/// Bars are refused as dependent if a pivot is below this share of its diagonal entry. Dependent bars leave
/// 1e-16 to 1e-14; a net that is only just determined, sagging by a part in 1e5, leaves 1e-10.
constexpr double kDependentPivot = 1e-12;

}  // namespace

GraphConstraints::GraphConstraints(const System& system, const GoesOn& goes_on) : ConstraintSolver(system) {
    dx_m_.assign(links_.size(), 0.0);
    dy_m_.assign(links_.size(), 0.0);
    load_.assign(system.particle_count(), 0.0);
    right_.setZero(static_cast<Eigen::Index>(links_.size()));
    analyse();
    StopCheck stop(goes_on);
    if (!factorise(Motion::start_of(system), stop)) {
        throw Refusal(
            Refusal::Reason::kDependentBars,
            "the lengths of rigid bars depend on each other, so that their tensions are not determined");
    }
}

void GraphConstraints::analyse() {
    std::vector<std::vector<std::uint32_t>> links_at(inverse_mass_1_kg_.size());
    std::vector<Eigen::Triplet<double>> triplets;
    for (std::uint32_t k = 0; k < links_.size(); ++k) {
        links_at[links_[k].a].push_back(k);
        links_at[links_[k].b].push_back(k);
    }
    for (std::uint32_t i = 0; i < links_at.size(); ++i) {
        const double weight = inverse_mass_1_kg_[i];
        for (const std::uint32_t row : links_at[i]) {
            for (const std::uint32_t column : links_at[i]) {
                if (row < column) continue;
                const bool same_end = (links_[row].b == i) == (links_[column].b == i);
                triplets.emplace_back(row, column, same_end ? weight : -weight);
            }
        }
    }
    const auto count = static_cast<Eigen::Index>(links_.size());
    matrix_.resize(count, count);
    matrix_.setFromTriplets(triplets.begin(), triplets.end());
    matrix_.makeCompressed();
    for (Eigen::Index column = 0; column < count; ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_, column); it; ++it) {
            entries_.push_back(
                {static_cast<std::uint32_t>(it.row()), static_cast<std::uint32_t>(column), it.value()});
        }
    }
    factors_.analyzePattern(matrix_);
}

bool GraphConstraints::factorise(const Motion& motion, StopCheck& stop) {
    bool is_new = !is_factorised_;
    for (std::size_t k = 0; k < links_.size(); ++k) {
        const auto [a, b, rest_m] = links_[k];
        const double dx_m = (motion.x_m[b] - motion.x_m[a]) + (motion.x_lost_m[b] - motion.x_lost_m[a]);
        const double dy_m = (motion.y_m[b] - motion.y_m[a]) + (motion.y_lost_m[b] - motion.y_lost_m[a]);
        is_new = is_new || dx_m != dx_m_[k] || dy_m != dy_m_[k];
        dx_m_[k] = dx_m;
        dy_m_[k] = dy_m;
    }
    if (!is_new) return true;
    is_factorised_ = false;
    double* const values = matrix_.valuePtr();
    for (std::size_t e = 0; e < entries_.size(); ++e) {
        const auto [row, column, factor] = entries_[e];
        values[e] = factor * (dx_m_[row] * dx_m_[column] + dy_m_[row] * dy_m_[column]);
    }
    if (!factors_.factorize(matrix_, stop)) return false;
    const auto& order = factors_.permutationP().indices();
    const auto pivots = factors_.vectorD();
    for (Eigen::Index k = 0; k < matrix_.cols(); ++k) {
        // Negated, so that a NaN fails.
        if (!(pivots[order[k]] > kDependentPivot * matrix_.coeff(k, k))) return false;
    }
    is_factorised_ = true;
    return true;
}

void GraphConstraints::apply(const double* impulse, Motion& motion) const {
    for (std::size_t k = 0; k < links_.size(); ++k) {
        const auto [a, b, rest_m] = links_[k];
        const double px = impulse[k] * dx_m_[k];
        const double py = impulse[k] * dy_m_[k];
        add_unrounded(motion.vx_m_s[a], motion.vx_lost_m_s[a], inverse_mass_1_kg_[a] * px);
        add_unrounded(motion.vy_m_s[a], motion.vy_lost_m_s[a], inverse_mass_1_kg_[a] * py);
        add_unrounded(motion.vx_m_s[b], motion.vx_lost_m_s[b], -inverse_mass_1_kg_[b] * px);
        add_unrounded(motion.vy_m_s[b], motion.vy_lost_m_s[b], -inverse_mass_1_kg_[b] * py);
    }
}

bool GraphConstraints::correct(double span_s, const Motion& motion) {
    bool met = true;
    for (std::size_t k = 0; k < links_.size(); ++k) {
        const auto [a, b, rest_m] = links_[k];
        const double ex = dx_m_[k] + span_s * (motion.vx_m_s[b] - motion.vx_m_s[a]);
        const double ey = dy_m_[k] + span_s * (motion.vy_m_s[b] - motion.vy_m_s[a]);
        const double square = rest_m * rest_m;
        const double excess = ex * ex + ey * ey - square;
        right_[static_cast<Eigen::Index>(k)] = 0.5 / span_s * excess;
        met = met && std::abs(excess) <= kExcessTolerance * square &&
              ex * dx_m_[k] + ey * dy_m_[k] >= Stage::kSmallestTurnCosine * square;
    }
    return met;
}

bool GraphConstraints::move(const Stage& stage, Motion& motion, std::span<double> impulse, StopCheck& stop) {
    kick(stage, motion);
    if (!factorise(motion, stop)) return false;
    apply(impulse.data(), motion);
    bool met = correct(stage.span_s, motion);
    for (int i = 0; i < kMaxCorrections && !met; ++i) {
        right_ = factors_.solve(right_);
        for (std::size_t k = 0; k < impulse.size(); ++k) impulse[k] += right_[static_cast<Eigen::Index>(k)];
        apply(right_.data(), motion);
        met = correct(stage.span_s, motion);
    }
    if (!met) return false;
    drift(stage.span_s, motion);
    return true;
}

bool GraphConstraints::solve(const Motion& motion, std::span<double> right, StopCheck& stop) {
    if (!factorise(motion, stop)) return false;
    std::copy(right.begin(), right.end(), right_.data());
    right_ = factors_.solve(right_);
    std::copy_n(right_.data(), right.size(), right.begin());
    return right_.allFinite();
}

double GraphConstraints::square_frequency(std::span<const double> multiplier) const {
    std::fill(load_.begin(), load_.end(), 0.0);
    for (std::size_t k = 0; k < links_.size(); ++k) {
        load_[links_[k].a] += std::abs(multiplier[k]);
        load_[links_[k].b] += std::abs(multiplier[k]);
    }
    double largest = 0.0;
    for (std::size_t i = 0; i < load_.size(); ++i)
        largest = std::max(largest, inverse_mass_1_kg_[i] * load_[i]);
    return 2.0 * largest;
}

std::vector<double> GraphConstraints::carried_mass(std::span<const double> mass_kg) const {
    double all_kg = 0.0;
    for (std::size_t i = 0; i < mass_kg.size(); ++i) {
        if (inverse_mass_1_kg_[i] > 0.0) all_kg += mass_kg[i];
    }
    return std::vector<double>(links_.size(), pinned_.empty() ? 0.0 : all_kg);
}

}  // namespace corda::sim
