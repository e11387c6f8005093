#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

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

/// Rows of a problem with a reference by the solver given, and by auto, which has to keep within
/// `auto_tolerance` of its length and claims a bound.
void add_problem_rows(const AccuracyRow& named, const Problem& problem, const sim::SolverDef& solver,
                      const std::string& method, const Timing& timing, std::vector<AccuracyRow>& rows);
void add_auto_row(const AccuracyRow& named, const Problem& problem, double auto_tolerance,
                  const Timing& timing, std::vector<AccuracyRow>& rows);

/// Runs `figures`, which fills the row's error and times; writes down why where it throws corda::Error.
void add_row(AccuracyRow row, const std::function<void(AccuracyRow&)>& figures,
             std::vector<AccuracyRow>& rows);

/// The chapter "Reference numbers".
[[nodiscard]] ChapterWork accuracy_work(const StudyDef& def);

}  // namespace corda::study
