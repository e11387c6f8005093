#include "corda/sim/rattle/graph_constraints.hpp"

#include <algorithm>
#include <cmath>

#include "corda/core/cancel.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/rattle/constraint_solver.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

/// Products per update of count_work().
constexpr std::uint64_t kProductsPerUpdate = 64;

/// Corrections end when the error of every squared length is below this share of it, a few roundings. Much
/// less is never reached; more would show as strain.
constexpr double kExcessTolerance = 4e-15;
/// Five to ten corrections are normal. If forty do not suffice, the bars turn too far for the matrix.
constexpr int kMaxCorrections = 40;
/// Bars depend on each other if a pivot is below this share of its diagonal entry. Dependent bars leave 1e-16
/// to 1e-14; a net that is only just determined, sagging by a part in 1e5, leaves 1e-10.
constexpr double kDependentPivot = 1e-12;
/// Implied bars are found with all diagonal entries raised by this share, so that the elimination can
/// continue past one. A pivot is then this share times 1 + c^2, c being the coefficients by which the others
/// imply the bar: 2e-14 to 2e-11 in a grid of 200 x 200 with both diagonals, while independent bars leave
/// 3e-9.
constexpr double kRaise = 1e-14;
constexpr double kImpliedPivot = 1e-11;
/// Bars whose smallest pivot is below this share of its initial value are within about a hundredth of a
/// radian of a line in which they depend on each other.
constexpr double kNearLine = 1e-3;
/// From there, the full Newton method converges in five steps or not at all.
constexpr int kMaxCrossingSteps = 10;
/// At the line two motions branch, and the true one keeps its velocities. In a stage, relative velocities of
/// bars may change by this share of the fastest, and each Newton correction must shrink by kShrink, as it
/// does from a start that is ten times nearer to one branch than to the other.
constexpr double kCrossingChange = 0.05;
constexpr double kShrink = 0.1;
constexpr double kRoundedChange = 1e-11;
/// In a leap, all diagonal entries are raised by this share, so that undetermined directions do not change.
constexpr double kLeapRaise = 1e-10;
/// Largest relative error of an implied bar's squared length: rounding, magnified by the other bars.
constexpr double kImpliedTolerance = 1e-9;
/// Largest rate at which an implied bar may change its length, as a share of the largest squared speed at
/// which a bar turns. Bars that do not stay implied have a share near 1.
constexpr double kBendTolerance = 1e-5;

/// A bar's vector times the relative velocity of its ends, and the square of that velocity.
struct Rates {
    double along;
    double square;
};

Rates rates(const Link& link, const Motion& motion) {
    const double ux = motion.vx_m_s[link.b] - motion.vx_m_s[link.a];
    const double uy = motion.vy_m_s[link.b] - motion.vy_m_s[link.a];
    return {(motion.x_m[link.b] - motion.x_m[link.a]) * ux + (motion.y_m[link.b] - motion.y_m[link.a]) * uy,
            ux * ux + uy * uy};
}

void stand_still(Motion& motion) {
    for (auto* part : {&motion.vx_m_s, &motion.vy_m_s, &motion.vx_lost_m_s, &motion.vy_lost_m_s})
        std::fill(part->begin(), part->end(), 0.0);
}

}  // namespace

int StoppableLdlt::scatter(const Eigen::SparseMatrix<double>& upper, int k) {
    int top = static_cast<int>(upper.cols());
    row_[k] = 0.0;
    visited_by_[k] = k;
    for (Eigen::SparseMatrix<double>::InnerIterator it(upper, k); it; ++it) {
        int i = static_cast<int>(it.index());
        if (i > k) continue;
        row_[i] += it.value();
        int length = 0;
        for (; visited_by_[i] != k; i = m_parent[i]) {
            pattern_[length++] = i;
            visited_by_[i] = k;
        }
        while (length > 0) pattern_[--top] = pattern_[--length];
    }
    return top;
}

