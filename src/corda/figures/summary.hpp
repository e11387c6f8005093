#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "corda/pipeline/film.hpp"
#include "corda/pipeline/tracked_particle.hpp"

namespace corda::figures {

/// Figures of a motion at its frame times. src/corda/python/README.md has the formulas. std::nullopt: not applicable.
struct Summary {
    std::optional<double> period_s;
    std::optional<double> angle_max_deg;
    std::optional<double> tension_max_n;
    std::optional<double> speed_max_m_s;
    std::optional<double> strain_max;
    std::optional<double> energy_error;
    std::optional<double> error_estimate_m;
    std::optional<double> error_estimate_px;
    std::optional<double> horizon_s;
};

struct SummaryColumn {
    std::string_view name;  ///< in files, with its unit
    std::optional<double> Summary::*value;
};

/// All columns, in the order of Summary.
[[nodiscard]] std::span<const SummaryColumn> summary_columns();

/// Summarises a motion from its states at the frame times, which are added in order.
class SummaryReader {
  public:
    /// The film's states have velocities and tensions.
    explicit SummaryReader(Film& film);
    void add(const State& state);
    [[nodiscard]] Summary summary();
    /// The times from each pass below the pin to the second next one; none if it does not swing to and fro.
    [[nodiscard]] std::vector<double> periods_s() const;

  private:
    /// The tracked particle seen from the pin of its body: x and y in m, their rates in m/s.
    struct Arm {
        double time_s, x_m, y_m, vx_m_s, vy_m_s;

        [[nodiscard]] double angle_rad() const;  ///< from straight down
        [[nodiscard]] double rate_rad_s() const;
    };
    void add_arm(const Arm& arm);

    Film* film_;
    std::optional<pipeline::TrackedParticle> tracked_;
    std::optional<Arm> last_;
    double angle_max_rad_ = 0.0;
    std::vector<double> passes_s_;  ///< below the pin
    double last_direction_ = 0.0;
    bool swings_ = true;
    Summary summary_;
};

}  // namespace corda::figures
