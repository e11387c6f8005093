#pragma once

#include <optional>
#include <string>

#include "corda/study/measure.hpp"

namespace corda::study {

/// Two tight runs that part by more than this share of the length can predict nothing any more: the end of
/// what is compared.
inline constexpr double kHorizonDifference = 1e-9;

/// A problem and what each method is held against: never a run of its own kind.
struct Subject {
    Problem problem;  ///< `reference` and `truth` are what relaxation and rope are held against
    /// What exact is held against where that is something else.
    Reference exact_reference;
    std::string exact_truth;
    /// How far the two references are apart: largest over the frames of the RMS / length. Nothing where there
    /// is one reference alone, e.g. a closed form.
    std::optional<double> disagreement;
    std::optional<double> horizon_s;  ///< nothing where every frame can be predicted
};

/// The problem as `method` faces it.
[[nodiscard]] Problem facing(const Subject& subject, sim::Method method);

/// Finds the references of a subject that has none, by two tight runs: exact at a tolerance of 1e-14, and
/// rope of order 8 at a quarter of a stable step. Where only one of them can run the problem, both are runs
/// of it, one tighter, which the truth's words say; where neither can, there is no reference. Frames after
/// the horizon are left out. Throws corda::Error for a problem that no method can run.
void find_truth(Subject& subject);

/// The step that rope of this order chooses for a problem by itself, in seconds. Throws corda::Error where
/// rope cannot run it.
[[nodiscard]] double rope_step_s(const Problem& problem, int order);

/// Why a method cannot run a problem; empty where it can.
[[nodiscard]] std::string refusal(const Problem& problem, const sim::SolverDef& solver);

}  // namespace corda::study
