#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "corda/study/study.hpp"
#include "corda/study/work.hpp"

namespace corda::study {

/// What a hard case came to.
struct Outcome {
    std::string measured;
    bool is_held = false;
};

/// A row of PHYSICS section 5.
struct HardCase {
    std::string name;
    std::string method;
    std::string criterion;
    bool takes_long = false;       ///< left out of a quick study, and marked there
    std::function<Outcome()> run;  ///< empty: refused when a scene is read, before a method sees it
};

/// Motions: payloads, releases, throws, inverted and folded ropes, unequal links and masses.
void add_hard_motions(std::vector<HardCase>& cases);
/// Sizes, steps and inputs: long ropes, long runs, steps of any size, refusals, frame rates, repeated runs.
void add_hard_sizes(std::vector<HardCase>& cases);

/// The chapter "Hard cases".
[[nodiscard]] ChapterWork hard_cases_work(const StudyDef& def);

}  // namespace corda::study
