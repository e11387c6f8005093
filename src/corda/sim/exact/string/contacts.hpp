#pragma once

#include <cstdint>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/exact/string/tension_lcp.hpp"
#include "corda/sim/forces/forces.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// Resolves the links of a string that are at their rest length: the snap when a link reaches it, and the
/// choice of links that stay taut.
class StringContacts {
  public:
    /// `string`: link k joins particles k and k + 1, and there are no other bars. `tolerance`: of the motion.
    StringContacts(const System& string, const Forces& forces, double tolerance);

    /// Changes the velocities of `string` by the impulses of a plastic snap of all links at their rest length
    /// whose ends separate: impulses pull and never push, and links that pull have no speed of separation
    /// afterwards. Links without such a speed then stay taut if their tension is positive; the others go
    /// slack. False if no such solution was found.
    ///
    /// `is_taut`, one entry per link: on entry before the snap, on return after it. A slack link takes part
    /// if it is at its rest length to rounding, or gets there within 1e-13 of the string's time scale: events
    /// that are simultaneous in a symmetric scene must not depend on their order.
    ///
    /// A link counts as taut if the snap of another link shortens it by less than a hundredth of the
    /// tolerance of its length before it returns. Two links that lie on each other shorten each other in this
    /// way in turn, ever more slowly; impulses along both at once give the limit.
    [[nodiscard]] bool resolve(System& string, std::vector<std::uint8_t>& is_taut, double time_s = 0.0);

    /// Share of the error of positions in the length of a slack link, at most 1: little if the link was at
    /// its rest length a moment ago.
    [[nodiscard]] double error_share(std::size_t link, double time_s) const;

    /// Error of positions in metres from which the last snap may have been another one: a second slack link
    /// would have been the first to snap, or the link that snapped would not have reached its rest length.
    /// Infinite if no slack link snapped.
    [[nodiscard]] double margin_m() const { return margin_m_; }

    // In the state that was resolved last, smaller tensions and changes of length are rounding.
    [[nodiscard]] double tension_error_n(std::size_t link) const {
        return acceleration_error_m_s2_ * largest_mass_kg_[link];
    }
    [[nodiscard]] double length_error_m(std::size_t link) const {
        return kLengthRounding * rest_m_[link] + place_error_m_;
    }

  private:
    static constexpr double kLengthRounding = 1e-14;

    void measure(const System& string);
    void find_margin(const System& string, const std::vector<std::uint8_t>& is_taut, double time_s);
    void find_present(const System& string, const std::vector<std::uint8_t>& is_taut);
    void snap(System& string) const;
    /// Finds the links that stay taut after the snap.
    [[nodiscard]] bool find_tensions(const System& string);
    void find_accelerations(const System& string);

    Forces forces_;
    double no_bounce_;
    std::vector<double> rest_m_;
    double length_m_ = 0.0;                ///< the sum of rest_m_
    std::vector<double> largest_mass_kg_;  ///< one per link; its tension's rounding comes from it

    // Scales of the state being resolved.
    double inverse_timescale_1_s_ = 0.0;  ///< see Forces
    double speed_error_m_s_ = 0.0;
    double acceleration_error_m_s2_ = 0.0;
    double place_error_m_ = 0.0;
    double margin_m_ = 0.0;
    std::size_t first_ = 0;           ///< the slack link that snaps first
    double excess_m_ = 0.0;           ///< by which it would exceed its rest length if it turned back
    std::vector<double> left_s_;      ///< one per link: the last time at which it was at its rest length
    std::vector<Vec2> direction_;     ///< one per link, of those at their rest length
    std::vector<double> inward_m_s_;  ///< one per link: its speed after the snap; 0 if that is rounding
    TensionLcp lcp_;
};

}  // namespace corda::sim
