#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "corda/core/timeline.hpp"
#include "corda/sim/bounds.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/spread.hpp"

namespace corda::sim {

/// The states of one run at the times of a timeline, in order, up to a memory budget. Of states beyond the
/// budget only the bounds and the largest figures are kept.
class Recording {
  public:
    /// `state_count`: of the timeline. `budget_bytes`: the most memory that states may take. `quantity`: one
    /// whose spread is wanted; states then have readings_for() it beside `readings`.
    Recording(std::size_t particle_count, std::size_t state_count, std::size_t budget_bytes,
              std::size_t bar_count = 0, std::optional<Quantity> quantity = {},
              const StateFields& readings = {});

    /// An empty recording of some of the particles and bars that keeps as many states.
    [[nodiscard]] Recording for_part(std::size_t particle_count, std::size_t bar_count = 0) const;

    /// Forgets all states.
    void clear();
    /// Advances a run to time size() of a timeline and adds its state, unless the run diverges. `clock_s`, if
    /// not empty, measures the stepping. `goes_on`: see Simulation::advance_to.
    Status advance(Simulation& run, const Timeline& timeline, const std::function<double()>& clock_s,
                   const GoesOn& goes_on = {});
    /// Adds the recording of a body whose particles begin at `first_particle` and its bars at `first_bar`,
    /// made by for_part(). The states are then those that all bodies added so far have.
    void add_body(const Recording& body, std::size_t first_particle, std::size_t first_bar = 0);

    /// Number of states added.
    [[nodiscard]] std::size_t size() const { return energy_change_j_.size(); }
    /// Whether state `i` was added and is kept.
    [[nodiscard]] bool holds(std::size_t i) const { return i < figures_.size(); }
    /// Writes state `i`, which it holds, to `state`.
    void read(std::size_t i, State& state) const;
    /// Of state `i`, which it holds.
    [[nodiscard]] const Figures& figures(std::size_t i) const { return figures_[i]; }

    /// Of all states added at frame times: stills between frames do not move the camera.
    [[nodiscard]] const MotionBounds& bounds() const { return bounds_; }
    /// The same for each particle; all empty before the first state.
    [[nodiscard]] const std::vector<MotionBounds>& particle_bounds() const { return particle_bounds_; }
    /// Of the quantity, of all links in all states added at frame times; empty without one.
    [[nodiscard]] const Spread& spread() const { return spread_; }
    /// What its states have.
    [[nodiscard]] const StateFields& readings() const { return readings_; }
    /// Of the run up to the last state added.
    [[nodiscard]] const Diagnostics& diagnostics() const { return diagnostics_; }

    /// Seconds of stepping of that run; 0 without a clock.
    [[nodiscard]] double wall_s() const { return wall_s_; }

  private:
    void add_figures(const Recording& body);
    void add_spread(const System& system, const State& state);

    /// What a recorded state has of an array.
    struct Part {
        std::vector<double> State::*array;
        std::size_t count;
        bool is_of_bars = false;
    };

    std::size_t particle_count_;
    std::optional<Quantity> quantity_;
    StateFields readings_;
    std::array<Part, 5> parts_;
    std::size_t state_size_;
    std::size_t most_states_;
    std::vector<double> values_;  ///< per state: time, then the parts
    std::vector<Figures> figures_;
    std::vector<double> energy_change_j_;  ///< of all states added; NaN if not known
    double energy_scale_j_ = 0.0;
    MotionBounds bounds_;
    std::vector<MotionBounds> particle_bounds_;
    Spread spread_;
    Diagnostics diagnostics_;
    double wall_s_ = 0.0;
    std::size_t bodies_ = 0;  ///< added by add_body()
};

}  // namespace corda::sim
