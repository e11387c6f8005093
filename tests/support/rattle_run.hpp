#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "corda/sim/rattle.hpp"

namespace corda::test {

/// One rope with the method `rope`, driven directly, and what is watched of it.
class RattleRun {
  public:
    RattleRun(const sim::RopeDef& rope, const sim::WorldDef& world, int order,
              std::optional<double> step_s = std::nullopt)
        : system_(sim::build_system({&rope, 1}, 1)),
          solver_(system_, world, solver_def(order, step_s), 1.0 / 60.0),
          state_{0.0, system_.x_m, system_.y_m},
          start_energy_j_(solver_.energy_j()) {}

    /// Goes on to a time; false where the solver gives up.
    [[nodiscard]] bool go(double time_s) {
        if (solver_.advance_to(time_s, state_) != sim::Status::kOk) return false;
        const double change_j = std::abs(solver_.energy_j() - start_energy_j_);
        // Written so that a number that is none stays.
        if (!(change_j <= largest_change_j_)) largest_change_j_ = change_j;
        for (const sim::Bar& bar : system_.bars) {
            const double dx = state_.x_m[bar.b] - state_.x_m[bar.a];
            const double dy = state_.y_m[bar.b] - state_.y_m[bar.a];
            const double strain = std::abs(std::sqrt(dx * dx + dy * dy) / bar.rest_m - 1.0);
            if (!(strain <= max_strain_)) max_strain_ = strain;
        }
        return true;
    }
    /// Goes to a time and looks at it `looks` times on the way, at equal distances.
    [[nodiscard]] bool go(double time_s, int looks) {
        const double start_s = state_.time_s;
        for (int k = 1; k <= looks; ++k) {
            if (!go(start_s + (time_s - start_s) * k / looks)) return false;
        }
        return true;
    }

    [[nodiscard]] double tip_x() const { return state_.x_m.back(); }
    [[nodiscard]] double tip_y() const { return state_.y_m.back(); }
    [[nodiscard]] double tip_distance(double x, double y) const {
        return std::sqrt((tip_x() - x) * (tip_x() - x) + (tip_y() - y) * (tip_y() - y));
    }
    [[nodiscard]] double max_strain() const { return max_strain_; }
    /// Largest change of the energy over weight times length.
    [[nodiscard]] double energy_error() const { return largest_change_j_ / solver_.energy_scale_j(); }
    [[nodiscard]] double largest_energy_change_j() const { return largest_change_j_; }
    [[nodiscard]] const sim::State& state() const { return state_; }
    [[nodiscard]] const sim::System& system() const { return system_; }
    [[nodiscard]] sim::Rattle& solver() { return solver_; }

  private:
    static sim::SolverDef solver_def(int order, std::optional<double> step_s) {
        sim::SolverDef def;
        def.order = order;
        def.step_s = step_s;
        return def;
    }

    sim::System system_;
    sim::Rattle solver_;
    sim::State state_;
    double start_energy_j_;
    double largest_change_j_ = 0.0;
    double max_strain_ = 0.0;
};

}  // namespace corda::test
