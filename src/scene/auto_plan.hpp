#pragma once

#include <optional>

#include "corda/scene/scene.hpp"
#include "corda/sim/planner.hpp"

namespace corda::scene {

/// What method `auto` became for a scene, and the proof in pixels of its picture.
struct AutoPlan {
    sim::Plan plan;
    double pixels_per_metre = 0.0;

    /// Nothing where the plan has no bound.
    [[nodiscard]] std::optional<double> error_bound_px() const {
        if (!plan.error_bound_m) return std::nullopt;
        return *plan.error_bound_m * pixels_per_metre;
    }
};

/// Settles a scene's method: where it is `auto`, puts the cheapest method that keeps the displayed error
/// below solver.tolerance_px into `scene.solver` and returns the proof; otherwise does nothing and returns
/// nothing. Throws corda::Error (kInvalidScene, kDiverged), and what `watch` throws.
[[nodiscard]] std::optional<AutoPlan> settle_method(Scene& scene, const sim::FrameWatch& watch = {});

}  // namespace corda::scene
