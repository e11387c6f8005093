#pragma once

#include <functional>
#include <string>
#include <vector>

#include "corda/study/study.hpp"

namespace corda::study {

/// The outcome of a hard case.
struct Outcome {
    std::string measured;
    bool passed = false;
};

/// A case of section 5 of src/sim/README.md for one method.
struct HardCase {
    std::string name;
    std::string method;
    std::string criterion;
    bool is_slow = false;          ///< not run by a quick study, which says so
    std::function<Outcome()> run;  ///< what it throws as corda::Error is the outcome
};

/// Motions: payloads, releases, throws, inverted and folded ropes, unequal links and masses.
void add_hard_motions(std::vector<HardCase>& cases);
/// Sizes and steps: long ropes, long runs, steps of any size, refusals, frame rates, repeated runs.
void add_hard_sizes(std::vector<HardCase>& cases);
/// Scene files that must be refused.
void add_hard_inputs(std::vector<HardCase>& cases);

/// The chapter "Hard cases".
[[nodiscard]] ChapterWork hard_cases_work(const StudyDef& def);

}  // namespace corda::study
