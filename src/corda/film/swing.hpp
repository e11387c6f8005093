#pragma once

#include <optional>
#include <string>
#include <vector>

#include "corda/sim/system.hpp"

namespace corda::film {

/// A period in s, or why there is none.
struct Period {
    std::optional<double> seconds;
    std::string reason = {};  ///< empty with a period
};

/// Two successive periods agree if they differ by at most this share of the longer one. Those of ropes that
/// swing in several modes from up to 60 degrees differ by up to 0.06; those of ropes that do not swing
/// evenly, by 0.48 and more (1 to 50 links from 5 to 160 degrees, 10 s).
inline constexpr double kPeriodsAgree = 0.1;

/// When something passes below its pin.
class Passages {
  public:
    /// Adds a state: the way from the pin, and the velocity relative to it. Times increase. Passages between
    /// states are those of the cubic through both; swings that are narrower than rounding do not count.
    void include(double time_s, Vec2 arm_m, Vec2 velocity_m_s);

    [[nodiscard]] const std::vector<double>& times_s() const { return times_s_; }
    /// The mean time between passages in one direction, from the first passage on. There is none with less
    /// than three passages, without alternating directions, or if two successive ones disagree; of only three
    /// passages, if the time between the first two and that between the last two differ by more than twice as
    /// much.
    [[nodiscard]] Period period() const;

  private:
    struct Point {
        double time_s;
        Vec2 arm_m;
        Vec2 velocity_m_s;
    };

    std::optional<Point> last_;
    double widest_ = 0.0;  ///< the largest |x / y| since the last passage
    std::vector<double> times_s_;
    std::vector<bool> is_rightward_;
};

}  // namespace corda::film
