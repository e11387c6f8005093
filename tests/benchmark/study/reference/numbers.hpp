#pragma once

#include <algorithm>
#include <array>

#include "corda/sim/defs.hpp"

namespace corda::reference {

// Reference numbers R1 to R7 and R11, computed independently of Corda. Their definitions and sources are in
// section 4 of src/corda/sim/README.md. They have more digits than a double holds unless a table says
// otherwise; masses are 1 kg and lengths 1 m likewise.

/// The gravity that all of them take, in m/s^2.
inline constexpr double kGravity = 9.81;

/// R1, IFToMM benchmark A01: the period of a pendulum released from the horizontal.
inline constexpr double kA01PeriodSeconds = 2.3678419475762374;

/// R2: the period of a pendulum for small swings, 2 pi sqrt(L / g).
inline constexpr double kSmallSwingSeconds = 2.006066680710647;

/// R2: the period of a pendulum that swings up to an angle, as a ratio: (2 / pi) K(sin(angle / 2)).
struct SwingPeriod {
    double angle_deg;  ///< from straight down, below 180
    double ratio;      ///< period over kSmallSwingSeconds
};
inline constexpr std::array<SwingPeriod, 9> kSwingPeriods{{
    {10, 1.0019071881432166},
    {45, 1.0399733431968039},
    {90, 1.1803405990160962},
    {120, 1.3728805006183502},
    {150, 1.762203729503756},
    {170, 2.4393627196738841},
    {179, 3.9010651603890857},
    {179.9, 5.3668671090259463},
    {179.99, 6.832737338014762},
}};

/// R2: the time of a full turn of a pendulum that passes the bottom with v^2 = 6 g L.
inline constexpr double kFullTurnSeconds = 1.0578477230355216;

/// R3: the period, from the horizontal, of a rigid rod of equal masses that are evenly spaced from the pin.
struct RodPeriod {
    int links;  ///< also the number of moving masses
    double period_s;
};
inline constexpr std::array<RodPeriod, 5> kRodPeriods{{
    {2, 2.161534078824117},
    {5, 2.027698701742412},
    {10, 1.981078706687632},
    {20, 1.957352357296146},
    {50, 1.942977482042899},
}};

/// R4: a small oscillation of a hanging chain. If all masses are equal, omega^2 = (g / a) z with a zero z of
/// the Laguerre polynomial L_N.
struct SmallOscillation {
    int links;
    double tip_mass_kg;  ///< of the last particle, in all
    double omega_1_s;
};
inline constexpr std::array<SmallOscillation, 13> kSmallOscillations{{
    {5, 1, 3.5955018679142},
    {10, 1, 3.6766206576178},
    {10, 1, 8.4592843258908},
    {10, 1, 54.177674155542},
    {20, 1, 3.7202051499303},
    {20, 1, 8.5446639308937},
    {20, 1, 114.245746189},
    {50, 1, 3.7474350221806},
    {50, 1, 8.6027948917509},
    {50, 1, 297.71217239},
    {10, 10, 3.3130928700043},
    {10, 100, 3.1568078379578},
    {10, 1000, 3.1346641280336},
}};

/// R5: a straight chain of unit masses, released at rest, and the place of its tip at a later time.
struct ReleasedChain {
    int links;
    double length_m;
    double angle_deg;    ///< from straight down towards +x
    double tip_mass_kg;  ///< of the last particle, in all
    double time_s;
    Vec2 tip_m;  ///< from the pin
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

/// The tip in the row of R5 that has these numbers and equal masses. Does not compile if there is none.
[[nodiscard]] consteval Vec2 released_tip_m(int links, double angle_deg, double time_s) {
    return std::ranges::find_if(kReleasedChains,
                                [&](const ReleasedChain& row) {
                                    return row.links == links && row.angle_deg == angle_deg &&
                                           row.time_s == time_s && row.tip_mass_kg == 1.0;
                                })
        ->tip_m;
}

/// R6: a chain of 1.5 m in all that hangs at rest between two pins 1 m apart.
struct HangingChain {
    int links;
    double tension_over_weight;  ///< horizontal tension over the weight of a particle
    double lowest_m;             ///< y of the lowest particle, measured from the pins
};
inline constexpr std::array<HangingChain, 3> kHangingChains{{
    {10, 2.0510510143091193, -0.50594593157108448},
    {20, 4.107878988926029, -0.50344663434019265},
    {40, 8.2186678030027642, -0.50283577286535318},
}};

/// R7: a folded chain that hangs down by half of its links, goes across by one and up again; the end that is
/// up is let go. To 7 digits.
struct FoldedChain {
    int links;                      ///< odd
    std::array<double, 3> times_s;  ///< at which the tip has fallen .25, .5, .75 m
};
inline constexpr std::array<FoldedChain, 3> kFoldedChains{{
    {21, {.2261503, .3137222, .3707585}},
    {41, {.2242086, .3088361, .3646133}},
    {81, {.2226169, .3062475, .3606003}},
}};

/// Where the tip of a chain is at a time.
struct PublishedTip {
    double time_s;
    Vec2 tip_m;
};

/// R11: the last particle of the source report's start, 40 particles, g = 9.8 m/s^2. All particles:
/// tests/accuracy/data/swing40.txt.
inline constexpr std::array<PublishedTip, 4> kReportTips{{
    {1.0, {3.414020640719306, -39.04020640719306}},
    {2.0, {1.9523468902633656, -39.123468902633476}},
    {5.0, {-4.628058819323613, -38.870017550078316}},
    {10.0, {3.798605351207355, -39.0037520751634}},
}};

/// The highest update rate in the source report's table (section 1 of src/corda/sim/README.md): its steps,
/// with drawing, for bars of reach 7.
struct ReportRate {
    int particles;
    double updates_per_s;
};
inline constexpr std::array<ReportRate, 4> kReportRates{{{20, 610}, {40, 270}, {80, 140}, {100, 115}}};

}  // namespace corda::reference
