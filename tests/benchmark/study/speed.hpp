#pragma once

#include <string>
#include <vector>

#include "benchmark/study/measure.hpp"

namespace corda::study {

/// A run of a sweep.
struct SweepRun {
    MethodDef method;
    std::string label;       ///< of its series
    double parameter = 0.0;  ///< step in s, or tolerance
    int reach = 1;           ///< of the ropes' bars
};

/// All methods over their parameters: relaxation over reaches, sweeps and steps, rattle over orders and
/// steps, exact over tolerances. Steps divide a frame. Runs that would take too long are left out. A method
/// that refuses the problem has one run per series, which will fail.
[[nodiscard]] std::vector<SweepRun> sweep_runs(const Problem& problem, bool is_quick);

}  // namespace corda::study
