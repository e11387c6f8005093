#pragma once

#include <array>
#include <vector>

#include "corda/study/truth.hpp"

namespace corda::study {

/// A position that others have published, to more digits than a double holds.
struct PublishedTip {
    double time_s = 0.0;
    sim::Vec2 tip_m;
};

/// The last particle of the source report's start, R11: PHYSICS section 4, reference/swing40.txt.
inline constexpr std::array<PublishedTip, 4> kReportTips{{
    {1.0, {3.414020640719306, -39.04020640719306}},
    {2.0, {1.9523468902633656, -39.123468902633476}},
    {5.0, {-4.628058819323613, -38.870017550078316}},
    {10.0, {3.798605351207355, -39.0037520751634}},
}};

/// A straight chain of unit masses released at rest, and where its tip is later: PHYSICS section 4, R5.
struct ReleasedChain {
    int links;
    double length_m;
    double angle_deg;
    double tip_mass_kg;  ///< of the last particle in all
    double time_s;
    sim::Vec2 tip_m;
};
inline constexpr std::array<ReleasedChain, 15> kReleasedChains{{
    {2, 2, 90, 1, 1, {-1.44481884994347579652, -1.32179446138146455585}},
    {2, 2, 90, 1, 5, {-1.55077846947044280041, -1.07591273481265245654}},
    {2, 2, 90, 1, 10, {-1.04076578324617048611, -1.70734766246932744698}},
    {2, 2, 179, 1, 5, {0.67314150466155481520, -0.62722634568900508337}},
    {3, 1, 90, 1, 5, {-0.53194662963776443892, 0.19179241928334740955}},
    {5, 1, 90, 1, 2, {0.83771529818003690575, -0.16765931615339712151}},
    {10, 1, 45, 1, 1, {-0.67948993189750683016, -0.72711223860003900537}},
    {10, 1, 45, 1, 5, {0.39214385389268969475, -0.90225644487398941636}},
    {10, 1, 90, 1, 1, {-0.91331222940637701239, -0.14965514141883061700}},
    {10, 1, 90, 1, 2, {0.47978859926682898140, -0.15417531322773500122}},
    {20, 1, 45, 1, 1, {-0.67016053525568878136, -0.73674338218714743406}},
    {20, 1, 45, 1, 2, {0.53700529500088304879, -0.81916411877801124437}},
    {20, 1, 90, 1, 1, {-0.90868883153230172068, -0.16339488036472364311}},
    {10, 1, 90, 1000, 2, {0.79574428267767040194, -0.60334843538712810990}},
    {10, 1, 90, 1000, 5, {0.92550693774088658561, -0.34521126487484581376}},
}};

/// A subject and the published positions of its tip, which both of its references are checked against.
struct BuiltInProblem {
    Subject subject;
    std::vector<PublishedTip> published;
};

/// The source report's swing as a true chain: 40 particles, g = 9.8, 10 s at 60 frames a second (R11).
[[nodiscard]] BuiltInProblem report_swing();
/// IFToMM benchmark A01: a pendulum for 2000 s, in closed form (R1).
[[nodiscard]] BuiltInProblem a01_pendulum();
/// 20 links from 45 degrees for 2 s (R5).
[[nodiscard]] BuiltInProblem released_chain();
/// A chain that turns as a rigid rod without gravity for 10 s, in closed form (R8).
[[nodiscard]] BuiltInProblem spinning_chain();

/// A row of R5 as a problem of frames 1/60 s apart, whose reference knows the tip at the row's time alone.
[[nodiscard]] Problem released_problem(const ReleasedChain& row);

/// Largest distance of a reference's last particle from the published tips, over the length. Times that the
/// reference does not know are left out.
[[nodiscard]] double distance_from_published(const Problem& problem, const std::vector<PublishedTip>& tips);

}  // namespace corda::study
