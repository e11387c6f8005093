#include "corda/sim/tension_lcp.hpp"

#include <cassert>
#include <limits>
#include <utility>

namespace corda::sim {
namespace {

/// Blocks that are exchanged in a row without leaving fewer wrong signs than ever before; Judice and Pires
/// recommend 10 or fewer.
constexpr int kPatience = 5;

}  // namespace

TensionLcp::TensionLcp(std::vector<double> inverse_mass_1_kg)
    : inverse_mass_1_kg_(std::move(inverse_mass_1_kg)) {
    assert(!inverse_mass_1_kg_.empty());
    const std::size_t links = inverse_mass_1_kg_.size() - 1;
    side.assign(links, Side::kAbsent);
    for (std::vector<double>* array : {&right, &cosine, &sine, &z_error, &pivot_, &z_, &w_}) {
        array->assign(links, 0.0);
    }
    wrong_.reserve(links);
}

bool TensionLcp::solve(double w_error) {
    const std::size_t links = side.size();
    // Rounding can undo what pivoting by single links is proved to do.
    const std::size_t most_rounds = 100 + 20 * links;
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    int patience = kPatience;
    for (std::size_t round = 0; round < most_rounds; ++round) {
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

bool TensionLcp::has_wrong_sign(std::size_t link, double w_error) const {
    if (side[link] == Side::kAbsent) return false;
    // So that what is not a number counts as wrong.
    return side[link] == Side::kPulls ? !(z_[link] >= -z_error[link]) : !(w_[link] >= -w_error);
}

void TensionLcp::solve_pulling() {
    const std::size_t links = side.size();
    const std::vector<double>& mass = inverse_mass_1_kg_;
    const auto pulls = [&](std::size_t k) { return k < links && side[k] == Side::kPulls; };
    // From the last link to the first, as ChainDynamics does: e is the inverse mass that the chain beyond a
    // link shows to a pull along it, and only positive numbers are added. z_ holds the right sides.
    double e = 0.0;
    for (std::size_t k = links; k-- > 0;) {
        if (!pulls(k)) {
            z_[k] = 0.0;
            continue;
        }
        z_[k] = right[k];
        if (pulls(k + 1)) {
            const double across = mass[k + 1] * sine[k];
            e = (mass[k + 1] * e + across * across) / pivot_[k + 1];
            z_[k] += mass[k + 1] * cosine[k] / pivot_[k + 1] * z_[k + 1];
        } else {
            e = mass[k + 1];
        }
        pivot_[k] = mass[k] + e;
    }
    for (std::size_t k = 0; k < links; ++k) {
        if (!pulls(k)) continue;
        if (k > 0) z_[k] += mass[k] * cosine[k - 1] * z_[k - 1];
        z_[k] /= pivot_[k];
    }
    for (std::size_t k = 0; k < links; ++k) {
        w_[k] = 0.0;
        if (side[k] != Side::kFree) continue;
        const double before = k > 0 ? mass[k] * cosine[k - 1] * z_[k - 1] : 0.0;
        const double after = k + 1 < links ? mass[k + 1] * cosine[k] * z_[k + 1] : 0.0;
        w_[k] = -before - after - right[k];
    }
}

}  // namespace corda::sim