bool StoppableLdlt::factorize(const Eigen::SparseMatrix<double>& lower) {
    const int size = static_cast<int>(lower.cols());
    Eigen::SparseMatrix<double> upper(size, size);
    upper.selfadjointView<Eigen::Upper>() = lower.selfadjointView<Eigen::Lower>().twistedBy(m_P);
    row_.resize(size);
    pattern_.resize(size);
    visited_by_.resize(size);
    m_diag.resize(size);
    m_info = Eigen::NumericalIssue;
    const int* const begin = m_matrix.outerIndexPtr();
    int* const index = m_matrix.innerIndexPtr();
    double* const value = m_matrix.valuePtr();
    double* const row = row_.data();
    for (int k = 0; k < size; ++k) {
        int top = scatter(upper, k);
        m_nonZerosPerCol[k] = 0;
        std::uint64_t products = 0;
        double pivot = row[k];
        row[k] = 0.0;
        for (; top < size; ++top) {
            const int i = pattern_[top];
            const double entry = row[i];
            row[i] = 0.0;
            const double factor = entry / m_diag[i];
            const int end = begin[i] + m_nonZerosPerCol[i];
            for (int p = begin[i]; p < end; ++p) row[index[p]] -= value[p] * entry;
            pivot -= factor * entry;
            index[end] = k;
            value[end] = factor;
            products += static_cast<std::uint64_t>(++m_nonZerosPerCol[i]);
        }
        m_diag[k] = pivot;
        if (pivot == 0.0) return false;
        count_work(1 + products / kProductsPerUpdate);
    }
    m_info = Eigen::Success;
    m_factorizationIsOk = true;
    return true;
}

GraphConstraints::GraphConstraints(const System& system)
    : ConstraintSolver(system, inverse_masses_with_taut_rows_held(system)),
      holds_rows_(inverse_mass_1_kg_ != system.inverse_mass_1_kg) {
    load_.assign(system.particle_count(), 0.0);
    const Motion start = Motion::start_of(system);
    analyse();
    bool determined = is_regular(start);
    // Repeat without the raise: bars with large coefficients may hide one another.
    for (const double raise : {kRaise, 0.0, 0.0}) {
        if (determined) break;
        leave_out_implied(start, raise);
        determined = is_regular(start) && (is_rigid() || stay_implied(start));
    }
    if (determined) {
        near_line_ = kNearLine * smallest_pivot_;
        if (is_rigid()) plate_ = plate_of(system);
        return;
    }
    throw Refusal(Refusal::Reason::kDependentBars,
                  "the lengths of rigid bars depend on each other at the start, but not in the motion that "
                  "follows");
}

void GraphConstraints::leave_out_implied(const Motion& start, double raise) {
    if (!factorise(start, raise)) return;
    const auto& order = factors_.permutationP().indices();
    const auto pivots = factors_.vectorD();
    std::vector<Link> kept;
    for (std::size_t k = 0; k < links_.size(); ++k) {
        const auto column = static_cast<Eigen::Index>(k);
        const bool is_implied = !(pivots[order[column]] > kImpliedPivot * matrix_.coeff(column, column));
        (is_implied ? implied_ : kept).push_back(links_[k]);
    }
    links_ = std::move(kept);
    analyse();
}

bool GraphConstraints::is_rigid() const {
    const std::size_t freedoms = 2 * (inverse_mass_1_kg_.size() - held_.size()) - links_.size();
    return freedoms == (held_.empty() ? 3 : held_.size() == 1 ? 1 : 0);
}

GraphConstraints::Plate GraphConstraints::plate_of(const System& system) const {
    if (held_.size() > 1) return {HUGE_VAL, 0.0};  // nothing turns it
    const std::size_t count = system.particle_count();
    Plate plate;
    double mass_kg = 0.0;
    Vec2 moment;
    for (std::size_t i = 0; i < count; ++i) {
        mass_kg += system.mass_kg[i];
        moment = moment + system.mass_kg[i] * Vec2{system.x_m[i], system.y_m[i]};
    }
    const Vec2 center = (1.0 / mass_kg) * moment;
    const Vec2 pivot = held_.empty() ? center : Vec2{system.x_m[held_.front()], system.y_m[held_.front()]};
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2 arm = Vec2{system.x_m[i], system.y_m[i]} - pivot;
        plate.inertia_kg_m2 += system.mass_kg[i] * dot(arm, arm);
    }
    const Vec2 lever = center - pivot;
    plate.lever_kg_m = mass_kg * length(lever.x, lever.y);
    return plate;
}

