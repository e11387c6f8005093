#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

#pragma GCC visibility push(default)
namespace corda {

/// Positions of all particles at some times, from another simulation or a measurement. At these times the
/// positions are those that were given, bit for bit. Between two of them each particle follows the cubic
/// polynomial through both positions with the velocity at both: that of the parabola through three times, the
/// one before and the one after included, or the outermost three at the first time and the last. After the
/// last time, all rest. Never changes once it is made.
class GivenMotion {
  public:
    static constexpr double kMinIntervalSeconds = 1e-9;

    /// `times_s`: at least two, the first at most 0, each later than the one before by kMinIntervalSeconds or
    /// more. `positions_m`: in world coordinates, all particles of the first time, ropes before nets, then
    /// those of the next; no coordinate beyond 1e12. `source` names them in messages. Throws corda::Error
    /// (kUsage) for others.
    GivenMotion(std::vector<double> times_s, std::vector<Vec2> positions_m, std::string source = "positions");

    [[nodiscard]] std::size_t particle_count() const { return positions_m_.size() / times_s_.size(); }
    /// The last time.
    [[nodiscard]] double end_s() const { return times_s_.back(); }
    [[nodiscard]] const std::string& source() const { return source_; }
    /// A hash of all numbers, 16 hexadecimal digits.
    [[nodiscard]] const std::string& hash() const { return hash_; }

    /// Whether the positions of a particle at times before `until_s` differ.
    [[nodiscard]] bool moves_before(double until_s, std::size_t particle) const;

    /// Positions relative to (0, 0), and velocities. Throws corda::Error (kUsage) before the first time.
    [[nodiscard]] State at(double time_s) const;

  private:
    [[nodiscard]] const Vec2& position_m(std::size_t k, std::size_t i) const {
        return positions_m_[k * particle_count() + i];
    }
    [[nodiscard]] Vec2 mean_velocity_m_s(std::size_t k, std::size_t i) const;
    [[nodiscard]] Vec2 velocity_m_s(std::size_t k, std::size_t i) const;

    std::vector<double> times_s_;
    std::vector<Vec2> positions_m_;
    std::string source_;
    std::string hash_;
};

}  // namespace corda
#pragma GCC visibility pop
