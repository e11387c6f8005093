#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "corda/sim/forces/elastic_forces.hpp"
#include "corda/sim/moving_pins.hpp"
#include "corda/sim/rattle/constraint_solver.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

/// A symmetric composition: one step h consists of the steps `stages[0]` h, `stages[1]` h, ... of a symmetric
/// method of order 2, some of them backwards.
struct Composition {
    int order = 2;
    std::span<const double> stages;  ///< symmetric, with the sum 1
    /// Largest omega h, rounded down, up to which the composed leapfrog stays bounded on an oscillation of
    /// angular frequency omega: there the trace of its matrix first leaves [-2, 2].
    double stable_omega_h = 2.0;
};

/// The composition of that order: 2, 4 (Suzuki, 5 stages), 6 (Kahan and Li, 9 stages) or 8 (Kahan and Li, 17
/// stages). The numbers are those of Hairer, Lubich, Wanner, Geometric Numerical Integration, V.3.2.
[[nodiscard]] const Composition& composition(int order);

/// A trajectory at the end of a stage, before the second half of the stage's kick.
struct Trajectory {
    Motion motion;
    double time_s = 0.0;
    double last_span_s = 0.0;        ///< of that stage; 0 at the start
    std::vector<double> multiplier;  ///< of every rigid bar in the last stage: impulse over kick, N / m
    int level = 0;                   ///< a step is taken in 2^level parts
    double frequency_1_s = 0.0;      ///< bound on the largest frequency, from `multiplier` and ElasticForces
    bool has_leapt = false;
};

/// The common data of the trajectories of a system: the equations of motion, the composition, and memory.
struct RattleModel {
    const Composition& composition;
    double guard = 0.0;  ///< see RattleDef
    std::unique_ptr<ConstraintSolver> constraints;
    Forces forces;
    ElasticForces elastic;
    // Of the last evaluation; empty without elastic forces.
    std::vector<double> force_x_n = {};
    std::vector<double> force_y_n = {};

    // Parts of the grid's steps: their number, and the multipliers of the last ones, from which those of the
    // next part are guessed.
    static constexpr int kHistory = 3;
    std::uint64_t parts = 0;
    std::vector<double> history = {};  ///< [age][stage][link]
    int known = 0;                     ///< parts in a row of the same span, up to kHistory
    int newest = 0;

    // Pins that move; the mean velocities of all held particles in a stage.
    std::vector<MovingPin> pins = {};
    std::vector<Vec2> held_m_s = {};
    double time_s = 0.0;  ///< of forces and of pins

    std::vector<double> impulse = {};  ///< scratch, one entry per link
    Trajectory part_start = {};        ///< scratch: from which a part that fails is repeated
};

/// Method `rattle`: RATTLE composed to order 2, 4, 6 or 8 (section 3.4 of src/corda/sim/README.md). Between
/// stages the solver omits the impulses that make velocities consistent and merges adjacent half kicks.
///
/// Grid point n is at n h, h being the step; `steps()` counts grid steps. A time between two grid points is
/// reached by one shorter step on a copy, so the trajectory does not depend on the requested times. A grid
/// step is divided into 2, 4, 8, ... parts if it is unstable, if a bar turns too far in a stage, or if
/// Newton's method does not converge. Steps pass a grid point near a line of bars, from the
/// point before it. If 2^24 parts are not enough, the rest of the step is one leap
/// (ConstraintSolver::leap); if there is none, the run has diverged.
class Rattle final : public Solver {
  public:
    /// A default step stays within the guard under this multiple of the weight below each link: the tension
    /// of a pendulum released from the horizontal.
    static constexpr double kLoadFactor = 3.0;

    /// If `def` names no step, `frame_interval_s` is divided by the smallest whole number that makes a stable
    /// step. Throws corda::Refusal for a rigid rope that is straight between two pins, for rigid bars that
    /// depend on each other at the start but not in the motion that follows, and for rigid strings.
    /// Factorising the matrix of a large net takes seconds and can be cancelled.
    Rattle(const System& system, const Forces& forces, const RattleDef& def, double frame_interval_s);

    // Facts about the method: see solver.cpp.
    static constexpr bool kKnowsTensions = true;
    [[nodiscard]] static const char* problem_of(const RattleDef& def);
    [[nodiscard]] static std::string text_of(const RattleDef& def);

    Status advance_to(double time_s, State& state) override;
    [[nodiscard]] double energy_j() const override;
    void velocities(State& state) override;
    /// Those that keep the second derivatives of the rigid bars' lengths 0. Unknown if bars depend on each
    /// other, because the distribution of the load among them is then arbitrary.
    [[nodiscard]] bool tensions(std::vector<double>& tension_n) override;
    [[nodiscard]] std::uint64_t steps() const override { return step_; }
    [[nodiscard]] bool has_branched() const override { return has_branched_; }

    [[nodiscard]] std::vector<MethodDef> methods() const override {
        return {RattleDef{model_.composition.order, step_s_, model_.guard}};
    }

    [[nodiscard]] double step_s() const { return step_s_; }
    /// Parts of grid steps taken so far: equal to steps() while no step is divided.
    [[nodiscard]] std::uint64_t parts() const { return model_.parts; }

  private:
    /// Advances the grid by one step.
    [[nodiscard]] bool step();
    /// The same from the point before the grid's, which is near a line of bars, past the line.
    [[nodiscard]] bool step_over_line();

    RattleModel model_;
    double step_s_ = 0.0;
    std::uint64_t step_ = 0;
    bool has_branched_ = false;  ///< at or before output_
    std::vector<double> mass_kg_;
    /// Empty if the constraints do not determine the tensions.
    std::vector<std::size_t> bar_of_link_;
    Trajectory grid_;    ///< at step_ * step_s_
    Trajectory before_;  ///< a step before grid_, if that is near a line of bars
    bool is_near_line_ = false;
    Trajectory aside_;  ///< scratch: not on the grid
    Motion output_;     ///< at the last requested time, with complete velocities and the model's forces
    std::vector<double> multiplier_;  ///< of output_; scratch
};

}  // namespace corda::sim
