#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// Positions of all particles at one time, relative to the system's origin.
struct State {
    double time_s = 0.0;
    std::vector<double> x_m;
    std::vector<double> y_m;
};

/// Whether a run can go on. A run that diverged keeps the last good state.
enum class [[nodiscard]] Status{kOk, kDiverged};

/// What the links carry at one time.
struct Loads {
    double pin_force_n = 0.0;  ///< largest force that a pinned particle takes from its links
    double largest_tension_n =
        0.0;  ///< largest tension of a link; negative tensions (pushing) count by their size
};

/// A method that moves a System through time.
class Solver {
  public:
    Solver() = default;
    Solver(const Solver&) = delete;
    Solver& operator=(const Solver&) = delete;
    virtual ~Solver() = default;

    /// Writes the positions at exactly `time_s` to `state`, which has room for all particles. Times never go
    /// back. Where the method fails (no convergence, a step too small, numbers that are not finite) it
    /// returns kDiverged, `state` is undefined and the solver must not be used further.
    virtual Status advance_to(double time_s, State& state) = 0;

    /// Kinetic plus potential energy in joules at the solver's own time nearest to the last `advance_to`.
    [[nodiscard]] virtual double energy_j() const = 0;

    /// Weight times length in joules: what an energy error is compared with; 0 without a force.
    [[nodiscard]] virtual double energy_scale_j() const = 0;

    /// False where damping takes energy on purpose.
    [[nodiscard]] virtual bool conserves_energy() const = 0;

    /// What the links carry at the last `advance_to`, where the method knows it.
    [[nodiscard]] virtual std::optional<Loads> loads() const { return std::nullopt; }

    /// Steps taken so far.
    [[nodiscard]] virtual std::uint64_t steps() const = 0;
};

/// The solver that `def` names. `system` must outlive it.
[[nodiscard]] std::unique_ptr<Solver> make_solver(const System& system, const WorldDef& world,
                                                  const SolverDef& def, double frame_interval_s);

}  // namespace corda::sim
