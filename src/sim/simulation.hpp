#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// What a state shows of its own quality.
struct Figures {
    /// Largest | length / rest length - 1 | of a real bar; one that hangs slack on purpose counts as 0.
    double strain = 0.0;
    /// | E(t) - E(0) | over (total weight * total length), or over E(0) without a force; nothing where
    /// damping takes energy away on purpose.
    std::optional<double> energy_error;
    std::optional<Loads> loads;  ///< nothing where the method does not know them
};

/// What a run has shown of itself: the largest figures over the times that were asked for.
struct Diagnostics {
    std::uint64_t steps = 0;
    Figures largest;
};

/// Whether a Simulation works out the figures of every state that it reaches: some 10 ns a particle.
enum class Figured { kNo, kYes };

/// A scene in motion: particles and bars, a solver, and a check of every state that it hands out.
class Simulation {
  public:
    /// `frame_interval_s` is the default step of a method that has no step of its own. Throws corda::Error
    /// where the method cannot run the system. Figures stay empty with Figured::kNo, e.g. in a rehearsal.
    Simulation(System system, const WorldDef& world, const SolverDef& solver, double frame_interval_s,
               Figured figured = Figured::kYes);

    /// Goes on to `time_s` seconds, which must not be before the state's time. The state is that of exactly
    /// this time; the same bits come out whatever times were asked for on the way.
    Status advance_to(double time_s);

    /// Positions relative to `system().origin_m`, at the last time that was reached.
    [[nodiscard]] const State& state() const { return state_; }
    [[nodiscard]] const System& system() const { return system_; }
    /// Figures of the state alone.
    [[nodiscard]] const Figures& figures() const { return figures_; }
    [[nodiscard]] Diagnostics diagnostics() const;

  private:
    void observe();

    System system_;
    std::unique_ptr<Solver> solver_;
    State state_;
    State next_;  ///< kept for its memory
    Figured figured_;
    bool conserves_energy_ = true;
    double initial_energy_j_ = 0.0;
    double energy_scale_j_ = 0.0;
    Figures figures_;
    Figures largest_;
};

}  // namespace corda::sim
