#pragma once

#include <optional>
#include <string>
#include <vector>

#include "benchmark/study/measure.hpp"

namespace corda::study {

/// The source report's swing by its own method: a line of particles with step (0.1, -1) and a force of
/// (0, -9.8) N per particle, whatever its mass, without damping, in steps of 1/60 s.
struct SwingDef {
    int particles = 40;
    double mass_kg = 1.0;
    int reach = 7;
    int sweeps = 1;
};

/// Errors and strain of a swing over two periods of the rigid rod that starts in the same way.
struct SwingFigures {
    double strain = 0.0;        ///< largest of a link
    double rope_error = 0.0;    ///< from the true rope (exact): largest, over the frames, of the RMS over L
    double rod_error = 0.0;     ///< the same from the rigid rod (closed form, R3)
    double energy_error = 0.0;  ///< largest, over the total force times L
    double tip_speed_m_s = 0.0;
    std::string failure;  ///< empty if the run went through
};

/// The true rope at the frames 1, 2, ... of a swing, 1/60 s apart.
[[nodiscard]] std::vector<State> true_swing(int particles, double mass_kg);

/// Runs a swing. `truth` is true_swing() of its particles and mass.
[[nodiscard]] SwingFigures watch_swing(const SwingDef& def, const std::vector<State>& truth);

/// Steps per second that relaxation takes on a swing.
[[nodiscard]] double updates_per_second(const SwingDef& def, const Timing& timing);

/// Largest distance, over L, of two swings of these masses in 10 s under gravity: a force that is
/// proportional to mass instead of the constant one.
[[nodiscard]] double difference_under_gravity(double mass_kg, double other_mass_kg);

/// The time after which every particle stays within a hundredth of L from the vertical until `limit_s`;
/// std::nullopt if there is none. 40 unit masses, g = 9.8 m/s^2.
[[nodiscard]] std::optional<double> settling_time_s(const MethodDef& method, double drag_1_s, double limit_s);

}  // namespace corda::study
