#include "corda/pipeline/trail_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace corda::pipeline {
namespace {

/// More would be shorter than a pixel.
constexpr double kMaxPoints = 400.0;

/// A point that is closer to the end has no direction to it, as a share of the frames' interval.
constexpr double kTooClose = 1e-6;

}  // namespace

TrailRecorder::TrailRecorder(std::vector<std::size_t> particles, double trail_s, FrameRate fps)
    : particles_(std::move(particles)),
      trail_s_(trail_s),
      fps_(fps),
      stride_(std::max<std::int64_t>(1, std::llround(std::ceil(trail_s / fps.interval_s() / kMaxPoints)))),
      trails_(particles_.size()) {}

void TrailRecorder::read(Motion& motion, double end_s, const OnProgress& on_progress) {
    if (particles_.empty()) return;
    for (; time_s(points_) <= end_s; ++points_) {
        const State& state = motion.at(time_s(points_), on_progress);
        for (const std::size_t i : particles_) at_m_.push_back({state.x_m[i], state.y_m[i]});
    }
}

const std::vector<view::Trail>& TrailRecorder::to(const State& state) {
    std::size_t first = points_;
    while (first > 0 && time_s(first - 1) >= state.time_s - kTooClose * fps_.interval_s()) --first;
    const std::size_t end = first;
    while (first > 0 && state.time_s - time_s(first - 1) < trail_s_) --first;
    for (std::size_t p = 0; p < particles_.size(); ++p) {
        view::Trail& trail = trails_[p];
        trail.clear();
        for (std::size_t k = first; k < end; ++k)
            trail.push_back({state.time_s - time_s(k), at_m_[k * particles_.size() + p]});
        trail.push_back({0.0, {state.x_m[particles_[p]], state.y_m[particles_[p]]}});
    }
    return trails_;
}

}  // namespace corda::pipeline
