#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

namespace corda::test {

/// The motion of a system in extended precision (64 bits of mantissa), by a formulation of its own: Cartesian
/// coordinates, the multipliers of rigid bars from a factorisation, elastic bars and bends from their
/// energies, and Gragg's extrapolation in time (E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary
/// Differential Equations I, II.9).
///
/// Between events, links of strings either pull or are absent. A step ends where the first of them reaches
/// its rest length or stops pulling. Two complementarity problems decide which rigid links pull from then on,
/// one for the impulses of a plastic snap and one for the tensions; both are solved by Murty's rule. Where
/// pins are let go or links cut, a step ends as well, and the equations change. No code is shared with
/// Corda's solvers.
class ExtendedMotion {
  public:
    using Real = long double;
    using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
    using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

    /// Rigid bars keep the exact distance of their ends at the start. `start`: x, then y in m; empty: the
    /// start of the system.
    ExtendedMotion(const System& system, const WorldDef& world, const std::vector<Real>& start = {});

    /// Advances to `time_s`; false if that fails.
    [[nodiscard]] bool advance_to(double time_s);
    /// The reason of a failure; empty without one.
    [[nodiscard]] const std::string& failure() const { return failure_; }

    [[nodiscard]] Real x_m(std::size_t i) const { return y_[static_cast<Eigen::Index>(i)]; }
    [[nodiscard]] Real y_m(std::size_t i) const { return y_[count_ + static_cast<Eigen::Index>(i)]; }
    /// Drift of the lengths of the rigid bars that pull, at most, in m.
    [[nodiscard]] Real length_error_m() const;
    /// Number of times at which a link of a string started or stopped pulling.
    [[nodiscard]] int events() const { return events_; }

  private:
    using Pair = Eigen::Matrix<Real, 2, 1>;
    struct Link {
        std::size_t a;
        std::size_t b;
        Real rest;
        Real compliance;
        bool is_string;
        bool pulls = true;
        Real square = 0;  ///< of its length, if it is rigid and pulls; else 0
        Real least = 0;   ///< the zero of its margin
        double cut_s = HUGE_VAL;
    };
    /// Tension of a link and the rate at which its ends part, in any units.
    struct Answer {
        Vector pull;
        Vector away;
    };

    void add_links(const System& system, const Body& body);
    /// Advances within a phase.
    [[nodiscard]] bool move_to(double time_s);
    /// Lets go of pins and removes what is cut by now.
    [[nodiscard]] bool change();
    [[nodiscard]] Pair apart(const Vector& y, const Link& link, Eigen::Index first) const;
    void push(Vector& slope, std::size_t i, const Pair& force) const;
    void add_bends(const Vector& y, Vector& slope) const;
    [[nodiscard]] Real coupling(const Vector& y, const Link& link, const Link& other) const;
    [[nodiscard]] Vector solve(const Vector& y, Vector right);
    void push_along_bars(Vector& slope, const Vector& y, const Vector& multiplier) const;
    [[nodiscard]] Pair uniform_acceleration(Real time) const;
    void derivative(const Vector& y, Real time, Vector& slope);
    [[nodiscard]] Real extrapolate(Real step, Vector& change);
    void add(const Vector& change);
    void project();
    void remove_stretching(Vector& y, Vector& multiplier);
    [[nodiscard]] bool fail(const char* reason);

    // For strings.
    [[nodiscard]] const Link& bar(Eigen::Index k) const {
        return links_[rigid_[static_cast<std::size_t>(k)]];
    }
    void use_links_that_pull();
    [[nodiscard]] bool begin();
    [[nodiscard]] bool complement(const std::vector<bool>& present, const Answer& error,
                                  const std::function<Answer()>& answer);
    [[nodiscard]] Answer snapped(Vector& after);
    [[nodiscard]] Answer accelerated();
    [[nodiscard]] Vector raw_margins(const Vector& y, Real time);
    [[nodiscard]] Vector margins(Real step);
    [[nodiscard]] Real highest(Eigen::Index link, Real low, Real high);
    [[nodiscard]] std::optional<Real> event_within(Real step);
    [[nodiscard]] Real event_before(Real low, Real high);
    [[nodiscard]] Real longest_step();
    [[nodiscard]] Real next_key() const;

    Eigen::Index count_;
    WorldDef world_;
    std::vector<Bend> bends_;
    std::vector<MoveDef> moves_;
    Real strength_ = 0;  ///< bound of accelerations by what is not a bar
    std::vector<Real> inverse_mass_;
    std::vector<double> mass_kg_;
    std::vector<double> release_s_;  ///< infinite for what is never let go
    std::vector<double> changes_s_;  ///< when something is let go or cut, the next one last
    std::vector<Link> idle_;         ///< links between pins
    std::vector<Link> links_;
    std::vector<std::size_t> rigid_;   ///< the rigid ones that pull
    std::vector<Eigen::Index> first_;  ///< per entry of rigid_: the first entry that it is coupled with
    bool has_strings_ = false;
    Real size_ = 1;
    Real shortest_ = 1;
    Real mass_ = 0;
    Vector y_;
    Vector rest_;  ///< rounding error of y_
    Real time_ = 0;
    Real step_ = 1e-3L;
    Real begun_ = 0;               ///< the time of the last event
    Real first_step_ = HUGE_VALL;  ///< the longest after it
    Matrix matrix_;
    Vector multiplier_;  ///< of the last derivative()
    int events_ = 0;
    long steps_ = 0;
    std::string failure_;
};

}  // namespace corda::test
