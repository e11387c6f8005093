#pragma once

#include <optional>
#include <span>
#include <string>

#include "corda/study/swings.hpp"

namespace corda::study {

// What the study's figures say of the source report's findings. Every sentence is chosen by the figures that
// it is given: other figures, another sentence.

/// "About 7 n bars were best": by the reach at which one pass over the bars is nearest to the true rope and
/// to the rod, for each mass. Rows with other numbers of sweeps are left out.
[[nodiscard]] std::string best_reach_statement(std::span<const SwingRow> rows);

/// "More mass makes the rope stiffer": by the strain at reach 7 and one sweep over the masses, and by how far
/// apart masses are under gravity (difference_under_gravity()).
[[nodiscard]] std::string mass_statement(std::span<const SwingRow> rows, double difference_under_gravity);

/// "Less mass is livelier": by the largest speed of the tip at reach 7 and one sweep over the masses.
[[nodiscard]] std::string speed_statement(std::span<const SwingRow> rows);

/// "With a mass below 1 the motion deteriorates": by strain and error of the lightest rows against those of 1
/// kg, at reach 7 and one sweep.
[[nodiscard]] std::string light_statement(std::span<const SwingRow> rows);

/// "More sweeps": whether 16 passes bring the bars of reach 7 nearer to the true rope or to the rod, at 1 kg.
[[nodiscard]] std::string sweeps_statement(std::span<const SwingRow> rows);

/// "With many particles and few bars the motion deteriorates": by the rows of 1 kg and one sweep.
[[nodiscard]] std::string many_particles_statement(std::span<const SwingRow> rows);

/// "The swing settles to the vertical": times without and with damping, of relaxation and of the true rope.
struct Settling {
    double delta = 0.0;
    double step_s = 0.0;
    double drag_1_s = 0.0;               ///< -ln(1 - delta) / step
    std::optional<double> relaxation_s;  ///< nothing: not within the time it was watched
    std::optional<double> rope_s;
};
[[nodiscard]] std::string settling_statement(std::span<const Settling> rows, double watched_s);

/// Highest update rates, report's and ours.
struct Rate {
    int particles = 0;
    double report_1_s = 0.0;
    double measured_1_s = 0.0;
};
[[nodiscard]] std::string rates_statement(std::span<const Rate> rates);

}  // namespace corda::study
