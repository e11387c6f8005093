#pragma once

#include <cstdint>
#include <vector>

#include "corda/sim/system.hpp"
#include "corda/sim/tension_lcp.hpp"
#include "corda/sim/vec2.hpp"

namespace corda::sim {

/// The links of a string that are at their rest length: what happens when one more gets there, and which of
/// them stay there.
class StringContacts {
  public:
    /// `string`: link k joins particles k and k + 1, there are no others.
    StringContacts(const System& string, Vec2 gravity_m_s2);

    /// Changes the velocities of `string` by the impulses of a plastic snap of all links that are at their
    /// rest length and separate: they pull, never push, and those that pull have no speed of separation
    /// afterwards. Of the links that have none, those then stay taut whose tension is positive, and the
    /// others go slack. False where no such solution was found.
    ///
    /// `is_taut`, one a link: as it was before, and as it is afterwards. A link that was slack takes part
    /// where it is at its rest length now, to rounding, or gets there in less than 1e-11 of the string's own
    /// time: events that are simultaneous in a symmetric scene must not depend on their order.
    ///
    /// A link that another one's snap sends inwards, to come back from less than 1e-10 of its length, counts
    /// as taut. Two links that lie back to back send each other inwards so, by turns and ever more slowly;
    /// what is left in the end is what impulses along both at once leave.
    [[nodiscard]] bool resolve(System& string, std::vector<std::uint8_t>& is_taut);

    // Below these, at the state that was resolved last, a tension and a change of length are rounding.
    [[nodiscard]] double tension_error_n(std::size_t link) const {
        return acceleration_error_m_s2_ * largest_mass_kg_[link];
    }
    [[nodiscard]] double length_error_m(std::size_t link) const {
        return kLengthRounding * rest_m_[link] + place_error_m_;
    }

  private:
    static constexpr double kLengthRounding = 1e-14;

    void measure(const System& string);
    void find_present(const System& string, const std::vector<std::uint8_t>& is_taut);
    void snap(System& string) const;
    /// Which links stay taut, after the snap.
    [[nodiscard]] bool find_tensions(const System& string);
    void find_accelerations(const System& string);

    Vec2 gravity_m_s2_;
    std::vector<double> rest_m_;
    double length_m_ = 0.0;                ///< the sum of these
    std::vector<double> largest_mass_kg_;  ///< a link: what tells its tension from rounding

    // Of the state that is resolved.
    double rate_1_s_ = 0.0;  ///< how fast the string moves by about its own length
    double speed_error_m_s_ = 0.0;
    double acceleration_error_m_s2_ = 0.0;
    double place_error_m_ = 0.0;
    std::vector<Vec2> direction_;     ///< one a link, of those that are present
    std::vector<double> inward_m_s_;  ///< one a link: its speed after the snap, where it is not rounding
    TensionLcp lcp_;
};

}  // namespace corda::sim
