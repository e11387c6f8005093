#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/study/probe.hpp"
#include "corda/study/study.hpp"
#include "corda/study/work.hpp"

namespace corda::study {

/// A figure against one that others have published (PHYSICS section 4).
struct AccuracyRow {
    std::string reference;  ///< "R5"
    std::string title;      ///< "10 links, 45 deg, 1 s"
    std::string quantity;   ///< what is compared: "tip / L"
    std::string method;
    double error = 0.0;
    std::optional<double> bound;  ///< what auto claims of the same quantity
    double wall_ms = 0.0;         ///< of one run
    std::optional<double> ms_per_simulated_s;
    std::string failure;  ///< empty where there is a figure
};

/// A row that no method has filled yet.
[[nodiscard]] AccuracyRow named_row(std::string reference, std::string title, std::string quantity);

/// The rows of one reference.
struct AccuracyCase {
    std::string reference;
    std::string title;  ///< of the reference, for the short table
    std::function<void(const StudyDef& def, std::vector<AccuracyRow>& rows)> run;
};

/// R1 to R3 and R10: bodies whose motion has a closed form.
[[nodiscard]] std::vector<AccuracyCase> pendulum_cases();
/// R4 to R8 and R11: chains.
[[nodiscard]] std::vector<AccuracyCase> chain_cases();
/// R9 and a spring: links that are slack, or stretch.
[[nodiscard]] std::vector<AccuracyCase> material_cases();

/// A method under the name that its rows have.
struct NamedMethod {
    const char* name = "";
    sim::SolverDef solver;
};

/// Rows of a problem with a reference by auto, which has to keep within 1e-6 of its length and claims a
/// bound, and by each method.
void add_problem_rows(const AccuracyRow& named, const Problem& problem, std::span<const NamedMethod> methods,
                      const Timing& timing, std::vector<AccuracyRow>& rows);

/// A row of each method: `error_of` runs one rope, the way that the reference asks for, and returns the
/// error. `simulated_s` is how far it runs it. Writes down why where corda::Error is thrown.
void add_probe_rows(const AccuracyRow& named, const sim::RopeDef& rope, const sim::WorldDef& world,
                    std::span<const NamedMethod> methods, double simulated_s,
                    const std::function<double(Probe&)>& error_of, std::vector<AccuracyRow>& rows);

/// Runs `figures`, which fills the row's error and times; writes down why where it throws corda::Error.
void add_row(AccuracyRow row, const std::function<void(AccuracyRow&)>& figures,
             std::vector<AccuracyRow>& rows);

/// The chapter "Reference numbers".
[[nodiscard]] ChapterWork accuracy_work(const StudyDef& def);

}  // namespace corda::study
