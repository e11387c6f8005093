#pragma once

#include <optional>
#include <string>
#include <vector>

#include "corda/scene/scene.hpp"
#include "support/extended_motion.hpp"

namespace corda::test {

/// A scene, and its start in extended precision (x, then y, in m) if the scene's points are rounded from
/// other numbers.
struct BoundCase {
    Scene scene;
    std::vector<ExtendedMotion::Real> start = {};
};

/// What became of a claim of method auto.
struct Verdict {
    std::optional<double>
        ratio;                   ///< the largest of error / bound; std::nullopt if there is none, or no truth
    std::string why_no_bound;    ///< empty if there is a bound
    std::string why_not_judged;  ///< empty if the truth got to the end of the claim
    std::optional<double> horizon_s;
    double bound_m = 0.0;
    double worst_s = 0.0;  ///< when the ratio is largest
    double plan_s = 0.0;   ///< what planning took
    double truth_s = 0.0;  ///< what the truth took
};

/// Holds the bound that method auto claims against ExtendedMotion, in world coordinates at all frame times up
/// to the horizon. If the truth breaks off, what it reached counts.
[[nodiscard]] Verdict judge_bound(const BoundCase& given);

}  // namespace corda::test
