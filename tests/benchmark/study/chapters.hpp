#pragma once

#include <functional>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "benchmark/study/measure.hpp"
#include "corda/scene/scene.hpp"

namespace corda::study {

/// How much a chapter measures, and of what.
struct Options {
    bool quick = false;  ///< fewer points and shorter runs: to see whether it works, not to quote from
    std::optional<Scene> scene;  ///< measured by measure_speed() in place of the built-in problems

    [[nodiscard]] Timing timing() const { return quick ? Timing{2, 0.002} : Timing{}; }
};

/// Called with the name of each measurement before it begins.
using OnRun = std::function<void(const std::string& what)>;

// The chapters. Each measures everything in this thread and returns its numbers as a JSON object, from which
// tests/benchmark/study.py makes tables and plots. Units are part of the keys; unknown numbers are null. A
// run that fails is part of the result, with the reason in "failure". All throw corda::Error.

/// Time and error of every method over its parameters, on the built-in problems or on the scene. Throws
/// kInvalidScene if no method can run the scene.
[[nodiscard]] nlohmann::json measure_speed(const Options& options, const OnRun& on_run);
/// The source report's findings (section 1 of src/corda/sim/README.md).
[[nodiscard]] nlohmann::json measure_findings(const Options& options, const OnRun& on_run);
/// The reference numbers (section 4 of src/corda/sim/README.md) by every method.
[[nodiscard]] nlohmann::json measure_accuracy(const Options& options, const OnRun& on_run);
/// The hard cases (section 5 of src/corda/sim/README.md).
[[nodiscard]] nlohmann::json measure_hard_cases(const Options& options, const OnRun& on_run);
/// XPBD with small steps beside method exact, on four pendulums.
[[nodiscard]] nlohmann::json measure_challenge(const Options& options, const OnRun& on_run);
/// The claimed horizons of random chaotic ropes, and when the true error passes the estimate.
[[nodiscard]] nlohmann::json measure_horizons(const Options& options, const OnRun& on_run);

/// A number, or null if there is none.
[[nodiscard]] inline nlohmann::json json_of(const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
}

}  // namespace corda::study
