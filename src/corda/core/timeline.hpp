#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "corda/core/rational.hpp"

namespace corda {

/// `time_s` if it is within 0 .. `end_s`; the nearer end if rounding alone, 1e-12 of `end_s`, takes it
/// outside, as 3 * 0.1 is beyond 0.3; otherwise std::nullopt, also for NaN.
[[nodiscard]] std::optional<double> time_within(double time_s, double end_s);

/// The times at which a motion is recorded, in order: the frame times 0 .. last_frame of a rate, and others
/// between or after them, such as those of stills.
class Timeline {
  public:
    /// `still_times_s` may come in any order and may repeat frame times; every one is finite and >= 0.
    /// `step_s`: see step_s(); default: the time from frame to frame.
    Timeline(FrameRate fps, std::int64_t last_frame, std::vector<double> still_times_s = {},
             std::optional<double> step_s = {});

    [[nodiscard]] std::size_t size() const { return times_s_.size(); }
    /// Time `i` in seconds, i < size(); increasing.
    [[nodiscard]] double time_s(std::size_t i) const {
        assert(i < size());
        return times_s_[i];
    }
    /// Whether time `i` is that of a frame.
    [[nodiscard]] bool is_frame(std::size_t i) const {
        assert(i < size());
        return is_frame_[i];
    }
    /// The index of exactly this time; std::nullopt if the timeline does not have it.
    [[nodiscard]] std::optional<std::size_t> find(double time_s) const;
    [[nodiscard]] FrameRate fps() const { return fps_; }
    /// The interval from which methods of fixed step derive their step. It does not depend on the speed of a
    /// video, so that slow motion shows the same motion.
    [[nodiscard]] double step_s() const { return step_s_; }

  private:
    FrameRate fps_;
    double step_s_;
    std::vector<double> times_s_;
    std::vector<bool> is_frame_;  ///< by time
};

}  // namespace corda
