#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/rational.hpp"
#include "corda/pipeline/motion.hpp"
#include "corda/view/scene_view.hpp"

namespace corda::pipeline {

/// Where some particles of a motion go, at its frame times: what trails are drawn from. A trail has the same
/// points whatever was drawn before.
class TrailRecorder {
  public:
    /// `trail_s`: of a trail. A long one has a point every few frames.
    TrailRecorder(std::vector<std::size_t> particles, double trail_s, FrameRate fps);

    /// Reads the motion as far as trails at that time need it. Throws what Motion::at() throws.
    void read(Motion& motion, double time_s, const OnProgress& on_progress);
    /// The trails that end at a state, one per particle. Requires that it has been read to there.
    [[nodiscard]] const std::vector<view::Trail>& to(const State& state);

  private:
    [[nodiscard]] double time_s(std::size_t point) const {
        return fps_.time_s(static_cast<std::int64_t>(point) * stride_);
    }

    std::vector<std::size_t> particles_;
    double trail_s_;
    FrameRate fps_;
    std::int64_t stride_;     ///< frames from point to point
    std::vector<Vec2> at_m_;  ///< point by point, of all particles
    std::size_t points_ = 0;
    std::vector<view::Trail> trails_;
};

}  // namespace corda::pipeline
