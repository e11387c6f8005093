#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "benchmark/study/measure.hpp"

namespace corda::study {

/// A method and its name in the tables.
struct AccuracyMethod {
    const char* name = "";
    MethodDef method;
    double bound = 0.0;  ///< the error stays below it; tests/accuracy holds the method to it
};

/// A problem with a known answer (section 4 of src/corda/sim/README.md) and the methods that run it, in a
/// study and in tests/accuracy.
struct AccuracyCase {
    std::string reference;  ///< "R5"
    std::string subject;    ///< of all cases of the reference: "released chains"
    std::string title;      ///< "N = 10, 45 deg, 1 s"
    std::string quantity;   ///< compared quantity: "tip / L"
    Problem problem;        ///< of one rope; its world's duration is the simulated time
    /// Runs the rope for that time and returns the error. Empty: the largest distance from the problem's
    /// reference over L, at every frame; method auto then has a row as well, for a tolerance of 1e-6 L.
    std::function<double(Probe&)> error_of = {};
    std::vector<AccuracyMethod> methods = {};
    bool is_slow = false;  ///< not run by a quick study
};

/// The outcome of one method.
struct AccuracyRow {
    std::string title;  ///< of the case; for auto with the method that it chose
    std::string method;
    double error = 0.0;
    std::optional<double> bound;  ///< of auto: its error estimate
    double wall_ms = 0.0;         ///< of one run
    double ms_per_simulated_s = 0.0;
    std::string failure;  ///< empty if there is an error
};

// The cases, added to `cases`.

/// R1 to R3 and R10: bodies whose motion has a closed form.
void add_pendulum_cases(std::vector<AccuracyCase>& cases);
/// R4 to R8 and R11: chains.
void add_chain_cases(std::vector<AccuracyCase>& cases);
/// R9 and a spring: links that hang slack or stretch.
void add_material_cases(std::vector<AccuracyCase>& cases);

/// All of these.
[[nodiscard]] std::vector<AccuracyCase> accuracy_cases();

/// Runs a case by each of its methods. A run that fails has a row that says why.
[[nodiscard]] std::vector<AccuracyRow> run_accuracy_case(const AccuracyCase& given, const Timing& timing);

}  // namespace corda::study
