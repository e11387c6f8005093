#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "corda/sim/defs.hpp"

namespace corda::sim {

/// Whether `key_s` is at or before `time_s`, or later by a few roundings, because times are sums of steps.
[[nodiscard]] inline bool is_reached(double key_s, double time_s) {
    constexpr double kFewRoundings = 4.0 * std::numeric_limits<double>::epsilon();
    return key_s <= time_s + kFewRoundings * std::abs(time_s);
}

/// A vector that depends on time, as plain data: a constant, waves and a polynomial from each key of a path
/// to the next. Its only operations are +, -, * and /, so it has the same bits on every machine.
class TimeFunction {
  public:
    TimeFunction() = default;

    /// Adds amplitude * sin(2 pi frequency t + phase).
    void add_wave(const WaveDef& wave);
    /// Adds the way from key to key with the least jerk, at rest at each: 0 before the first and constant
    /// after the last. The function has no path yet.
    void add_path(std::span<const PathKeyDef> keys);
    /// Adds a constant.
    void shift(Vec2 by) { constant_ = constant_ + by; }
    /// The same function of times counted from `time_s`.
    [[nodiscard]] TimeFunction from(double time_s) const;
    /// Adds a multiple of a function, which has the keys of this one or none, unless this one has none.
    void add(double factor, const TimeFunction& other);

    [[nodiscard]] TimeFunction derivative() const;
    /// All vectors turned by the angle of this cosine and sine.
    [[nodiscard]] TimeFunction turned(Vec2 cosine_sine) const;

    /// Always 0.
    [[nodiscard]] bool empty() const { return waves_.empty() && pieces_.empty() && constant_ == Vec2{}; }
    [[nodiscard]] Vec2 operator()(double time_s) const {
        return waves_.empty() && pieces_.empty() ? constant_ : sum_at(time_s);
    }
    /// Writes the coefficients of the series in (t - time_s) / unit_s, as many as fit. At a key they are
    /// those of the piece that starts there.
    void expand(double time_s, double unit_s, std::span<Vec2> coefficients) const;
    /// The first key after `time_s`, beyond which the series is another one; infinite if there is none.
    [[nodiscard]] double next_key_s(double time_s) const;

    /// Upper bound of its length at all times.
    [[nodiscard]] double bound() const;
    /// The largest angular frequency of its waves, 1/s.
    [[nodiscard]] double frequency_1_s() const;

    friend bool operator==(const TimeFunction&, const TimeFunction&) = default;

  private:
    static constexpr std::size_t kTerms = 6;

    /// sine * sin(a) + cosine * cos(a) with a = 2 pi (frequency t + turns).
    struct Wave {
        double frequency_hz = 0.0;
        double turns = 0.0;
        Vec2 sine;
        Vec2 cosine;
        friend bool operator==(const Wave&, const Wave&) = default;
    };
    /// From its start to that of the next: the sum of term[k] ((t - start_s) / unit_s)^k.
    struct Piece {
        double start_s = 0.0;
        double unit_s = 1.0;
        std::array<Vec2, kTerms> term{};
        friend bool operator==(const Piece&, const Piece&) = default;
    };
    [[nodiscard]] Vec2 sum_at(double time_s) const;
    /// The piece at a time; nullptr before the first.
    [[nodiscard]] const Piece* piece_at(double time_s) const;

    Vec2 constant_;
    std::vector<Wave> waves_;
    std::vector<Piece> pieces_;
};

}  // namespace corda::sim