bool GraphConstraints::stay_implied(Motion motion) {
    // The change of an implied bar's length in a motion that keeps the others to second order is a quadratic
    // form of the velocities: if it is 0 for generic velocities, it is always 0.
    std::uint32_t order = 1;
    const auto any = [&order](double weight) {
        order = order * 1664525U + 1013904223U;
        return weight > 0.0 ? static_cast<double>(order) / 2147483648.0 - 1.0 : 0.0;
    };
    for (std::size_t i = 0; i < inverse_mass_1_kg_.size(); ++i) {
        motion.vx_m_s[i] = any(inverse_mass_1_kg_[i]);
        motion.vy_m_s[i] = any(inverse_mass_1_kg_[i]);
    }
    // Changes them so that no link turns into `along`, twice to remove the rounding of the first time: a
    // large plate leaves next to nothing of them.
    std::vector<double> along(links_.size(), 0.0);
    std::vector<double> pull(links_.size());
    const auto meet = [&] {
        for (int i = 0; i < 2; ++i) {
            for (std::size_t k = 0; k < links_.size(); ++k)
                pull[k] = rates(links_[k], motion).along - along[k];
            if (!solve(motion, pull)) return false;
            apply(pull.data(), motion);
        }
        return true;
    };
    if (!meet()) return false;
    const double largest = largest_square(motion);
    for (std::size_t k = 0; k < links_.size(); ++k) along[k] = -rates(links_[k], motion).square;
    std::vector<double> bends;
    for (const Link& link : implied_) {
        const auto [turn, square] = rates(link, motion);
        if (!(std::abs(turn) <= kBendTolerance * link.rest_m * std::sqrt(largest))) return false;
        bends.push_back(square);
    }
    stand_still(motion);  // from here on accelerations in the place of velocities
    if (!meet()) return false;
    for (std::size_t k = 0; k < implied_.size(); ++k) {
        if (!(std::abs(bends[k] + rates(implied_[k], motion).along) <= kBendTolerance * largest))
            return false;
    }
    return true;
}

bool GraphConstraints::meet_implied(const Motion& motion) const {
    return std::ranges::all_of(implied_, [&motion](const Link& link) {
        const double dx = motion.x_m[link.b] - motion.x_m[link.a];
        const double dy = motion.y_m[link.b] - motion.y_m[link.a];
        const double square = link.rest_m * link.rest_m;
        return std::abs(dx * dx + dy * dy - square) <= kImpliedTolerance * square;
    });
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
    dx_m_.assign(links_.size(), 0.0);
    dy_m_.assign(links_.size(), 0.0);
    right_.setZero(count);
    entries_.clear();
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
    is_factorised_ = false;
    crossing_.resize(0, 0);
}

bool GraphConstraints::factorise(const Motion& motion, double raise) {
    bool is_new = !is_factorised_ || raise != raise_;
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
    if (raise > 0.0) matrix_.diagonal() *= 1.0 + raise;
    if (!factors_.factorize(matrix_)) return false;
    is_factorised_ = true;
    raise_ = raise;
    return true;
}

bool GraphConstraints::is_regular(const Motion& motion) {
    smallest_pivot_ = 0.0;
    if (!factorise(motion, 0.0)) return false;
    const auto& order = factors_.permutationP().indices();
    const auto pivots = factors_.vectorD();
    double smallest = 1.0;
    for (Eigen::Index k = 0; k < matrix_.cols(); ++k) {
        const double pivot = pivots[order[k]] / matrix_.coeff(k, k);
        if (!(pivot > kDependentPivot)) return false;  // negated, so that a NaN fails
        smallest = std::min(smallest, pivot);
    }
    smallest_pivot_ = smallest;
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
              ex * dx_m_[k] + ey * dy_m_[k] >= Stage::kMinTurnCosine * square;
    }
    return met;
}

bool GraphConstraints::move(const Stage& stage, Motion& motion, std::span<double> impulse) {
    kick(stage, motion);
    if (!is_regular(motion) || smallest_pivot_ < near_line_) {
        if (!cross(stage.span_s, motion, impulse)) return false;
    } else {
        apply(impulse.data(), motion);
        bool met = correct(stage.span_s, motion);
        for (int i = 0; i < kMaxCorrections && !met; ++i) {
            right_ = factors_.solve(right_);
            for (std::size_t k = 0; k < impulse.size(); ++k)
                impulse[k] += right_[static_cast<Eigen::Index>(k)];
            apply(right_.data(), motion);
            met = correct(stage.span_s, motion);
        }
        if (!met) return false;
    }
    drift(stage.span_s, motion);
    return meet_implied(motion);
}

bool GraphConstraints::tells_tensions() const {
    return smallest_pivot_ >= near_line_;
}

