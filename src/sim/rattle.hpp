#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "corda/sim/composition.hpp"
#include "corda/sim/constraint_solver.hpp"
#include "corda/sim/elastic_forces.hpp"
#include "corda/sim/solver.hpp"
#include "corda/sim/terms.hpp"

namespace corda::sim {

/// The method `rope`: RATTLE (Andersen 1983; Hairer, Lubich, Wanner, Geometric Numerical Integration,
/// VII.1.4) composed to order 2, 4, 6 or 8. A stage of span s, which may be negative, is
///
///   v <- exp(-c s / 2) v + (s / 2) a(x) + W G(x)' p,  x <- x + s v with p such that all rigid bars have
///   their lengths, v <- exp(-c s / 2) (v + (s / 2) a(x)) + W G(x)' q with q such that no rigid bar's length
///   changes,
///
/// where a is gravity and, where bars stretch or ropes resist bending, the forces of that (ElasticForces)
/// over the mass. Without rigid bars it is the leapfrog. Drag is split off symmetrically and exact. q and the
/// next stage's p lie along the same bars, and p makes up for any q: the solver leaves q out between stages,
/// merges the half kicks that meet, and finds q only for the state that it hands out. The positions are the
/// same. Where a string that stretches comes taut, its force has a kink, and errors are of order 2 whatever
/// the composition.
///
/// Grid point n is at n h, h being the step; `steps()` counts grid steps. A time between two grid points is
/// reached by one shorter step from the grid point before it, on a copy: the trajectory does not notice, and
/// the same bits come out whatever times are asked for.
///
/// A grid step that is unstable (step times largest frequency, by a bound from the tensions at hand and the
/// stiffness of what bends and stretches), that turns a bar by more than about 60 degrees in a stage or whose
/// equations have no solution near is taken in 2, 4, 8, ... parts where that is needed. Below 2^-24 of the
/// step the run counts as diverged.
class Rattle final : public Solver {
  public:
    /// `frame_interval_s` is divided by the smallest whole number that makes a stable step, where `def` names
    /// no step. The rigid bars of `system` must be of reach 1. Throws corda::Error for a rigid rope that is
    /// straight between two pins, for rigid bars that say the same thing twice, and for rigid strings.
    Rattle(const System& system, const WorldDef& world, const SolverDef& def, double frame_interval_s);

    Status advance_to(double time_s, State& state) override;
    [[nodiscard]] double energy_j() const override;
    [[nodiscard]] double energy_scale_j() const override { return energy_scale_j_; }
    [[nodiscard]] bool conserves_energy() const override { return drag_1_s_ == 0.0; }
    /// Tensions that keep the lengths' second derivatives 0 at the state of the last `advance_to`.
    [[nodiscard]] std::optional<Loads> loads() const override;
    [[nodiscard]] std::uint64_t steps() const override { return step_; }

    [[nodiscard]] double step_s() const { return step_s_; }
    /// Parts of steps taken so far, of the trajectory alone: equals steps() while no step is subdivided.
    [[nodiscard]] std::uint64_t parts() const { return parts_; }

  private:
    /// A trajectory at the end of a stage, before the second half of its kick.
    struct Trajectory {
        Motion motion;
        double last_span_s = 0.0;    ///< the stage that led here; 0 at the start
        std::vector<double> rate;    ///< impulse over kick of every bar in the last stage, N / m
        int level = 0;               ///< a step is taken in 2^level parts
        double frequency_1_s = 0.0;  ///< bound on the largest frequency, from `rate` and ElasticForces
    };
    /// Rates of the same stage in the last parts of a step, for a guess of the next.
    struct History {
        std::vector<double> rates;  ///< [age][stage][link]
        int count = 0;              ///< parts in a row of the same span that are held, up to kHistory
        int newest = 0;
    };
    static constexpr int kHistory = 3;

    /// Goes on by `span_s` in as many parts as it takes.
    [[nodiscard]] bool advance(double span_s, Trajectory& trajectory, History* history);
    [[nodiscard]] bool take_part(double part_s, Trajectory& trajectory, History* history);
    [[nodiscard]] double* rates(History& history, std::size_t stage, int age) const;
    void guess(std::size_t stage, double kick_s, const Trajectory& trajectory, History* history);
    [[nodiscard]] bool is_elastic() const { return kTermsCompiledIn && !forces_.empty(); }
    /// Writes the elastic forces at these positions to force_x_n_ and force_y_n_; returns their bound on the
    /// square of the largest frequency.
    double find_forces(const Motion& motion);
    /// Takes over the stage's decay and push, with the elastic forces at the positions at hand; returns as
    /// find_forces.
    double push(double kick_s, Stage& stage, Motion& motion);
    /// Writes a trajectory's state with complete velocities to output_.
    [[nodiscard]] bool complete(const Trajectory& trajectory);
    [[nodiscard]] bool find_tensions() const;
    [[nodiscard]] double expected_frequency(double elastic_square) const;

    const Composition& composition_;
    std::unique_ptr<ConstraintSolver> constraints_;
    ElasticForces forces_;
    Vec2 gravity_m_s2_;
    double drag_1_s_;
    double step_s_ = 0.0;
    double energy_scale_j_ = 0.0;
    std::uint64_t step_ = 0;
    std::uint64_t parts_ = 0;
    std::vector<double> mass_kg_;
    std::vector<double> inverse_mass_1_kg_;
    Trajectory grid_;        ///< at step_ * step_s_
    Trajectory between_;     ///< scratch for a time between grid points
    Trajectory part_start_;  ///< where a part that fails starts again
    History history_;
    std::vector<double> impulse_;
    // Of the last evaluation, which is that of output_ whenever advance_to() has returned; empty without
    // elastic forces.
    std::vector<double> force_x_n_;
    std::vector<double> force_y_n_;
    Motion output_;  ///< at the last time asked for, velocities complete
    // Of the state in output_; scratch of loads().
    mutable std::vector<double> tension_over_length_n_m_;
    mutable std::vector<Vec2> pin_force_n_;  ///< one a particle; meaningful for the pinned
};

}  // namespace corda::sim
