#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "corda/scene/scene.hpp"
#include "support/extended_motion.hpp"

namespace corda::test {

/// A scene, and its start in extended precision (x, then y, in m) if the scene's points are rounded from
/// other numbers.
struct EstimateCase {
    Scene scene;
    std::vector<ExtendedMotion::Real> start = {};
    /// Position of a particle at a time, relative to the scene's origin, in closed form; empty:
    /// ExtendedMotion computes it. Times never decrease.
    std::function<std::array<ExtendedMotion::Real, 2>(double time_s, std::size_t particle)> truth = {};
    /// How often the motion is looked at per frame; if more than once, also until the scene ends.
    int looks = 1;
};

/// The verdict on an estimate of method auto.
struct Verdict {
    std::optional<double>
        ratio;  ///< the largest of error / estimate; std::nullopt if there is none, or no truth
    std::string why_no_estimate;  ///< empty if there is an estimate
    std::string why_not_judged;   ///< empty if the truth reached the horizon or the end
    std::optional<double> horizon_s;
    /// The first time at which the error is larger than the estimate, if judge_estimate() looks for it
    /// and the scene does not end before.
    std::optional<double> passes_s;
    double estimate_m = 0.0;
    double worst_s = 0.0;  ///< when the ratio is largest
    double plan_s = 0.0;   ///< duration of planning
    double truth_s = 0.0;  ///< duration of computing the truth
};

/// Compares the error estimate of method auto with the truth, in world coordinates at all times that are
/// looked at, up to the horizon; in the picture, at the frame times, if the camera follows something (its
/// height must be given). If the truth ends early, the times before its end count. `beyond`: also looks for
/// Verdict::passes_s, at the times after the horizon as well.
[[nodiscard]] Verdict judge_estimate(const EstimateCase& given, bool beyond = false);

}  // namespace corda::test
