#include "corda/sim/exact/string/tension_lcp.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "corda/sim/chain_tensions.hpp"
#include "corda/sim/exact/string/interior_point.hpp"

namespace corda::sim {
namespace {

/// Exchanges of whole blocks in a row that may fail to leave fewer wrong signs than ever before; Judice and
/// Pires recommend 10 or fewer.
constexpr int kPatience = 5;

/// Rounds before an interior point makes a new guess, which costs as much as some 200.
constexpr std::size_t kRoundsBeforeGuess = 50;

}  // namespace

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

bool TensionLcp::solve(double w_error, StopCheck& stop) {
    guess_ = side;
    if (pivot(kRoundsBeforeGuess, w_error, stop)) return true;
    guess_by_interior_point(stop);
    keep_guess_within_errors(w_error, stop);
    // Pivoting by single links terminates, but rounding could undo that.
    return pivot(100 + 20 * side.size(), w_error, stop);
}

bool TensionLcp::pivot(std::size_t most_rounds, double w_error, StopCheck& stop) {
    const std::size_t links = side.size();
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    int patience = kPatience;
    for (std::size_t round = 0; round < most_rounds; ++round) {
        stop.spend(1 + links);
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

void TensionLcp::guess_by_interior_point(StopCheck& stop) {
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
    const std::vector<std::uint8_t> is_positive = guess_positive(std::move(problem), stop);
    for (std::size_t i = 0; i < present.size(); ++i)
        side[present[i]] = is_positive[i] != 0 ? Side::kPulls : Side::kFree;
}

void TensionLcp::keep_guess_within_errors(double w_error, StopCheck& stop) {
    stop.spend(1 + side.size());
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
