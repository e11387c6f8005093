#include "corda/film/swing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace corda::film {
namespace {

/// Where the cubic with these values and slopes at 0 and 1, of different signs, changes its sign.
double root_of_cubic(double v0, double d0, double v1, double d1) {
    constexpr int kHalvings = 53;
    const double rise = v1 - v0;
    const double second = 3 * rise - 2 * d0 - d1;
    const double third = d0 + d1 - 2 * rise;
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        const double value = v0 + middle * (d0 + middle * (second + middle * third));
        ((value < 0.0) == (v0 < 0.0) ? low : high) = middle;  // as include() tells a passage
    }
    return 0.5 * (low + high);
}

/// The difference of two times as a share of the longer one.
double difference(double a_s, double b_s) {
    return std::abs(a_s - b_s) / std::max(a_s, b_s);
}

}  // namespace

void Passages::include(double time_s, Vec2 arm_m, Vec2 velocity_m_s) {
    constexpr double kNarrow = 1e-9;
    const auto was = std::exchange(last_, Point{time_s, arm_m, velocity_m_s});
    const double width = arm_m.y != 0.0 ? std::abs(arm_m.x / arm_m.y) : 0.0;
    const double widest = std::exchange(widest_, std::max(widest_, width));
    if (!was || (was->arm_m.x < 0.0) == (arm_m.x < 0.0) || was->arm_m.y >= 0.0 || arm_m.y >= 0.0) return;
    widest_ = width;  // of the next swing
    if (widest < kNarrow) return;
    const double step_s = time_s - was->time_s;
    times_s_.push_back(was->time_s + step_s * root_of_cubic(was->arm_m.x, step_s * was->velocity_m_s.x,
                                                            arm_m.x, step_s * velocity_m_s.x));
    is_rightward_.push_back(arm_m.x >= 0.0);
}

Period Passages::period() const {
    const std::size_t count = times_s_.size();
    constexpr std::size_t kLeast = 3;
    if (count < kLeast) return {{}, "fewer than three passages below the pin"};
    if (std::ranges::adjacent_find(is_rightward_) != is_rightward_.end())
        return {{}, "two successive passages below the pin are in the same direction"};
    const auto from_to_s = [this](std::size_t from, std::size_t to) { return times_s_[to] - times_s_[from]; };
    double largest = 0.0;
    for (std::size_t i = 0; i + kLeast < count; ++i)
        largest = std::max(largest, difference(from_to_s(i, i + 2), from_to_s(i + 1, i + 3)));
    double most = kPeriodsAgree;
    if (count == kLeast) {
        largest = difference(from_to_s(0, 1), from_to_s(1, 2));
        most *= 2.0;
    }
    if (largest > most)
        return {{},
                fmt::format("{} differ by {:.1f} %, more than {:.0f} %",
                            count == kLeast ? "the two halves" : "successive periods",
                            0.1 * std::ceil(1000.0 * largest), 100.0 * most)};
    const std::size_t periods = (count - 1) / 2;
    return {from_to_s(0, 2 * periods) / static_cast<double>(periods)};
}

}  // namespace corda::film
