#include "corda/sim/exact/string/tension_lcp.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/sim/chain_tensions.hpp"

namespace corda::sim {
namespace {

constexpr int kMaxIterations = 100;

/// The mean of z w, in parts of its first value, below which either z or w counts as 0.
constexpr double kEnough = 1e-24;

/// Share of the longest step that keeps z and w positive.
constexpr double kShareOfStep = 0.995;

/// Lower bound of a pivot as a share of its row's diagonal entry; less is rounding.
constexpr double kMinPivot = 1e-15;

class InteriorPoint {
  public:
    /// Every unknown is scaled such that the matrix has the diagonal 1.
    explicit InteriorPoint(TridiagonalLcp problem) : lcp_(std::move(problem)), size_(lcp_.right.size()) {
        std::vector<double> scale(size_);
        for (std::size_t k = 0; k < size_; ++k) scale[k] = 1.0 / std::sqrt(lcp_.diagonal[k]);
        double largest = 0.0;
        for (std::size_t k = 0; k < size_; ++k) {
            lcp_.right[k] *= scale[k];
            if (k + 1 < size_) lcp_.beside[k] *= scale[k] * scale[k + 1];
            largest = std::max(largest, std::abs(lcp_.right[k]));
        }
        if (largest == 0.0) largest = 1.0;
        z_.assign(size_, largest);
        w_.assign(size_, largest);
        for (std::vector<double>* const array : {&missing_, &pivot_, &dz_, &dw_, &aim_})
            array->assign(size_, 0.0);
    }

    /// Iterates until either z or w is 0 in every row, or no step is possible.
    void run() {
        const double enough = kEnough * mean_product(0.0);
        for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
            const double mean = mean_product(0.0);
            if (!(mean > enough)) return;
            count_work(1 + size_);
            factorise();
            for (std::size_t k = 0; k < size_; ++k) aim_[k] = -z_[k] * w_[k];
            find_step();
            const double share = mean_product(longest_step()) / mean;
            const double centre = share * share * share * mean;
            for (std::size_t k = 0; k < size_; ++k) aim_[k] = centre - z_[k] * w_[k] - dz_[k] * dw_[k];
            find_step();
            const double step = std::min(1.0, kShareOfStep * longest_step());
            if (!(step > 0.0)) return;
            for (std::size_t k = 0; k < size_; ++k) {
                z_[k] += step * dz_[k];
                w_[k] += step * dw_[k];
            }
        }
    }

    [[nodiscard]] bool is_positive(std::size_t k) const { return z_[k] > w_[k]; }

  private:
    /// The mean of z w after a step of this length.
    [[nodiscard]] double mean_product(double step) const {
        double sum = 0.0;
        for (std::size_t k = 0; k < size_; ++k) sum += (z_[k] + step * dz_[k]) * (w_[k] + step * dw_[k]);
        return sum / static_cast<double>(size_);
    }

    /// Factorises A + diag(w / z), and finds by how much the rows miss w = A z - b.
    void factorise() {
        for (std::size_t k = 0; k < size_; ++k) {
            const double before = k > 0 ? lcp_.beside[k - 1] : 0.0;
            const double from_before = k > 0 ? before * z_[k - 1] : 0.0;
            const double from_after = k + 1 < size_ ? lcp_.beside[k] * z_[k + 1] : 0.0;
            missing_[k] = w_[k] + lcp_.right[k] - z_[k] - from_before - from_after;
            const double diagonal = 1.0 + w_[k] / z_[k];
            const double rest = k > 0 ? diagonal - before * (before / pivot_[k - 1]) : diagonal;
            pivot_[k] = std::max(rest, kMinPivot * diagonal);
        }
    }

    /// The step at whose end the rows hold and, to first order, z w has changed by aim_.
    void find_step() {
        for (std::size_t k = 0; k < size_; ++k) {
            dz_[k] = missing_[k] + aim_[k] / z_[k];
            if (k > 0) dz_[k] -= lcp_.beside[k - 1] / pivot_[k - 1] * dz_[k - 1];
        }
        for (std::size_t k = size_; k-- > 0;) {
            if (k + 1 < size_) dz_[k] -= lcp_.beside[k] * dz_[k + 1];
            dz_[k] /= pivot_[k];
        }
        for (std::size_t k = 0; k < size_; ++k) dw_[k] = (aim_[k] - w_[k] * dz_[k]) / z_[k];
    }

    /// At most 1.
    [[nodiscard]] double longest_step() const {
        double step = 1.0;
        for (std::size_t k = 0; k < size_; ++k) {
            if (dz_[k] < 0.0) step = std::min(step, -z_[k] / dz_[k]);
            if (dw_[k] < 0.0) step = std::min(step, -w_[k] / dw_[k]);
        }
        return step;
    }

    TridiagonalLcp lcp_;
    std::size_t size_;
    std::vector<double> z_;
    std::vector<double> w_;
    std::vector<double> missing_;  ///< w + b - A z
    std::vector<double> pivot_;
    std::vector<double> dz_;
    std::vector<double> dw_;
    std::vector<double> aim_;
};

/// Number of consecutive block exchanges that may fail to reduce the fewest wrong signs so far; Judice and
/// Pires recommend at most 10.
constexpr int kPatience = 5;

/// Rounds before an interior-point method makes a new guess, which costs about 200 rounds.
constexpr std::size_t kRoundsBeforeGuess = 50;

}  // namespace

