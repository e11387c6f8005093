#include "corda/core/timeline.hpp"

#include <algorithm>
#include <cassert>

namespace corda {

std::optional<double> time_within(double time_s, double end_s) {
    constexpr double kRounding = 1e-12;
    const double rounding_s = kRounding * end_s;
    if (!(time_s >= -rounding_s && time_s <= end_s + rounding_s)) return std::nullopt;
    return std::clamp(time_s, 0.0, end_s) + 0.0;  // not -0.0, whose sign would be in names of files
}

Timeline::Timeline(FrameRate fps, std::int64_t last_frame, std::vector<double> still_times_s,
                   std::optional<double> step_s)
    : fps_(fps), step_s_(step_s.value_or(fps.interval_s())) {
    assert(last_frame >= 0);
    std::ranges::sort(still_times_s);
    times_s_.reserve(static_cast<std::size_t>(last_frame) + 1 + still_times_s.size());
    is_frame_.reserve(times_s_.capacity());
    const auto add = [this](double time_s, bool is_frame) {
        times_s_.push_back(time_s);
        is_frame_.push_back(is_frame);
    };
    const auto add_still = [&](double time_s) {
        if (times_s_.empty() || time_s != times_s_.back()) add(time_s, false);
    };
    auto still = still_times_s.begin();
    for (std::int64_t k = 0; k <= last_frame; ++k) {
        const double frame_s = fps.time_s(k);
        for (; still != still_times_s.end() && *still < frame_s; ++still) add_still(*still);
        add(frame_s, true);
    }
    for (; still != still_times_s.end(); ++still) add_still(*still);
}

std::optional<std::size_t> Timeline::find(double time_s) const {
    const auto at = std::ranges::lower_bound(times_s_, time_s);
    if (at == times_s_.end() || *at != time_s) return std::nullopt;
    return static_cast<std::size_t>(at - times_s_.begin());
}

}  // namespace corda
