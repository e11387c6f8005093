#include "corda/sim/exact/dop853.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "corda/sim/exact/dop853_tableau.hpp"

namespace corda::sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Step control as in the book (II.4): a step aims at an error below the tolerance, and changes by no more
// than these factors at a time.
constexpr double kSafety = 0.9;
constexpr double kMaxGrowth = 6.0;
constexpr double kMaxShrink = 1.0 / 3.0;
constexpr double kShrinkOfNotFinite = 0.1;

/// Components are worked on in blocks of this size, so that errors need no array of their own.
constexpr std::size_t kBlock = 64;

template <std::size_t Count>
struct Terms {
    std::array<const double*, Count> slope;
    std::array<double, Count> weight;
};

/// The terms of step * row.
template <std::size_t Count>
Terms<Count> terms(const dop853::Row<Count>& row, double step_s,
                   const std::array<std::vector<double>, dop853::kSlots>& slope) {
    Terms<Count> result{};
    for (std::size_t j = 0; j < Count; ++j) {
        result.slope[j] = slope[row.slots[j]].data();
        result.weight[j] = step_s * row.weights[j];
    }
    return result;
}

/// Their sum in component i, from left to right.
template <std::size_t Count>
[[gnu::always_inline]] inline double sum(const Terms<Count>& terms, std::size_t i) {
    return [&]<std::size_t... J>(std::index_sequence<J...>) {
        return (... + (terms.weight[J] * terms.slope[J][i]));
    }
    (std::make_index_sequence<Count>());
}

template <std::size_t Count>
void add(const Terms<Count> terms, std::size_t size, const double* from, double* __restrict out) {
    for (std::size_t i = 0; i < size; ++i) out[i] = from[i] + sum(terms, i);
}

/// From square roots, because std::pow is rounded differently by different C libraries.
double eighth_root(double x) {
    return std::sqrt(std::sqrt(std::sqrt(x)));
}

}  // namespace

Dop853::Dop853(Ode& ode, std::vector<double> start, std::vector<ErrorScale> scales,
               const StepControl& control)
    : ode_(ode),
      scales_(std::move(scales)),
      control_(control),
      next_step_s_(std::min(control.first_s, control.largest_s)),
      y_(std::move(start)),
      old_y_(y_),
      stage_(y_) {
    assert(control.tolerance > 0.0);
    static_assert(kSlots == dop853::kSlots);
    for (std::vector<double>& slope : slope_) slope.assign(y_.size(), 0.0);
    ode_.derivative(y_.data(), slope_[dop853::k13].data());
}

Status Dop853::advance_to(double time_s, StopCheck& stop) {
    if (!std::isfinite(time_s)) return Status::kDiverged;
    while (time_s_ < time_s) {
        if (step(stop) == Status::kDiverged) return Status::kDiverged;
    }
    return Status::kOk;
}

template <std::size_t Count>
void Dop853::evaluate(const dop853::Row<Count>& row, double step_s, const std::vector<double>& from,
                      std::vector<double>& scratch, std::size_t slot) {
    add(terms(row, step_s, slope_), from.size(), from.data(), scratch.data());
    ode_.derivative(scratch.data(), slope_[slot].data());
}

Status Dop853::step(StopCheck& stop) {
    std::swap(slope_[dop853::k1], slope_[dop853::k13]);
    double largest_growth = kMaxGrowth;
    while (accepted_ + rejected_ < StepControl::kMaxSteps) {
        // Time and step agree to the last bit, so that no rounding of times adds up.
        const double end_s = time_s_ + next_step_s_;
        const double step_s = end_s - time_s_;
        if (!(step_s > control_.smallest_s)) return Status::kDiverged;
        stop.spend(1 + y_.size());
        evaluate_stages(step_s);
        const double step_error = error(step_s);
        const double factor = step_error < kInfinity
                                  ? std::clamp(kSafety / eighth_root(step_error), kMaxShrink, largest_growth)
                                  : kShrinkOfNotFinite;
        next_step_s_ = std::min(step_s * factor, control_.largest_s);
        if (step_error <= 1.0) {
            accept(end_s);
            return Status::kOk;
        }
        // A length that was just too long is not tried again at once.
        largest_growth = 1.0;
        ++rejected_;
    }
    return Status::kDiverged;
}

