#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "corda/sim/dop853.hpp"
#include "corda/sim/solver.hpp"
#include "corda/sim/string_contacts.hpp"
#include "corda/sim/string_dynamics.hpp"

namespace corda::sim {

/// Finds the first time in a step at which a link of a string goes slack or comes taut.
///
/// Every link has a margin, negative while nothing happens to it: of a taut link, minus its tension; of a
/// slack one at distance d and of rest length r, (d^2 - r^2) / (2 r), which is about d - r. Both are lowered
/// by what may be rounding, and so as to be negative at first: a link that has just changed sides does not
/// change back at once.
///
/// Margins are looked at in kParts equal parts of a step. A step is no longer than the time in which anything
/// in the string moves by its own length, and the solution in it a polynomial of degree 7: in two parts of
/// eight a margin is close to a parabola. Where that has its top between the points and near 0, the top is
/// sought out. What remains unseen is a link that gets past its rest length by far less than the tolerance,
/// and back, in less than a part.
class StringEvents {
  public:
    static constexpr std::size_t kParts = 8;

    /// For strings of so many particles.
    explicit StringEvents(std::size_t particles);

    /// From now on these links are taut and the others slack. `string` is the state at which `dynamics`
    /// starts.
    void start(const System& string, const std::vector<std::uint8_t>& is_taut, const StringContacts& contacts,
               StringDynamics& dynamics);

    /// The first event in the last step of `integrator`, which moves `dynamics`: the time, to rounding, from
    /// which on a margin is not negative. Nothing where there is none.
    [[nodiscard]] std::optional<double> first_in_step(Dop853& integrator, StringDynamics& dynamics);

  private:
    struct Sample {
        double time_s = 0.0;
        double margin = 0.0;
    };
    /// What the margins are read off.
    struct Motion {
        Dop853& integrator;
        StringDynamics& dynamics;
    };

    /// Writes the margin of every link at a time within the step; returns the largest.
    double measure(const Motion& motion, double time_s, double* margin);
    /// Settles y_, a state of the dynamics, and reads off what margins consist of.
    void read(StringDynamics& dynamics);
    /// Minus the tension, or (d^2 - r^2) / (2 r), of a link at the last read().
    [[nodiscard]] double raw_margin(std::size_t link) const;
    /// A time between three samples of a link's margin, all negative, at which it is not negative, if there
    /// is one, and the largest margin of all links there.
    [[nodiscard]] std::optional<Sample> top(const Motion& motion, std::size_t link, Sample before,
                                            Sample middle, Sample after);
    /// The earliest top() of all links within the parts beside this row.
    [[nodiscard]] std::optional<Sample> first_top(const Motion& motion, std::size_t middle);
    /// Where the largest margin changes its sign, on the side where it is not negative.
    [[nodiscard]] double root(const Motion& motion, Sample low, Sample high);
    [[nodiscard]] double* row(std::size_t part) { return &margin_[part * link_count_]; }

    std::size_t link_count_;
    std::vector<std::uint8_t> is_taut_;
    std::vector<double> rest_m_;
    std::vector<double> threshold_;  ///< of a margin, in N (taut) or m (slack)
    bool knows_start_ = false;       ///< the last row is of the time at which the next step starts
    std::array<double, kParts + 1> time_s_{};
    std::vector<double> margin_;                ///< [0 .. kParts][link]
    std::array<double, kParts + 1> largest_{};  ///< of the links' margins
    // Scratch.
    std::vector<double> y_;
    std::vector<double> link_margin_;
    std::vector<double> tension_n_;
    State state_;
};

}  // namespace corda::sim
