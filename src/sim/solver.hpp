#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "corda/core/stop_check.hpp"
#include "corda/sim/defs.hpp"
#include "corda/sim/forces/forces.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// A method that moves a System through time.
class Solver {
  public:
    Solver(const Solver&) = delete;
    Solver& operator=(const Solver&) = delete;
    virtual ~Solver() = default;

    /// Writes the positions at exactly `time_s` to `state`, which has room for all particles. Times never go
    /// back. If the method fails (no convergence, a step too small, numbers that are not finite) it returns
    /// kDiverged; `state` is then undefined and the solver must not be used further. The same holds if
    /// `stop`, which hears of all steps, throws.
    virtual Status advance_to(double time_s, State& state, StopCheck& stop) = 0;

    /// Kinetic plus potential energy in joules at the solver's own time nearest to the last `advance_to`.
    [[nodiscard]] virtual double energy_j() const = 0;

    /// Whether the run has passed a point from which the motion could go on in several ways: see Diagnostics.
    [[nodiscard]] virtual bool has_branched() const { return false; }

    /// What an energy error is compared with, in joules; see the function of that name in forces.hpp.
    [[nodiscard]] double energy_scale_j() const { return energy_scale_j_; }

    /// False if damping takes energy on purpose.
    [[nodiscard]] bool conserves_energy() const { return conserves_energy_; }

    /// What the links carry at the last `advance_to`; std::nullopt if the method does not know.
    [[nodiscard]] virtual std::optional<Loads> loads() const { return std::nullopt; }

    /// Writes the velocities of the free particles at the last `advance_to`, in m/s, to arrays of all.
    virtual void velocities(std::vector<double>& vx_m_s, std::vector<double>& vy_m_s) = 0;

    /// Writes the tensions of the bars that move at the last `advance_to`, in N, to an array of all bars;
    /// false if the method of a body does not know them: those are NaN.
    [[nodiscard]] virtual bool tensions(std::vector<double>& tension_n) {
        std::fill(tension_n.begin(), tension_n.end(), std::numeric_limits<double>::quiet_NaN());
        return false;
    }

    /// Steps taken so far.
    [[nodiscard]] virtual std::uint64_t steps() const = 0;

    /// The method of each body, or one for all of them, with every default filled in: given again, they run
    /// with the same bits.
    [[nodiscard]] virtual std::vector<MethodDef> methods() const = 0;

  protected:
    Solver(double energy_scale_j, bool conserves_energy)
        : energy_scale_j_(energy_scale_j), conserves_energy_(conserves_energy) {}

  private:
    double energy_scale_j_;
    bool conserves_energy_;
};

/// What moves a system by one method per body, or by one for all of them. `frame_interval_s` is what a method
/// derives its step from if it names none. Throws corda::Refusal if a method cannot run its body, and as a
/// StopCheck if `goes_on` ends it: a large net takes seconds.
[[nodiscard]] std::unique_ptr<Solver> make_solver(const System& system, const Forces& forces,
                                                  std::span<const MethodDef> methods, double frame_interval_s,
                                                  const GoesOn& goes_on = {});

}  // namespace corda::sim
