#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "corda/sim/distance.hpp"
#include "corda/sim/exact.hpp"

namespace corda::test {

/// One rope under the method `exact`, driven without a Simulation.
class ExactRun {
  public:
    explicit ExactRun(const sim::RopeDef& rope, double tolerance = 1e-9, sim::WorldDef world = {})
        : system(sim::build_system({&rope, 1}, 1)),
          solver(system, world, def(tolerance), 1.0 / 60.0),
          state{0.0, system.x_m, system.y_m},
          start_energy_j_(solver.energy_j()) {}

    bool advance_to(double time_s) { return solver.advance_to(time_s, state) == sim::Status::kOk; }

    /// | E(t) - E(0) | over weight times length, or over E(0) without a force.
    [[nodiscard]] double energy_error() const {
        const double scale_j = solver.energy_scale_j();
        return std::abs(solver.energy_j() - start_energy_j_) /
               (scale_j > 0.0 ? scale_j : std::abs(start_energy_j_));
    }

    /// Largest | length / rest length - 1 | of a link.
    [[nodiscard]] double strain() const {
        double largest = 0.0;
        for (const sim::Bar& bar : system.bars) {
            const double distance_m =
                sim::length(state.x_m[bar.b] - state.x_m[bar.a], state.y_m[bar.b] - state.y_m[bar.a]);
            largest = std::max(largest, std::abs(distance_m / bar.rest_m - 1.0));
        }
        return largest;
    }

    [[nodiscard]] double tip_error_m(double x_m, double y_m) const {
        return sim::length(state.x_m.back() - x_m, state.y_m.back() - y_m);
    }

    sim::System system;
    sim::Exact solver;
    sim::State state;

  private:
    static sim::SolverDef def(double tolerance) {
        sim::SolverDef def;
        def.tolerance = tolerance;
        return def;
    }
    double start_energy_j_;
};

/// Where a function changes its sign between two times, by the Illinois form of regula falsi.
inline double root(const std::function<double(double)>& f, double low, double high) {
    double f_low = f(low);
    double f_high = f(high);
    double middle = low;
    for (int k = 0; k < 60 && std::abs(high - low) > 1e-15 * std::abs(high); ++k) {
        const double last = middle;
        middle = (low * f_high - high * f_low) / (f_high - f_low);
        if (middle == last) break;
        const double f_middle = f(middle);
        if (f_middle == 0.0) break;
        if ((f_middle < 0.0) != (f_high < 0.0)) {
            low = high;
            f_low = f_high;
        } else {
            f_low *= 0.5;
        }
        high = middle;
        f_high = f_middle;
    }
    return middle;
}

}  // namespace corda::test
