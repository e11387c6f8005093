#include "corda/sim/spread.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "corda/sim/distance.hpp"

namespace corda::sim {
namespace {

constexpr unsigned kDropped = 48;  // bits of a double
constexpr std::size_t kBins = std::size_t{1} << (63U - kDropped);

}  // namespace

StateFields readings_for(Quantity quantity) {
    return {.velocities = quantity == Quantity::kSpeed, .tensions = quantity == Quantity::kTension};
}

double value_of(Quantity quantity, const System& system, const Body& body, std::size_t k,
                const State& state) {
    const auto [a, b, reach, rest_m] = system.bars[k];
    switch (quantity) {
        case Quantity::kTension:
            return state.tension_n[k];
        case Quantity::kSpeed:
            return 0.5 *
                   (length(state.vx_m_s[a], state.vy_m_s[a]) + length(state.vx_m_s[b], state.vy_m_s[b]));
        case Quantity::kStrain:
            break;
    }
    const double strain = length(state.x_m[b] - state.x_m[a], state.y_m[b] - state.y_m[a]) / rest_m - 1.0;
    return body.material.is_string ? std::max(0.0, strain) : strain;
}

void Spread::add(double value) {
    if (std::isnan(value)) return;
    ++count_;
    least_ = std::min(least_, value);
    largest_ = std::max(largest_, value);
    counts_.resize(kBins);
    ++counts_[std::bit_cast<std::uint64_t>(std::abs(value)) >> kDropped];
}

void Spread::add(const Spread& other) {
    count_ += other.count_;
    least_ = std::min(least_, other.least_);
    largest_ = std::max(largest_, other.largest_);
    if (other.empty()) return;
    counts_.resize(kBins);
    std::transform(counts_.begin(), counts_.end(), other.counts_.begin(), counts_.begin(), std::plus<>());
}

double Spread::size_exceeded_by(double share) const {
    const double all = std::max(std::abs(least_), std::abs(largest_));
    std::uint64_t larger = 0;
    for (std::size_t bin = counts_.size(); bin-- > 0;) {
        larger += counts_[bin];
        if (static_cast<double>(larger) > share * static_cast<double>(count_))
            return std::min(all, std::bit_cast<double>(std::uint64_t{bin + 1} << kDropped));
    }
    return 0.0;
}

}  // namespace corda::sim
