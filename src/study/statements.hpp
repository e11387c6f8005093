#pragma once

#include <optional>
#include <span>
#include <string>

#include "corda/study/swings.hpp"

namespace corda::study {

// What the figures say about the source report's findings. The figures choose the words of each sentence:
// with other figures it says something else.

/// "About 7 n bars were best": for each mass, the reach at which one sweep is nearest to the true rope.
[[nodiscard]] std::string best_reach_statement(std::span<const SwingRow> rows);

/// "More mass makes the rope stiffer": strain over mass at reach 7 and one sweep, and how far two masses move
/// apart under gravity (difference_under_gravity()).
[[nodiscard]] std::string mass_statement(std::span<const SwingRow> rows, double difference_under_gravity);

/// "Less mass is livelier": largest speed of the tip over mass at reach 7 and one sweep.
[[nodiscard]] std::string speed_statement(std::span<const SwingRow> rows);

/// "With a mass below 1 the motion deteriorates": strain and error of the lightest rope over those of 1 kg,
/// at reach 7 and one sweep.
[[nodiscard]] std::string light_statement(std::span<const SwingRow> rows);

/// More sweeps: whether the most sweeps bring the bars of reach 7 nearer to the true rope or to the rod, at
/// 1 kg.
[[nodiscard]] std::string sweeps_statement(std::span<const SwingRow> rows);

/// "With many particles and few bars the motion deteriorates": rows of 1 kg and one sweep.
[[nodiscard]] std::string many_particles_statement(std::span<const SwingRow> rows);

/// Times to settle of relaxation and of the true rope with the same drag.
struct Settling {
    double delta = 0.0;
    double step_s = 0.0;
    double drag_1_s = 0.0;               ///< -ln(1 - delta) / step
    std::optional<double> relaxation_s;  ///< std::nullopt: not while it was watched
    std::optional<double> rope_s;
};
/// "The swing settles to the vertical": without and with damping.
[[nodiscard]] std::string settling_statement(std::span<const Settling> rows, double watched_s);

/// The report's highest update rate and that of this machine.
struct Rate {
    int particles = 0;
    double report_1_s = 0.0;
    double measured_1_s = 0.0;
};
[[nodiscard]] std::string rates_statement(std::span<const Rate> rates);

}  // namespace corda::study
