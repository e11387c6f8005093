#pragma once

#include <cmath>
#include <vector>

#include "corda/sim/auto/planner.hpp"

// The trials that `auto` may run, with their tolerances and steps. The tolerance that one has to reach is
// `tolerance_px` of the scene (scene/scene.hpp), in metres PlanDef::tolerance_m.

namespace corda::sim {

/// A trial that may be run.
struct Candidate {
    Trial trial;
    double effort;         ///< of a second of its run, in parts of that of other candidates
    double checks_effort;  ///< the same of its checks
    int digits;  ///< powers of ten by which its errors are smaller than those of other candidates, roughly
    double most_steps_1_s = HUGE_VAL;  ///< after which it ends, besides short ones that a start may need
};

/// Times from which methods of fixed step derive their step divide this, whatever the video's frame interval
/// is, so that a preview shows the same motion.
inline constexpr double kNominalIntervalSeconds = 1.0 / 60.0;

/// True for a method of implicit steps.
[[nodiscard]] bool is_implicit(const MethodDef& method);

/// True if the force of a bar has a kink: of strings that stretch.
[[nodiscard]] bool has_kinks(const System& system);

/// The loosest trial of `exact`.
[[nodiscard]] ExactDef loosest_exact();

/// Trials of `exact`, each a hundred times tighter than the last, after cheaper ones: with implicit steps, or
/// of `rattle`. For a motion until `end_s`.
[[nodiscard]] std::vector<Candidate> exact_trials(const System& system, const WorldDef& world,
                                                  double tolerance_m, double end_s);

/// Trials of `rattle` for a graph, each checked by the next order (8 by 8) at a third of its step.
[[nodiscard]] std::vector<Candidate> graph_trials(const System& system, const WorldDef& world,
                                                  const PlanDef& def);

}  // namespace corda::sim
