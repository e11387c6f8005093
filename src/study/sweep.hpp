#pragma once

#include <span>
#include <string>
#include <vector>

#include "corda/study/study.hpp"
#include "corda/study/truth.hpp"
#include "corda/study/work.hpp"

namespace corda::study {

/// A run of a sweep.
struct SweepRun {
    sim::SolverDef solver;
    std::string label;       ///< of its series
    double parameter = 0.0;  ///< step in s, or tolerance
};

/// All methods over their parameters: relaxation over steps, reaches and sweeps, rope over orders and steps,
/// exact over tolerances. Steps are whole parts of a frame, so that frames are steps too. Runs that would
/// take too long are left out. A method that refuses the problem has one run a series, which will fail.
[[nodiscard]] std::vector<SweepRun> sweep_runs(const Problem& problem, bool is_quick);

/// The cheapest of the runs whose RMS error is at most `error`; null where none is.
[[nodiscard]] const Measurement* cheapest_within(std::span<const Measurement> runs, double error);

/// The chapter "Speed against error": of def.problem or of the built-in ones.
[[nodiscard]] ChapterWork speed_work(const StudyDef& def);

}  // namespace corda::study
