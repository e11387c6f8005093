#pragma once

#include <cstdint>
#include <vector>

#include "corda/sim/moving_pins.hpp"
#include "corda/sim/relaxation/kernels.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

/// The source report's method (sections 1 and 3.3 of src/corda/sim/README.md): Verlet's update of every free
/// particle in its summed form, then sweeps over all bars in the order of System::bars.
///
/// The first position is an Euler step, so the state at n h is Verlet's after n - 1 updates, and free fall is
/// late by -g h t / 2. Times between steps are interpolated by the parabola through the three nearest states.
class Relaxation final : public Solver {
  public:
    /// `default_step_s`: the step if `def` names none. `kernel` changes the time taken, not the bits.
    Relaxation(const System& system, const Forces& forces, const RelaxationDef& def, double default_step_s,
               RelaxationKernel kernel = relaxation_kernels().back());

    // Facts about the method: see solver.cpp.
    static constexpr bool kKnowsTensions = false;
    [[nodiscard]] static const char* problem_of(const RelaxationDef& def);
    [[nodiscard]] static std::string text_of(const RelaxationDef& def);

    Status advance_to(double time_s, State& state) override;
    [[nodiscard]] double energy_j() const override;
    /// The last move over the step.
    void velocities(State& state) override;
    [[nodiscard]] std::uint64_t steps() const override { return step_; }
    [[nodiscard]] std::vector<MethodDef> methods() const override { return {def_}; }

  private:
    void advance(std::uint64_t steps);
    /// Sets the pushes of the next step.
    void set_pushes();
    void interpolate(double fraction, State& state) const;

    RelaxationDef def_;  ///< with its step
    double step_s_;
    std::uint64_t sweeps_;
    RelaxationKernel kernel_;
    std::uint64_t step_ = 0;
    /// The positions at step_ * step_s_, and the last move: the change of position in the last step, or h
    /// v(0) before the first one.
    RelaxationMotion motion_;
    std::vector<double> mass_kg_;
    std::vector<Vec2> force_n_;  ///< the weight or what replaces it; 0 for a pinned particle
    Forces forces_;
    bool goes_on_;  ///< it starts on its way
    std::vector<bool> is_free_;
    std::vector<MovingPin> pins_;
    std::vector<RelaxationBar> bars_;            ///< for kScalar
    std::vector<RelaxationSchedule> schedules_;  ///< for kAvx2; of some bodies each
};

}  // namespace corda::sim
