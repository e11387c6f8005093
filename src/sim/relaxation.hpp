#pragma once

#include <cstdint>
#include <vector>

#include "corda/sim/solver.hpp"

namespace corda::sim {

/// The source report's method (PHYSICS section 1): Verlet's update of every free particle, then passes over
/// all bars, each pushing its two particles along its new direction until it has its rest length.
///
///   next = current + (1 - delta) (current - previous) + (h^2 / m) f
///   adjust = distance - rest, direction = (p2 - p1) / distance; each of two free particles moves by adjust /
///   2 towards the other, a free one beside a pinned one by the whole of it.
///
/// The update is kept in its summed form: a particle carries its last move d = current - previous, and
/// d <- (1 - delta) d + (h^2 / m) f, current <- current + d, then d takes up what the bars moved. The same
/// numbers but for rounding, which grows with the number of steps in place of its square (Hairer, Lubich,
/// Wanner, Geometric Numerical Integration, VIII.5).
///
/// Its first position is an Euler step, x(h) = x(0) + h v(0), so that the state at n h is Verlet's after n -
/// 1 updates and free fall is late by -g h t / 2: a property of the method, kept. Bars go one after the other
/// in the order of System::bars. Drag is damping too: with a rate c, 1 - delta is multiplied by exp(-c h).
///
/// Times that are no multiple of the step are read off the parabola through the three nearest states.
class Relaxation final : public Solver {
  public:
    Relaxation(const System& system, const WorldDef& world, const SolverDef& def, double default_step_s);

    Status advance_to(double time_s, State& state) override;
    [[nodiscard]] double energy_j() const override;
    [[nodiscard]] double energy_scale_j() const override;
    [[nodiscard]] bool conserves_energy() const override { return keep_ == 1.0; }
    [[nodiscard]] std::uint64_t steps() const override { return step_; }

  private:
    struct Constraint {
        std::uint32_t a;
        std::uint32_t b;
        double rest_m;
        double share_a;  ///< of the adjustment: 0, 1/2 or 1
        double share_b;
    };
    void step();
    void relax();  ///< one pass over all bars
    void interpolate(double fraction, State& state) const;

    double step_s_;
    double keep_;  ///< share of the velocity kept a step, (1 - delta) exp(-c h)
    int sweeps_;
    std::uint64_t step_ = 0;  ///< x and y are the positions at step_ * step_s_
    // The last moves and those before, and the positions before the bars' moves, are of the same shape as x
    // and y.
    std::vector<double> x_m_;
    std::vector<double> y_m_;
    std::vector<double> move_x_m_;  ///< x at step_ less x at step_ - 1; before the first step, h v(0)
    std::vector<double> move_y_m_;
    std::vector<double> last_move_x_m_;
    std::vector<double> last_move_y_m_;
    std::vector<double> unrelaxed_x_m_;
    std::vector<double> unrelaxed_y_m_;
    std::vector<double> mass_kg_;
    std::vector<double> force_x_n_;  ///< 0 for a pinned particle
    std::vector<double> force_y_n_;
    std::vector<double> push_x_m_;  ///< (h^2 / m) f
    std::vector<double> push_y_m_;
    std::vector<Constraint> constraints_;
    double energy_scale_j_ = 0.0;
};

}  // namespace corda::sim
