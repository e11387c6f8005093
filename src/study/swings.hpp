#pragma once

#include <optional>
#include <string>
#include <vector>

#include "corda/sim/solver.hpp"

namespace corda::study {

/// The source report's swing by its own method: a line with step (0.1, -1), a force of (0, -9.8) N on every
/// particle whatever its mass, no damping.
struct SwingDef {
    int particles = 40;
    double mass_kg = 1.0;
    int reach = 7;
    int sweeps = 1;
};

/// What a swing showed, over two periods of the rigid rod that starts the same way.
struct SwingFigures {
    double strain = 0.0;      ///< largest of a real bar
    double rope_error = 0.0;  ///< from the true rope (exact): largest over the frames of the RMS / length
    double rod_error = 0.0;   ///< the same from the rigid rod (closed form, R3)
    /// Share of the swing's energy above hanging at rest that is lost a period; negative where it is won.
    double energy_lost = 0.0;
    double tip_speed_m_s = 0.0;  ///< largest, from frame to frame
    std::string failure;         ///< empty where the run went through
};

/// A row of the study of bars.
struct SwingRow {
    SwingDef def;
    SwingFigures figures;
};

/// The true rope of a swing at its frames 1, 2, ... 1/60 s apart, for two periods of the rod.
[[nodiscard]] std::vector<sim::State> true_swing(int particles, double mass_kg);

/// Runs a swing, step 1/60 s. `truth` is true_swing() of its particles and mass.
[[nodiscard]] SwingFigures watch_swing(const SwingDef& def, const std::vector<sim::State>& truth);

/// Steps a second that relaxation takes on the report's swing with bars of reach 7: the best of five tries of
/// `shortest_s`.
[[nodiscard]] double updates_per_second(int particles, double shortest_s);

/// How far apart two swings of different masses ever get in 10 s under gravity, in lengths: a force in
/// proportion to mass in place of the constant one.
[[nodiscard]] double difference_under_gravity(double mass_kg, double other_mass_kg);

/// The time after which no particle is more than a hundredth of the length from the vertical until `limit_s`,
/// by frames; nothing where that is not before the limit. 40 unit masses, g = 9.8.
[[nodiscard]] std::optional<double> settling_time_s(const sim::SolverDef& solver, double drag_1_s,
                                                    double limit_s);

}  // namespace corda::study
