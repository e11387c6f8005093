#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/dop853.hpp"
#include "corda/sim/exact/string/contacts.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

/// The chains of a string of rigid links while the same links stay taut: each run of taut links, and each
/// particle between two slack links, without a link. The tension of a slack link is 0. The time scale is that
/// of the fastest run or slack link.
///
/// The start is that of `string`, in which link k joins particles k and k + 1 and there are no other bars.
/// `is_taut`: one entry per link; a taut link is at its rest length and not between two pins.
[[nodiscard]] Chains chains_of_string(const System& string, const std::vector<std::uint8_t>& is_taut,
                                      const Forces& forces);

/// Finds the first time in a step at which a link of a string goes slack or comes taut.
///
/// Every link has a margin, which is negative until its event: for a taut link minus its tension, for a slack
/// one of rest length r whose ends are d apart (d^2 - r^2) / (2 r), which is about d - r. Margins are lowered
/// by their rounding, and to below 0 at the start, so that a link that has just changed sides does not change
/// back at once.
///
/// Margins are sampled at the ends of kParts equal parts of a step, in which a margin is close to a parabola.
/// If the top of a parabola lies between the samples and near 0, the top is sought. Only a link that exceeds
/// its rest length by far less than the tolerance and returns within a part is missed.
class StringEvents {
  public:
    static constexpr std::size_t kParts = 8;

    /// The largest length of a slack link that turned back without a snap.
    struct Miss {
        std::size_t link = 0;
        double time_s = 0.0;    ///< of the integrator
        double margin_m = 0.0;  ///< by which it was less than the rest length
    };

    /// For a string of this many particles.
    explicit StringEvents(std::size_t particles);

    /// From now on the links of `is_taut` are taut and the others slack. `string`: the state from which
    /// `dynamics` starts.
    void start(const System& string, const std::vector<std::uint8_t>& is_taut, const StringContacts& contacts,
               ChainDynamics& dynamics);

    /// The first event in the last step of `integrator`, which integrates `dynamics`: the time, to rounding,
    /// from which on a margin is not negative. std::nullopt if there is none.
    [[nodiscard]] std::optional<double> first_in_step(Dop853& integrator, ChainDynamics& dynamics);

    /// Those found by the last first_in_step(), which may be after its event.
    [[nodiscard]] const std::vector<Miss>& misses() const { return misses_; }

  private:
    struct Sample {
        double time_s = 0.0;
        double margin = 0.0;
    };
    /// Data from which margins are computed.
    struct Motion {
        Dop853& integrator;
        ChainDynamics& dynamics;
    };

    /// Writes the margin of every link at a time within the step and returns the largest.
    double measure(const Motion& motion, double time_s, double* margin);
    /// Projects y_, a state of the dynamics, and computes positions and tensions there.
    void read(ChainDynamics& dynamics);
    /// Minus the tension, or (d^2 - r^2) / (2 r), of a link at the last read().
    [[nodiscard]] double raw_margin(std::size_t link) const;
    /// A time between three negative samples of a link's margin at which the margin is not negative, with the
    /// largest margin of all links there; std::nullopt if there is none.
    [[nodiscard]] std::optional<Sample> top(const Motion& motion, std::size_t link, Sample before,
                                            Sample middle, Sample after);
    /// The earliest top() of all links within the two parts adjacent to this row.
    [[nodiscard]] std::optional<Sample> first_top(const Motion& motion, std::size_t middle);
    /// Adds the links that turn back where the last step ended and this one starts, too near for top().
    void add_misses_at_start();
    /// The time at which the largest margin changes its sign, on the side where it is not negative.
    [[nodiscard]] double root(const Motion& motion, Sample low, Sample high);
    [[nodiscard]] double* row(std::size_t part) { return &margin_[part * link_count_]; }

    std::size_t link_count_;
    std::vector<std::uint8_t> is_taut_;
    std::vector<double> rest_m_;
    std::vector<double> threshold_;  ///< subtracted from a margin, in N (taut) or m (slack)
    std::vector<Miss> misses_;
    bool knows_start_ = false;  ///< the last row is that of the next step's start
    std::array<double, kParts + 1> time_s_{};
    std::vector<double> margin_;                ///< [0 .. kParts][link]
    std::vector<double> before_;                ///< the last row but one of the step before
    std::array<double, kParts + 1> largest_{};  ///< largest margin of all links
    // Scratch.
    std::vector<double> y_;
    std::vector<double> link_margin_;
    std::vector<double> tension_n_;
    State state_;
};

}  // namespace corda::sim
