#pragma once

#include <array>

#include "support/ropes.hpp"

namespace corda::test {

/// A straight chain of unit masses released at rest, and where its tip is later.
struct ReleasedChain {
    int links;
    double length_m;
    double angle_deg;
    double tip_mass_kg;  ///< of the last particle in all
    double time_s;
    sim::Vec2 tip_m;

    [[nodiscard]] sim::RopeDef rope() const {
        sim::RopeDef def = straight_rope(links, length_m, angle_deg);
        def.mass_kg.back() = tip_mass_kg;
        return def;
    }
};

/// PHYSICS section 4, R5: computed to more digits than double holds, g = 9.81.
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

}  // namespace corda::test
