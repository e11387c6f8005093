#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmark/study/measure.hpp"

namespace corda::study {

/// The outcome of a hard case.
struct Outcome {
    std::string measured;
    bool passed = false;
};

/// A case of section 5 of src/corda/sim/README.md for one method. A study shows all of them; tests/stability
/// requires that they pass.
struct HardCase {
    enum class Kind {
        kQuick,
        kSlow,       ///< not run by a quick study, which says so
        kLong,       ///< nor by the tests, but in their long form
        kNotTested,  ///< nor by any test: passes by the time that it takes, or is known to fail
    };

    std::string name;
    std::string method;
    std::string criterion;
    Kind kind = Kind::kQuick;
    std::function<Outcome()> run;
};

// The cases, added to `cases`.

/// Motions: payloads, releases, throws, inverted and folded ropes, unequal links and masses.
void add_hard_motions(std::vector<HardCase>& cases);
/// Sizes and steps: long ropes, long runs, steps of any size, refusals, frame rates, repeated runs.
void add_hard_sizes(std::vector<HardCase>& cases);

/// All of these, and scene files that must be refused.
[[nodiscard]] std::vector<HardCase> hard_cases();

/// Runs a case. A corda::Error that it throws is its outcome.
[[nodiscard]] Outcome run_hard_case(const HardCase& hard);

/// The limits of a motion that is watched.
struct Limits {
    double duration_s;
    double strain;
    double energy_error;
    double frames_per_second = 60.0;  ///< at which it is looked at
};

/// Adds a case that passes if a motion stays within `limits`.
void add_watched(const std::string& name, const char* method_name, const RopeDef& rope,
                 const MethodDef& method, const Limits& limits, HardCase::Kind kind,
                 std::vector<HardCase>& cases);

}  // namespace corda::study
