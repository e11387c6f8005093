#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/forces/elastic_forces.hpp"
#include "corda/sim/forces/forces.hpp"
#include "corda/sim/simulation.hpp"

namespace corda::sim {

/// Position of a time on the grid of whole multiples of a fixed step.
struct GridTime {
    std::uint64_t step = 0;  ///< number of whole steps up to the time
    bool is_on_grid = true;  ///< the time is that of `step`
    double fraction = 0.0;   ///< of the next step, if not
};

/// Locates a time on the grid. A time within a relative 1e-9 of n steps, and within a millionth of a step,
/// counts as n steps, because times from fractions or decimal text are rounded.
inline GridTime locate(double time_s, double step_s) {
    constexpr double kTolerance = 1e-9;
    constexpr double kMaxTolerance = 1e-6;                    // a day has 1e8 steps
    const double steps = std::min(time_s / step_s, 0x1p+62);  // what an integer holds
    const double nearest = std::round(steps);
    if (std::abs(steps - nearest) <= std::min(kTolerance * std::max(1.0, nearest), kMaxTolerance))
        return {static_cast<std::uint64_t>(nearest), true, 0.0};
    const double whole = std::floor(steps);
    return {static_cast<std::uint64_t>(whole), false, steps - whole};
}

/// A method that moves a System through time.
class Solver : NonCopyable {
  public:
    virtual ~Solver() = default;

    /// Writes the positions at exactly `time_s` to `state`, which has room for all particles. Times must not
    /// decrease. Returns kDiverged if the method fails (no convergence, a step too small, numbers that are
    /// not finite); `state` is then undefined, and the solver must not be used further. The same holds if
    /// check_cancelled() throws: steps are counted as work.
    virtual Status advance_to(double time_s, State& state) = 0;

    /// Kinetic plus potential energy in joules at the solver's own time nearest to the last `advance_to`.
    [[nodiscard]] virtual double energy_j() const = 0;

    /// True if the run has passed a branching point: see Diagnostics.
    [[nodiscard]] virtual bool has_branched() const { return false; }

    /// Denominator of the energy error, in joules; see the function of that name in forces.hpp.
    [[nodiscard]] double energy_scale_j() const { return energy_scale_j_; }

    /// False if damping takes energy on purpose.
    [[nodiscard]] bool conserves_energy() const { return conserves_energy_; }

    /// Writes the velocities of the free particles at the last `advance_to` to `state`, which has room for
    /// those of all.
    virtual void velocities(State& state) = 0;

    /// Writes the tensions of moving bars after the last `advance_to`, in N, to an array of all bars. Returns
    /// false if the method of a body does not know them; they are then NaN.
    [[nodiscard]] virtual bool tensions(std::vector<double>& tension_n) {
        std::fill(tension_n.begin(), tension_n.end(), std::numeric_limits<double>::quiet_NaN());
        return false;
    }

    /// Steps taken so far.
    [[nodiscard]] virtual std::uint64_t steps() const = 0;

    /// The method of each body, or one for all of them, with every default filled in: given again, they run
    /// with the same bits.
    [[nodiscard]] virtual std::vector<MethodDef> methods() const = 0;

    /// Writes the rest lengths that it has given to bars, to an array of all of them.
    virtual void read_rest_lengths(std::vector<Bar>& /*bars*/) const {}

    /// Error of positions in metres from which snaps between the last two requested times may have happened
    /// in another order, or not at all; infinite if there is nothing to decide.
    [[nodiscard]] virtual double margin_m() const { return std::numeric_limits<double>::infinity(); }

  protected:
    Solver(double energy_scale_j, bool conserves_energy)
        : energy_scale_j_(energy_scale_j), conserves_energy_(conserves_energy) {}

  private:
    double energy_scale_j_;
    bool conserves_energy_;
};

/// Makes the solver of a system: `methods` has one method per body, or one for all. A method without a step
/// derives it from `frame_interval_s`. Throws corda::Refusal if a method cannot run its body.
/// Preparing a large net takes seconds and can be cancelled.
[[nodiscard]] std::unique_ptr<Solver> make_solver(const System& system, const Forces& forces,
                                                  std::span<const MethodDef> methods,
                                                  double frame_interval_s);

// Facts about methods. Each follows from the static members of the method's solver: see solver.cpp.

/// Throws corda::Refusal for a parameter outside the range of its declaration.
void validate(const MethodDef& method);

/// The method in words: "rattle of order 4, step 0.01 s".
[[nodiscard]] std::string method_text(const MethodDef& method);

/// The step of the definition in s; std::nullopt if it gives none or the method chooses each step.
[[nodiscard]] std::optional<double> fixed_step_s(const MethodDef& method);

/// False if the method never knows the tensions of bars.
[[nodiscard]] bool knows_tensions(const MethodDef& method);

/// Number of implicit steps of `exact` per second that cost as much as explicit ones are expected to. 0 if
/// they cannot move the body or are not tried: its links must lean down from its only pin; with several, all
/// pull at the start, or stretch.
[[nodiscard]] double most_implicit_steps_1_s(const System& system, const Body& body, const Forces& forces);

/// Number of implicit steps per second that are expected at this tolerance: smaller for long or stiff ropes.
[[nodiscard]] double implicit_steps_1_s(const System& system, const Body& body, const Forces& forces,
                                        double tolerance);

/// Computes the loads on pins and links from positions and tensions.
class LoadMeter {
  public:
    explicit LoadMeter(const System& system);

    /// Loads of a state of the system with these tensions, one per bar. std::nullopt if one is NaN.
    [[nodiscard]] std::optional<Loads> of(const System& system, const State& state,
                                          std::span<const double> tension_n);

    /// Power of the pins that move on what hangs from them, in W, of a state with velocities; NaN if a
    /// tension is.
    [[nodiscard]] double support_power_w(const System& system, const State& state,
                                         std::span<const double> tension_n);

  private:
    void find_forces(const System& system, const State& state, std::span<const double> tension_n);

    std::vector<double> event_s_;         ///< when bends_ are others
    std::size_t phase_ = 0;               ///< of bends_: events before it
    std::optional<ElasticForces> bends_;  ///< empty without bends
    std::vector<double> fx_n_;            ///< on particles by bars and bends
    std::vector<double> fy_n_;
};

/// The larger of each figure; the known one if only one is known.
[[nodiscard]] Figures larger_figures(const Figures& a, const Figures& b);

/// The larger loads of two bodies; std::nullopt unless both are known.
[[nodiscard]] std::optional<Loads> loads_of_both(const std::optional<Loads>& a,
                                                 const std::optional<Loads>& b);

/// Figures::energy_error; std::nullopt if the change is unknown (NaN) or the scale is 0.
[[nodiscard]] std::optional<double> energy_error(double change_j, double scale_j);

}  // namespace corda::sim
