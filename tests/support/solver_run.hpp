#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "corda/sim/distance.hpp"
#include "corda/sim/simulation.hpp"

namespace corda::test {

/// Method rope with an order and a step.
inline sim::SolverDef rope_solver(int order, std::optional<double> step_s = std::nullopt) {
    sim::SolverDef def;
    def.method = sim::Method::kRope;
    def.order = order;
    def.step_s = step_s;
    return def;
}

/// Method exact with a tolerance.
inline sim::SolverDef exact_solver(double tolerance = 1e-9) {
    sim::SolverDef def;
    def.method = sim::Method::kExact;
    def.tolerance = tolerance;
    return def;
}

/// Any bodies under any method, driven without a Simulation, and what is watched of their energy.
class SolverRun {
  public:
    SolverRun(sim::System system, const sim::WorldDef& world, const sim::SolverDef& def)
        : system_(std::move(system)),
          solver_(sim::make_solver(system_, world, def, 1.0 / 60.0)),
          state_{0.0, system_.x_m, system_.y_m},
          start_energy_j_(solver_->energy_j()) {}
    SolverRun(const sim::RopeDef& rope, const sim::WorldDef& world, const sim::SolverDef& def)
        : SolverRun(sim::build_system({&rope, 1}, 1), world, def) {}
    SolverRun(const sim::NetDef& net, const sim::WorldDef& world, const sim::SolverDef& def)
        : SolverRun(sim::build_system({}, {&net, 1}, 1), world, def) {}

    /// Goes on to a time; false where the solver gives up.
    [[nodiscard]] bool go(double time_s) {
        if (solver_->advance_to(time_s, state_) != sim::Status::kOk) return false;
        const double change_j = std::abs(solver_->energy_j() - start_energy_j_);
        // Written so that a number that is none stays.
        if (!(change_j <= largest_change_j_)) largest_change_j_ = change_j;
        largest_move_m_ = std::max(largest_move_m_, distance_m({0.0, system_.x_m, system_.y_m}));
        return true;
    }
    /// The same with `looks` times on the way, at equal distances.
    [[nodiscard]] bool go(double time_s, int looks) {
        const double start_s = state_.time_s;
        for (int k = 1; k <= looks; ++k) {
            if (!go(start_s + (time_s - start_s) * k / looks)) return false;
        }
        return true;
    }

    [[nodiscard]] double tip_x() const { return state_.x_m.back(); }
    [[nodiscard]] double tip_y() const { return state_.y_m.back(); }
    /// Largest distance of a particle from where it is in another state.
    [[nodiscard]] double distance_m(const sim::State& other) const {
        double largest_m = 0.0;
        for (std::size_t i = 0; i < state_.x_m.size(); ++i) {
            const double apart_m = sim::length(state_.x_m[i] - other.x_m[i], state_.y_m[i] - other.y_m[i]);
            // Written so that a number that is none stays.
            if (!(apart_m <= largest_m)) largest_m = apart_m;
        }
        return largest_m;
    }
    /// Largest distance of a particle from its start so far.
    [[nodiscard]] double moved_m() const { return largest_move_m_; }
    /// Largest change of the energy over weight times length, or over what it was without a force.
    [[nodiscard]] double energy_error() const {
        const double scale_j = solver_->energy_scale_j();
        return largest_change_j_ / (scale_j > 0.0 ? scale_j : std::abs(start_energy_j_));
    }
    [[nodiscard]] const sim::State& state() const { return state_; }
    [[nodiscard]] const sim::System& system() const { return system_; }
    [[nodiscard]] sim::Solver& solver() { return *solver_; }

  private:
    sim::System system_;
    std::unique_ptr<sim::Solver> solver_;
    sim::State state_;
    double start_energy_j_;
    double largest_change_j_ = 0.0;
    double largest_move_m_ = 0.0;
};

/// A cloth of columns x rows unit masses `spacing_m` apart that hangs from the two ends of its top row, with
/// both diagonals in every square as imaginary bars.
inline sim::NetDef cloth(std::uint32_t columns, std::uint32_t rows, double spacing_m) {
    sim::NetDef net;
    const auto at = [&](std::uint32_t row, std::uint32_t column) { return row * columns + column; };
    for (std::uint32_t r = 0; r < rows; ++r) {
        for (std::uint32_t c = 0; c < columns; ++c) {
            net.points_m.push_back({spacing_m * c, -spacing_m * r});
            if (c + 1 < columns) net.bars.push_back({at(r, c), at(r, c + 1), true});
            if (r + 1 < rows) net.bars.push_back({at(r, c), at(r + 1, c), true});
        }
    }
    for (std::uint32_t r = 0; r + 1 < rows; ++r) {
        for (std::uint32_t c = 0; c + 1 < columns; ++c) {
            net.bars.push_back({at(r, c), at(r + 1, c + 1), false});
            net.bars.push_back({at(r, c + 1), at(r + 1, c), false});
        }
    }
    net.mass_kg.assign(net.points_m.size(), 1.0);
    net.velocity_m_s.assign(net.points_m.size(), {});
    net.pinned = {0, columns - 1};
    return net;
}

/// Slope of the straight line that fits log(error) against log(step) best.
inline double slope(std::span<const double> steps_s, std::span<const double> errors) {
    double x_mean = 0.0;
    double y_mean = 0.0;
    for (std::size_t i = 0; i < steps_s.size(); ++i) {
        x_mean += std::log(steps_s[i]) / static_cast<double>(steps_s.size());
        y_mean += std::log(errors[i]) / static_cast<double>(steps_s.size());
    }
    double xx = 0.0;
    double xy = 0.0;
    for (std::size_t i = 0; i < steps_s.size(); ++i) {
        const double x = std::log(steps_s[i]) - x_mean;
        xx += x * x;
        xy += x * (std::log(errors[i]) - y_mean);
    }
    return xy / xx;
}

}  // namespace corda::test
