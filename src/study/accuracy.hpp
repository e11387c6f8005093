#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/study/measure.hpp"
#include "corda/study/study.hpp"

namespace corda::study {

/// The error of a method against a reference number (section 4 of src/sim/README.md).
struct AccuracyRow {
    std::string reference;  ///< "R5"
    std::string title;      ///< "10 links, 45 deg, 1 s"
    std::string quantity;   ///< what is compared: "tip / L"
    std::string method = {};
    double error = 0.0;
    std::optional<double> bound = {};  ///< the bound that auto claims for the same quantity
    double wall_ms = 0.0;              ///< of one run
    double ms_per_simulated_s = 0.0;
    std::string failure = {};  ///< empty if there is an error
};

/// The rows of one reference.
struct AccuracyCase {
    std::string reference;
    std::string title;
    std::function<void(bool is_quick, std::vector<AccuracyRow>& rows)> run;
};

/// R1 to R3 and R10: bodies whose motion has a closed form.
[[nodiscard]] std::vector<AccuracyCase> pendulum_cases();
/// R4 to R8 and R11: chains.
[[nodiscard]] std::vector<AccuracyCase> chain_cases();
/// R9 and a spring: links that hang slack or stretch.
[[nodiscard]] std::vector<AccuracyCase> material_cases();

/// A method and its name in the rows.
struct NamedMethod {
    const char* name = "";
    MethodDef method;
};

/// Adds rows of a problem with a reference: one for auto, which has to stay within 1e-6 L and claims a bound,
/// and one per method. `named` has the reference, the title and the quantity.
void add_problem_rows(const AccuracyRow& named, const Problem& problem, std::span<const NamedMethod> methods,
                      const Timing& timing, std::vector<AccuracyRow>& rows);

/// Adds one row per method. `error_of` runs the rope for `simulated_s` seconds and returns the error; if it
/// throws corda::Error, the row says why.
void add_probe_rows(const AccuracyRow& named, const RopeDef& rope, const WorldDef& world,
                    std::span<const NamedMethod> methods, double simulated_s,
                    const std::function<double(Probe&)>& error_of, std::vector<AccuracyRow>& rows);

/// The chapter "Reference numbers".
[[nodiscard]] ChapterWork accuracy_work(const StudyDef& def);

}  // namespace corda::study