void Dop853::evaluate_stages(double step_s) {
    using namespace dop853;
    evaluate(kStageRow2, step_s, y_, stage_, k2);
    evaluate(kStageRow3, step_s, y_, stage_, k3);
    evaluate(kStageRow4, step_s, y_, stage_, k4);
    evaluate(kStageRow5, step_s, y_, stage_, k5);
    evaluate(kStageRow6, step_s, y_, stage_, k6);
    evaluate(kStageRow7, step_s, y_, stage_, k7);
    evaluate(kStageRow8, step_s, y_, stage_, k8);
    evaluate(kStageRow9, step_s, y_, stage_, k9);
    evaluate(kStageRow10, step_s, y_, stage_, k10);
    evaluate(kStageRow11, step_s, y_, stage_, k11);
    evaluate(kStageRow12, step_s, y_, stage_, k12);
    add(terms(kResult, step_s, slope_), y_.size(), y_.data(), stage_.data());
}

double Dop853::error(double step_s) const {
    const Terms<8> terms5 = terms(dop853::kError5, step_s, slope_);
    const Terms<8> terms3 = terms(dop853::kError3, step_s, slope_);
    double largest5 = 0.0;
    double largest3 = 0.0;
    bool is_finite = true;
    std::array<double, kBlock> parts5{};
    std::array<double, kBlock> parts3{};
    for (const ErrorScale& scale : scales_) {
        for (std::size_t first = scale.first; first < scale.first + scale.count; first += kBlock) {
            const std::size_t count = std::min(kBlock, scale.first + scale.count - first);
            for (std::size_t k = 0; k < count; ++k) {
                const std::size_t i = first + k;
                const double size = std::max(std::abs(y_[i]), std::abs(stage_[i]));
                const double unit = 1.0 / (scale.absolute + scale.relative * size);
                parts5[k] = std::abs(sum(terms5, i)) * unit;
                parts3[k] = std::abs(sum(terms3, i)) * unit;
            }
            for (std::size_t k = 0; k < count; ++k) {
                is_finite = is_finite && parts5[k] < kInfinity;  // false for NaN
                largest5 = std::max(largest5, parts5[k]);
                largest3 = std::max(largest3, parts3[k]);
            }
        }
    }
    if (!is_finite) return kInfinity;
    if (largest5 == 0.0) return 0.0;
    // The book's combination (II.10), of order 8 if both estimates behave according to their orders.
    const double both = largest5 * largest5 / std::sqrt(largest5 * largest5 + 0.01 * largest3 * largest3);
    return both / control_.tolerance;
}

void Dop853::accept(double end_s) {
    ode_.project(stage_.data());
    std::swap(old_y_, y_);
    std::swap(y_, stage_);
    ode_.derivative(y_.data(), slope_[dop853::k13].data());
    old_time_s_ = time_s_;
    time_s_ = end_s;
    can_interpolate_ = false;
    ++accepted_;
}

void Dop853::prepare_interpolation() {
    using namespace dop853;
    const double step_s = time_s_ - old_time_s_;
    evaluate(kStageRow14, step_s, old_y_, stage_, k14);
    evaluate(kStageRow15, step_s, old_y_, stage_, k15);
    evaluate(kStageRow16, step_s, old_y_, stage_, k16);
    can_interpolate_ = true;
}

void Dop853::interpolate(double time_s, double* y) {
    assert(old_time_s_ <= time_s && time_s <= time_s_);
    if (time_s == time_s_) {
        std::copy(y_.begin(), y_.end(), y);
        return;
    }
    if (!can_interpolate_) prepare_interpolation();
    using namespace dop853;
    // The book's nested form, with p = t (1 - t):
    //   y0 + t (d + (1-t) (b + t (e + (1-t) (r4 + t (r5 + (1-t) (r6 + t r7)))))),
    //   d = y1 - y0, b = h k1 - d, e = d - h k13 - b, r_n = h * (row kDense n),
    // computed as one sum over the slopes.
    const double step_s = time_s_ - old_time_s_;
    const double t = (time_s - old_time_s_) / step_s;
    const double p = t * (1.0 - t);
    const std::array<double, 4> share = {p * p, t * p * p, p * p * p, t * p * p * p};
    constexpr std::array<Slot, 12> kUsed = {k1, k6, k7, k8, k9, k10, k11, k12, k13, k14, k15, k16};
    dop853::Row<12> row{kUsed, {}};
    for (std::size_t j = 0; j < kUsed.size(); ++j) {
        row.weights[j] = share[0] * kDense4.weights[j] + share[1] * kDense5.weights[j] +
                         share[2] * kDense6.weights[j] + share[3] * kDense7.weights[j];
    }
    row.weights[0] += p - t * p;
    row.weights[8] -= t * p;
    const double moved = t - p + 2.0 * t * p;
    const Terms<12> weighted = terms(row, step_s, slope_);
    for (std::size_t i = 0; i < y_.size(); ++i) {
        y[i] = old_y_[i] + (moved * (y_[i] - old_y_[i]) + sum(weighted, i));
    }
}

}  // namespace corda::sim
