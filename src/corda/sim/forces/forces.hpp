#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/forces/time_function.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// Acceleration of every free particle of velocity v by one force: weight_m_s2 + push_m_s2 + change_m_s2(t) -
/// drag_1_s v. Every solver integrates forces of this form.
struct ForceTerm {
    Vec2 weight_m_s2;       ///< has a potential
    double drag_1_s = 0.0;  ///< >= 0
    Vec2 push_m_s2 = {};    ///< does work, as does change_m_s2
    TimeFunction change_m_s2 = {};
};

/// One kind of force: a row of the table in forces.cpp.
struct ForceKind {
    ForceTerm (*term)(const WorldDef&);
    /// The field of the world that is out of its range, as "drag_1_s is not >= 0"; nullptr: none is.
    const char* (*problem)(const WorldDef&);
    /// The force in words, such as "linear drag of 0.3 1/s, exact"; empty to omit it.
    std::string (*text)(const WorldDef&);
};

[[nodiscard]] bool is_finite(Vec2 v);

/// The field of a wave that is out of its range, as above; nullptr: none is.
[[nodiscard]] const char* problem_of(const WaveDef& wave);

/// All kinds of forces.
[[nodiscard]] std::span<const ForceKind> force_kinds();

/// The forces that act on every free particle: the sum of the terms of all kinds.
/// Together they accelerate a particle of velocity v by uniform_m_s2() - drag_1_s() v, at the time that was
/// set last, at first 0. Forces of bars and bends are separate (see ElasticForces and the solvers).
class Forces {
  public:
    /// The forces of a world. Not explicit: a WorldDef may be passed for Forces.
    Forces(const WorldDef& world);
    explicit Forces(ForceTerm sum);

    /// Sets the time of uniform_m_s2(). Before each evaluation of a force that may depend on it.
    void set_time(double time_s) {
        if (depend_on_time()) uniform_m_s2_ = uniform_at(time_s);
    }
    [[nodiscard]] Vec2 uniform_at(double time_s) const {
        return sum_.weight_m_s2 + sum_.push_m_s2 + sum_.change_m_s2(zero_s_ + time_s);
    }
    [[nodiscard]] bool depend_on_time() const { return !sum_.change_m_s2.empty(); }
    /// The series of uniform_m_s2() in (t - time_s) / unit_s: as many coefficients as fit.
    void expand(double time_s, double unit_s, std::span<Vec2> coefficients) const;
    /// The first time after `time_s` at which the third derivative of a path jumps or that until() gives,
    /// where steps should end; infinite if there is none.
    [[nodiscard]] double next_key_s(double time_s) const {
        const double now_s = zero_s_ + time_s;
        return std::min(sum_.change_m_s2.next_key_s(now_s), is_reached(end_s_, now_s) ? kNever : end_s_) -
               zero_s_;
    }
    /// The largest angular frequency of the waves in them, 1/s; 0 without any.
    [[nodiscard]] double frequency_1_s() const { return sum_.change_m_s2.frequency_1_s(); }
    /// The same forces with times counted from `time_s`, which is the time set.
    [[nodiscard]] Forces from(double time_s) const;
    /// The same forces, for a motion that ends at `time_s`.
    [[nodiscard]] Forces until(double time_s) const;
    /// The forces on particles seen from a frame that is displaced like this, at times counted alike.
    [[nodiscard]] Forces seen_from(const TimeFunction& displacement) const;
    /// All forces turned by the angle of this cosine and sine.
    [[nodiscard]] Forces turned(Vec2 cosine_sine) const;

    /// Acceleration of a free particle without velocity.
    [[nodiscard]] Vec2 uniform_m_s2() const { return uniform_m_s2_; }
    /// The part of it that has a potential: gravity.
    [[nodiscard]] Vec2 weight_m_s2() const { return sum_.weight_m_s2; }
    /// Upper bound of the absolute value of uniform_m_s2() at all times.
    [[nodiscard]] double strength_m_s2() const { return strength_m_s2_; }
    [[nodiscard]] double drag_1_s() const { return sum_.drag_1_s; }
    [[nodiscard]] bool conserve_energy() const {
        return sum_.drag_1_s == 0.0 && sum_.push_m_s2 == Vec2{} && !depend_on_time();
    }

    /// Decay factor exp(-drag t) of a velocity after `time_s`; greater than 1 for a negative time. Uses only
    /// +, -, * and /, because the last bit of std::exp differs between C libraries.
    [[nodiscard]] double decay(double time_s) const;

    /// Inverse of the time in which a body of this length and speed moves by about its own length, in 1/s; 0
    /// if it does not move.
    [[nodiscard]] double inverse_timescale_1_s(double length_m, double speed_m_s) const;

    /// Potential energy per mass in J/kg; 0 at the origin.
    [[nodiscard]] double potential_j_kg(Vec2 position_m) const { return -dot(sum_.weight_m_s2, position_m); }

    /// The weight in newtons of each particle of a system; 0 for one that stays pinned.
    [[nodiscard]] std::vector<Vec2> on_particles(const System& system) const;

  private:
    void measure();

    static constexpr double kNever = std::numeric_limits<double>::infinity();

    ForceTerm sum_;
    double zero_s_ = 0.0;    ///< the time from which the others are counted
    double end_s_ = kNever;  ///< not counted from it
    Vec2 uniform_m_s2_;
    double strength_m_s2_ = 0.0;
};

/// Denominator of the energy error: the sum over all bodies of the forces on their particles (see
/// Forces::on_particles) times the length along their links; 0 without a force.
[[nodiscard]] double energy_scale_j(const System& system, const std::vector<Vec2>& force_n);

}  // namespace corda::sim