std::vector<std::uint8_t> guess_positive(TridiagonalLcp problem) {
    std::vector<std::uint8_t> is_positive(problem.right.size());
    if (is_positive.empty()) return is_positive;
    InteriorPoint point(std::move(problem));
    point.run();
    for (std::size_t k = 0; k < is_positive.size(); ++k) is_positive[k] = point.is_positive(k) ? 1 : 0;
    return is_positive;
}

TensionLcp::TensionLcp(std::vector<double> inverse_mass_1_kg)
    : inverse_mass_1_kg_(std::move(inverse_mass_1_kg)) {
    assert(!inverse_mass_1_kg_.empty());
    const std::size_t links = inverse_mass_1_kg_.size() - 1;
    side.assign(links, Side::kAbsent);
    for (std::vector<double>* array :
         {&right, &cosine, &sine, &z_error, &cosine_, &sine_, &pivot_, &weight_, &z_, &w_}) {
        array->assign(links, 0.0);
    }
    wrong_.reserve(links);
}

bool TensionLcp::solve(double w_error) {
    guess_ = side;
    if (pivot(kRoundsBeforeGuess, w_error)) return true;
    guess_by_interior_point();
    keep_guess_within_errors(w_error);
    // Pivoting by single links terminates, but rounding could undo that.
    return pivot(100 + 20 * side.size(), w_error);
}

bool TensionLcp::pivot(std::size_t most_rounds, double w_error) {
    const std::size_t links = side.size();
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    int patience = kPatience;
    for (std::size_t round = 0; round < most_rounds; ++round) {
        count_work(1 + links);
        solve_pulling();
        wrong_.clear();
        for (std::size_t k = 0; k < links; ++k) {
            if (has_wrong_sign(k, w_error)) wrong_.push_back(k);
        }
        if (wrong_.empty()) return true;
        if (wrong_.size() < fewest) {
            fewest = wrong_.size();
            patience = kPatience;
        } else if (patience > 0) {
            --patience;
        } else {
            wrong_.erase(wrong_.begin(), wrong_.end() - 1);
        }
        for (const std::size_t k : wrong_) side[k] = side[k] == Side::kPulls ? Side::kFree : Side::kPulls;
    }
    return false;
}

void TensionLcp::guess_by_interior_point() {
    TridiagonalLcp problem;
    std::vector<std::size_t> present;
    const std::vector<double>& mass = inverse_mass_1_kg_;
    for (std::size_t k = 0; k < side.size(); ++k) {
        if (side[k] == Side::kAbsent) continue;
        const bool is_joined = k + 1 < side.size() && side[k + 1] != Side::kAbsent;
        problem.diagonal.push_back(mass[k] + mass[k + 1]);
        problem.beside.push_back(is_joined ? -mass[k + 1] * cosine[k] : 0.0);
        problem.right.push_back(right[k]);
        present.push_back(k);
    }
    const std::vector<std::uint8_t> is_positive = guess_positive(std::move(problem));
    for (std::size_t i = 0; i < present.size(); ++i)
        side[present[i]] = is_positive[i] != 0 ? Side::kPulls : Side::kFree;
}

void TensionLcp::keep_guess_within_errors(double w_error) {
    count_work(1 + side.size());
    solve_pulling();
    for (std::size_t k = 0; k < side.size(); ++k) {
        if (side[k] == Side::kAbsent) continue;
        const bool is_either =
            side[k] == Side::kPulls ? std::abs(z_[k]) <= z_error[k] : std::abs(w_[k]) <= w_error;
        if (is_either) side[k] = guess_[k];
    }
}

bool TensionLcp::has_wrong_sign(std::size_t link, double w_error) const {
    if (side[link] == Side::kAbsent) return false;
    // Negated, so that a NaN counts as wrong.
    return side[link] == Side::kPulls ? !(z_[link] >= -z_error[link]) : !(w_[link] >= -w_error);
}

void TensionLcp::solve_pulling() {
    const std::size_t links = side.size();
    const std::vector<double>& mass = inverse_mass_1_kg_;
    std::fill(z_.begin(), z_.end(), 0.0);
    for (std::size_t k = 0; k < links; ++k) {
        cosine_[k] = mass[k + 1] * cosine[k];
        sine_[k] = mass[k + 1] * sine[k];
    }
    // Every run of links that pull, from `first` on.
    for (std::size_t first = 0, end = 0; first < links; first = end + 1) {
        for (end = first; end < links && side[end] == Side::kPulls;) ++end;
        if (end == first) continue;
        solve_tensions({end - first, mass[first], &mass[first + 1], &cosine_[first], &sine_[first]},
                       &right[first], &pivot_[first], &weight_[first], &z_[first]);
    }
    for (std::size_t k = 0; k < links; ++k) {
        w_[k] = 0.0;
        if (side[k] != Side::kFree) continue;
        const double before = k > 0 ? cosine_[k - 1] * z_[k - 1] : 0.0;
        const double after = k + 1 < links ? cosine_[k] * z_[k + 1] : 0.0;
        w_[k] = -before - after - right[k];
    }
}

}  // namespace corda::sim
