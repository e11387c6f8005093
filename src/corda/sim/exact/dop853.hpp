#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "corda/sim/forces/time_function.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

namespace dop853 {
template <std::size_t Count>
struct Row;
}

/// A system of ordinary differential equations, y' = f(t, y), for Dop853.
class Ode : NonCopyable {
  public:
    virtual ~Ode() = default;

    /// Sets the time t for the other calls; at first it is 0.
    virtual void set_time(double time_s) { static_cast<void>(time_s); }

    /// The first time after `time_s` at which a derivative of f jumps, so that a step must end there;
    /// infinite if there is none.
    [[nodiscard]] virtual double next_key_s(double time_s) const {
        static_cast<void>(time_s);
        return std::numeric_limits<double>::infinity();
    }

    /// Writes f(t, y) to `slope`. Both have one entry per component and do not overlap.
    virtual void derivative(const double* y, double* slope) = 0;

    /// Projects a state that an integrator arrived at onto the invariants that the exact solution keeps (unit
    /// vectors, the ends of a chain at their pins). Must move it by no more than about the step's own error.
    virtual void project(double* y) { static_cast<void>(y); }
};

/// Takes three square roots, because std::pow is rounded differently by different C libraries.
inline double eighth_root(double x) {
    return std::sqrt(std::sqrt(std::sqrt(x)));
}

/// For Ode::project(): makes vectors unit vectors, all x of which come first, then all y.
inline void make_unit_vectors(std::size_t count, double* xy) {
    double* __restrict const x = xy;
    double* __restrict const y = xy + count;
    for (std::size_t i = 0; i < count; ++i) {
        const double inverse = 1.0 / std::sqrt(x[i] * x[i] + y[i] * y[i]);
        x[i] *= inverse;
        y[i] *= inverse;
    }
}

/// The unit of the error of the components `first` .. `first + count - 1`: tolerance * (absolute + relative *
/// |y|).
struct ErrorScale {
    std::size_t first = 0;
    std::size_t count = 0;
    double absolute = 1.0;  ///< > 0, in the component's own unit
    double relative = 0.0;  ///< >= 0
};

/// Bounds of the steps of an integrator.
struct StepControl {
    double tolerance = 1e-9;    ///< largest error per step, in parts of the ErrorScales; > 0
    double first_s = 1e-3;      ///< first step to try
    double largest_s = 1.0;     ///< keeps the interpolation accurate if nothing else limits the steps
    double smallest_s = 1e-14;  ///< the run has diverged if a step would have to be shorter
    /// The run has diverged if it would take more steps: a day of computing even for a short rope.
    static constexpr std::uint64_t kMaxSteps = 1'000'000'000;

    /// True if the run has diverged, because the step from `time_s` is too short: not longer than smallest_s,
    /// or a few roundings of the time, which shrinking would not change.
    [[nodiscard]] bool is_too_short(double step_s, double time_s) const {
        return !(step_s > smallest_s) || is_reached(time_s + step_s, time_s);
    }

    /// The step to take where a step must end after `rest_s`. The last two are of one length, so that none is
    /// very short.
    [[nodiscard]] static double step_before_key(double wanted_s, double rest_s) {
        if (2.0 * wanted_s <= rest_s) return wanted_s;
        return wanted_s < rest_s ? 0.5 * rest_s : rest_s;
    }
};

/// The explicit Runge-Kutta method of order 8 by Dormand and Prince with Hairer's error estimate (orders 5
/// and 3 together) and interpolation of order 7.
///
/// Source: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed.,
/// Springer 1993, II.5 (the pair), II.6 (the interpolation) and the appendix (DOP853, coefficients to 30
/// digits). The error of a step is the largest of all components, not their mean: one link that whips must be
/// noticed among thousands that hang still.
///
/// Steps depend on the start alone, never on the requested times, so the bits are always the same. Its only
/// operations are +, -, *, / and the square root.
class Dop853 {
  public:
    /// `ode` must outlive it. `start` needs no projection.
    Dop853(Ode& ode, std::vector<double> start, std::vector<ErrorScale> scales, const StepControl& control);

    /// Steps until time_s() >= `time_s`.
    Status advance_to(double time_s);

    /// Takes one step.
    Status step();

    /// Writes the solution at `time_s`, within the last step (or at 0 before the first), to `y`; not
    /// projected. The first call in a step costs three evaluations of f.
    void interpolate(double time_s, double* y);

    /// End of the last step.
    [[nodiscard]] double time_s() const { return time_s_; }
    /// Its start; 0 before the first.
    [[nodiscard]] double old_time_s() const { return old_time_s_; }
    /// Length of the step to try next.
    [[nodiscard]] double next_step_s() const { return next_step_s_; }
    [[nodiscard]] std::size_t size() const { return y_.size(); }
    [[nodiscard]] std::uint64_t accepted_steps() const { return accepted_; }
    [[nodiscard]] std::uint64_t rejected_steps() const { return rejected_; }

  private:
    static constexpr std::size_t kSlots = 12;

    void accept(double step_s);
    void evaluate_stages(double step_s);
    void prepare_interpolation();
    /// Largest error of a component in the step from y_ to stage_, in parts of the tolerance; infinite if one
    /// is not finite.
    [[nodiscard]] double error(double step_s) const;
    /// slope_[slot] = f(start_s + step sum of weights, from + step sum of weights * slopes).
    template <std::size_t Count>
    void evaluate(const dop853::Row<Count>& row, double start_s, double step_s,
                  const std::vector<double>& from, std::vector<double>& scratch, std::size_t slot);

    Ode& ode_;
    std::vector<ErrorScale> scales_;
    StepControl control_;
    double time_s_ = 0.0;
    double old_time_s_ = 0.0;
    double next_step_s_ = 0.0;
    bool can_interpolate_ = false;  ///< the three stages of the interpolation are known
    std::uint64_t accepted_ = 0;
    std::uint64_t rejected_ = 0;
    std::vector<double> y_;      ///< at time_s_
    std::vector<double> old_y_;  ///< at old_time_s_
    std::vector<double> stage_;
    std::array<std::vector<double>, kSlots> slope_;  ///< f at the stages; see dop853::Slot
};

/// The equations of motion of bodies as ordinary differential equations, and the meaning of their states.
class Dynamics : public Ode {
  public:
    /// The state at t = 0.
    [[nodiscard]] virtual const std::vector<double>& initial_state() const = 0;

    /// How errors in a state are measured, so that one tolerance fits all components.
    [[nodiscard]] virtual std::vector<ErrorScale> error_scales() const = 0;

    /// The inverse of the shortest time in which a body moves by about its own length, in 1/s; > 0.
    [[nodiscard]] virtual double inverse_timescale_1_s() const = 0;

    /// The inverse of the longest step that damps every vibration of a body, in 1/s.
    [[nodiscard]] virtual double inverse_stable_step_1_s() const { return 0.0; }

    /// Writes the positions of the bodies' particles, relative to the system's origin; leaves the others
    /// alone.
    virtual void positions(const double* y, State& state) const = 0;

    /// Kinetic plus potential energy, the latter relative to the system's origin.
    [[nodiscard]] virtual double energy_j(const double* y) const = 0;

    /// Writes the velocities of the particles whose positions positions() writes, in m/s.
    virtual void velocities(const double* y, State& state) const = 0;

    /// Writes the tensions of the bars that move, in N, a positive one pulls, to an array of all bars. Not
    /// const: it may use the scratch memory of derivative().
    virtual void tensions(const double* y, std::vector<double>& tension_n) = 0;
};

}  // namespace corda::sim
