#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "corda/core/spool.hpp"
#include "corda/core/timeline.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// A quantity of a link: a row of the table in recording.cpp.
struct QuantityKind {
    const char* name = "";  ///< "tension", as in style.color_by
    const char* unit = "";  ///< takes a prefix, as in "kN"; empty: a bare number
    StateFields fields{};   ///< of a state, from which the value is computed
    /// The value for bar `k` of a body; NaN if unknown. A bar that is gone has neither tension nor strain.
    double (*value)(const System& system, const Body& body, std::size_t k, const State& state) = nullptr;
};
[[nodiscard]] const QuantityKind& kind_of(Quantity quantity);

/// The largest | length / rest length - 1 | of a link of a state.
[[nodiscard]] double max_strain(const System& system, const State& state);

/// Distribution of values: minimum, maximum and a histogram of their sizes. Ignores NaN.
class Histogram {
  public:
    void add(double value);
    void add(const Histogram& other);

    [[nodiscard]] bool empty() const { return count_ == 0; }
    [[nodiscard]] double least() const { return least_; }
    [[nodiscard]] double largest() const { return largest_; }
    /// The smallest bound exceeded by at most this share of the absolute values, to within 1/16.
    [[nodiscard]] double size_exceeded_by(double share) const;

  private:
    std::uint64_t count_ = 0;
    double least_ = std::numeric_limits<double>::infinity();
    double largest_ = -std::numeric_limits<double>::infinity();
    /// Counts by the first 16 bits of the absolute value: the exponent and four bits of the mantissa.
    std::vector<std::uint64_t> counts_;
};

/// Recorded states of one run at the times of a timeline, in order, with bounds and largest figures. Those
/// that take much memory are in a temporary file.
class Recording {
  public:
    /// `state_count`: the most states. `quantity`: collect its distribution; states then also have the fields
    /// that it needs. Throws as Spool.
    Recording(std::size_t particle_count, std::size_t state_count, std::size_t bar_count = 0,
              std::optional<Quantity> quantity = {}, const StateFields& fields = {});

    /// An empty recording of some of the particles and bars with room for as many states.
    [[nodiscard]] Recording for_part(std::size_t particle_count, std::size_t bar_count = 0) const;

    /// True if its states are those of bodies with these counts.
    [[nodiscard]] bool fits(std::size_t particle_count, std::size_t bar_count) const;

    /// Removes all states.
    void clear();
    /// Advances a run to time size() of a timeline and adds its state, unless the run diverges. `clock_s`, if
    /// not empty, measures the stepping.
    Status advance(Simulation& run, const Timeline& timeline, const std::function<double()>& clock_s);
    /// Adds a state that no run has computed, with what is known of it.
    void add(const System& system, const State& state, const Figures& figures, bool is_frame);
    /// Adds the recording of a body, made by for_part(), whose particles start at `first_particle` and bars
    /// at `first_bar`. Keeps the states that all bodies added so far have.
    void add_body(const Recording& body, std::size_t first_particle, std::size_t first_bar = 0);

    /// Number of states added.
    [[nodiscard]] std::size_t size() const { return energy_change_j_.size(); }
    /// Writes state `i`, i < size(), to `state`.
    void read(std::size_t i, State& state) const;
    /// Figures of state `i`, i < size().
    [[nodiscard]] const Figures& figures(std::size_t i) const { return figures_[i]; }

    /// Bounds of all states added at frame times: stills between frames do not move the camera.
    [[nodiscard]] const MotionBounds& bounds() const { return bounds_; }
    /// The same for each particle; all empty before the first state.
    [[nodiscard]] const std::vector<MotionBounds>& particle_bounds() const { return particle_bounds_; }
    /// Distribution of the quantity over all links and all states added at frame times; empty without a
    /// quantity.
    [[nodiscard]] const Histogram& histogram() const { return histogram_; }
    /// The fields of its states.
    [[nodiscard]] const StateFields& fields() const { return fields_; }
    /// Diagnostics of the run up to the last state added.
    [[nodiscard]] const Diagnostics& diagnostics() const { return diagnostics_; }

    /// Time spent stepping, in s; 0 without a clock.
    [[nodiscard]] double wall_s() const { return wall_s_; }

  private:
    void add_figures(const Recording& body);
    void add_state(const System& system, const State& state, const Figures& figures, bool is_frame);
    void add_to_histogram(const System& system, const State& state);

    /// One array of a recorded state.
    struct Part {
        std::vector<double> State::*array;
        std::size_t count;
        bool is_of_bars = false;
    };

    std::size_t particle_count_;
    std::optional<Quantity> quantity_;
    StateFields fields_;
    std::array<Part, 5> parts_;
    std::size_t state_size_;
    std::size_t most_states_;
    Spool values_;             ///< per state: time, then the parts
    std::vector<double> row_;  ///< one state of them
    std::vector<Figures> figures_;
    std::vector<double> energy_change_j_;  ///< per state; NaN if not known
    double energy_scale_j_ = 0.0;
    MotionBounds bounds_;
    std::vector<MotionBounds> particle_bounds_;
    Histogram histogram_;
    Diagnostics diagnostics_;
    double wall_s_ = 0.0;
    std::size_t bodies_ = 0;  ///< added by add_body()
};

}  // namespace corda::sim
