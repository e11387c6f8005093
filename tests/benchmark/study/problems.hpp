#pragma once

#include <optional>
#include <string>

#include "benchmark/study/measure.hpp"
#include "benchmark/study/reference/numbers.hpp"
#include "corda/scene/scene.hpp"

namespace corda::study {

/// The source report's swing as a true chain: 40 particles, g = 9.8 m/s^2, 10 s (the start of R11).
[[nodiscard]] Problem report_swing();
/// IFToMM benchmark A01: a pendulum for 2000 s, with its closed form (R1).
[[nodiscard]] Problem a01_pendulum();
/// 20 links from 45 degrees for 2 s (a start of R5).
[[nodiscard]] Problem released_chain();
/// A chain that turns like a rigid rod without gravity for 10 s, with its closed form (R8).
[[nodiscard]] Problem spinning_chain(double omega_1_s = 3.0);

/// A row of R5, whose reference knows only the tip at the row's time.
[[nodiscard]] Problem released_problem(const reference::ReleasedChain& row);

/// Sets the tip, and NaN for every other particle, which is then not compared. Returns true.
bool set_tip(Vec2 tip_m, State& state);

/// A rope without a reference.
[[nodiscard]] Problem problem_of(const RopeDef& rope, double duration_s);
/// A scene without imaginary bars; its truth is left to find_truth().
[[nodiscard]] Problem problem_of(const Scene& scene);

/// If two tight runs differ by more than this fraction of the length, neither predicts the motion any more:
/// the horizon.
inline constexpr double kHorizonDifference = 1e-9;

/// A problem and what each method is compared with: never a run of the same method, if another can run it.
struct Subject {
    Problem problem;  ///< its `reference` and `truth` are for relaxation and rattle
    /// For exact, if it is compared with something else.
    Reference exact_reference;
    std::string exact_truth;
    /// Difference of the two references: largest, over the frames, of the RMS distance over L. std::nullopt
    /// if there is only one, e.g. a closed form.
    std::optional<double> disagreement;
    std::optional<double> horizon_s;  ///< std::nullopt: every frame can be predicted
};

/// The problem with the reference that `method` is compared with.
[[nodiscard]] Problem facing(const Subject& subject, const MethodDef& method);

/// Makes the references of a subject that has none from two tight runs: exact at a tolerance of 1e-14, and
/// rattle of order 8 at a quarter of its own step. If only one of the methods can run the problem, both are
/// runs of it, and `truth` says so; if neither can, there is no reference. Frames after the horizon are not
/// compared. Throws corda::Error if no method can run the problem.
void find_truth(Subject& subject);

/// The step in seconds that rattle of this order chooses by itself. Throws corda::Error if it cannot run the
/// problem.
[[nodiscard]] double rattle_step_s(const Problem& problem, int order);

/// Why a method cannot run a problem; empty if it can.
[[nodiscard]] std::string refusal(const Problem& problem, const MethodDef& method);

}  // namespace corda::study
