#include "corda/core/timeline.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace corda {

std::optional<double> time_within(double time_s, double end_s) {
    constexpr double kRounding = 1e-12;
    const double rounding_s = kRounding * end_s;
    if (!(time_s >= -rounding_s && time_s <= end_s + rounding_s)) return std::nullopt;
    return std::clamp(time_s, 0.0, end_s) + 0.0;  // not -0.0, whose sign would be in names of files
}

Timeline::Timeline(FrameRate fps, std::int64_t last_frame, std::vector<double> still_times_s,
                   std::optional<double> step_s)
    : fps_(fps),
      step_s_(step_s.value_or(fps.interval_s())),
      frame_count_(static_cast<std::size_t>(last_frame) + 1),
      still_times_s_(std::move(still_times_s)) {
    assert(last_frame >= 0);
    std::ranges::sort(still_times_s_);
    still_times_s_.erase(std::unique(still_times_s_.begin(), still_times_s_.end()), still_times_s_.end());
    std::erase_if(still_times_s_, [this](double time_s) {
        const std::size_t k = frames_before(time_s);
        return k < frame_count_ && fps_.time_s(static_cast<std::int64_t>(k)) == time_s;
    });
    for (std::size_t j = 0; j < still_times_s_.size(); ++j)
        still_index_.push_back(frames_before(still_times_s_[j]) + j);
}

std::size_t Timeline::frames_before(double time_s) const {
    const double last = static_cast<double>(frame_count_);
    auto k = static_cast<std::int64_t>(std::clamp(std::floor(time_s * fps_.per_second()) - 1.0, 0.0, last));
    while (k < static_cast<std::int64_t>(frame_count_) && fps_.time_s(k) < time_s) ++k;
    return static_cast<std::size_t>(k);
}

double Timeline::time_s(std::size_t i) const {
    assert(i < size());
    const auto at = std::lower_bound(still_index_.begin(), still_index_.end(), i);
    const auto j = static_cast<std::size_t>(at - still_index_.begin());
    if (at != still_index_.end() && *at == i) return still_times_s_[j];
    return fps_.time_s(static_cast<std::int64_t>(i - j));
}

bool Timeline::is_frame(std::size_t i) const {
    return !std::ranges::binary_search(still_index_, i);
}

std::optional<std::size_t> Timeline::find(double time_s) const {
    const auto still = std::lower_bound(still_times_s_.begin(), still_times_s_.end(), time_s);
    const auto j = static_cast<std::size_t>(still - still_times_s_.begin());
    if (still != still_times_s_.end() && *still == time_s) return still_index_[j];
    const std::size_t k = frames_before(time_s);
    if (k >= frame_count_ || fps_.time_s(static_cast<std::int64_t>(k)) != time_s) return std::nullopt;
    return k + j;
}

}  // namespace corda