bool GraphConstraints::cross(double span_s, Motion& motion, std::span<double> impulse) {
    std::fill(impulse.begin(), impulse.end(), 0.0);
    if (crossing_.rows() == 0) {
        crossing_ = matrix_.selfadjointView<Eigen::Lower>();
        crossing_factors_.analyzePattern(crossing_);
    }
    const auto couple = [&](std::uint32_t row, std::uint32_t column, double factor) {
        const auto [a, b, rest_m] = links_[row];
        const double ex = dx_m_[row] + span_s * (motion.vx_m_s[b] - motion.vx_m_s[a]);
        const double ey = dy_m_[row] + span_s * (motion.vy_m_s[b] - motion.vy_m_s[a]);
        crossing_.coeffRef(row, column) = factor * (ex * dx_m_[column] + ey * dy_m_[column]);
    };
    const double fastest = std::sqrt(largest_square(motion));
    Motion last = motion;
    double last_change = kCrossingChange / kShrink * fastest;
    bool met = correct(span_s, motion);
    for (int i = 0; i < kMaxCrossingSteps && !met; ++i) {
        count_work(kUpdatesPerCheck);
        for (const auto& [row, column, factor] : entries_) {
            couple(row, column, factor);
            if (row != column) couple(column, row, factor);
        }
        crossing_factors_.factorize(crossing_);
        if (crossing_factors_.info() != Eigen::Success) return false;
        right_ = crossing_factors_.solve(right_);
        for (std::size_t k = 0; k < impulse.size(); ++k) impulse[k] += right_[static_cast<Eigen::Index>(k)];
        apply(right_.data(), motion);
        double change = 0.0;
        for (const auto& [a, b, rest_m] : links_) {
            const double ux = (motion.vx_m_s[b] - motion.vx_m_s[a]) - (last.vx_m_s[b] - last.vx_m_s[a]);
            const double uy = (motion.vy_m_s[b] - motion.vy_m_s[a]) - (last.vy_m_s[b] - last.vy_m_s[a]);
            change = std::max(change, std::sqrt(ux * ux + uy * uy));
        }
        if (!(change <= kShrink * std::max(last_change, kRoundedChange * fastest))) return false;
        last = motion;
        last_change = change;
        met = correct(span_s, motion);
    }
    return met;
}

bool GraphConstraints::leap(double span_s, Motion& motion) {
    drift(span_s, motion);
    const Motion ahead = motion;
    double largest = HUGE_VAL;
    for (int i = 0; i < kMaxCorrections && largest > kExcessTolerance; ++i) {
        if (!factorise(motion, kLeapRaise)) return false;
        largest = 0.0;
        for (std::size_t k = 0; k < links_.size(); ++k) {
            const double square = links_[k].rest_m * links_[k].rest_m;
            const double excess = dx_m_[k] * dx_m_[k] + dy_m_[k] * dy_m_[k] - square;
            right_[static_cast<Eigen::Index>(k)] = 0.5 * excess;
            largest = std::max(largest, std::abs(excess) / square);
        }
        right_ = factors_.solve(right_);
        stand_still(motion);
        apply(right_.data(), motion);
        drift(1.0, motion);
    }
    if (!(largest <= kImpliedTolerance) || !meet_implied(motion)) return false;
    motion.vx_m_s = ahead.vx_m_s;
    motion.vy_m_s = ahead.vy_m_s;
    motion.vx_lost_m_s = ahead.vx_lost_m_s;
    motion.vy_lost_m_s = ahead.vy_lost_m_s;
    if (!factorise(motion, kLeapRaise)) return false;
    for (std::size_t k = 0; k < links_.size(); ++k)
        right_[static_cast<Eigen::Index>(k)] = rates(links_[k], motion).along;
    right_ = factors_.solve(right_);
    apply(right_.data(), motion);
    return right_.allFinite();
}

double GraphConstraints::largest_square(const Motion& motion) const {
    double largest = 0.0;
    for (const Link& link : links_) largest = std::max(largest, rates(link, motion).square);
    return largest;
}

bool GraphConstraints::solve(const Motion& motion, std::span<double> right) {
    if (!is_regular(motion) && !factorise(motion, kLeapRaise)) return false;
    std::copy(right.begin(), right.end(), right_.data());
    right_ = factors_.solve(right_);
    std::copy_n(right_.data(), right.size(), right.begin());
    return right_.allFinite();
}

double GraphConstraints::square_frequency(std::span<const double> multiplier) const {
    if (plate_) {
        double pull_j = 0.0;
        for (std::size_t k = 0; k < links_.size(); ++k)
            pull_j += multiplier[k] * links_[k].rest_m * links_[k].rest_m;
        return std::abs(pull_j) / plate_->inertia_kg_m2;
    }
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

double GraphConstraints::expected_square_frequency(const System& system, double acceleration_m_s2,
                                                   std::span<const double> multiplier) const {
    if (!plate_) return ConstraintSolver::expected_square_frequency(system, acceleration_m_s2, multiplier);
    const double hanging = acceleration_m_s2 * plate_->lever_kg_m / plate_->inertia_kg_m2;
    return std::max(hanging, 2.0 * square_frequency(multiplier));
}

std::vector<double> GraphConstraints::carried_mass(std::span<const double> mass_kg) const {
    double all_kg = 0.0;
    for (std::size_t i = 0; i < mass_kg.size(); ++i) {
        if (inverse_mass_1_kg_[i] > 0.0) all_kg += mass_kg[i];
    }
    return std::vector<double>(links_.size(), held_.empty() ? 0.0 : all_kg);
}

}  // namespace corda::sim
