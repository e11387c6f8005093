#pragma once

#include <cstdint>
#include <vector>

#include "corda/sim/forces/forces.hpp"
#include "corda/sim/moving_pins.hpp"
#include "corda/sim/solver.hpp"

namespace corda::sim {

/// Particles that no bar moves: free ones fall, with no error but rounding, and pins rest or move. Bars may
/// join pins alone.
///
/// The equations of free particles are linear and the same for all: after a time t, x = x0 + drift(t) v0 +
/// fall(t), v = decay(t) v0 + gain(t). These four are series in time.
class LooseParticles final : public Solver {
  public:
    LooseParticles(const System& system, const Forces& forces, const MethodDef& method);

    Status advance_to(double time_s, State& state) override;
    [[nodiscard]] double energy_j() const override;
    void velocities(State& state) override;
    [[nodiscard]] bool tensions(std::vector<double>& tension_n) override;
    [[nodiscard]] std::uint64_t steps() const override { return steps_; }
    [[nodiscard]] std::vector<MethodDef> methods() const override { return {method_}; }

  private:
    struct Particle {
        std::size_t index = 0;
        double mass_kg = 0.0;
        Vec2 at_m;  ///< at start_s_
        Vec2 velocity_m_s;
    };
    /// Where a particle is, and how fast, at the time of expand().
    [[nodiscard]] Particle moved(const Particle& from) const;
    void expand(double time_s);

    Forces forces_;
    MethodDef method_;
    std::vector<Particle> free_;
    std::vector<MovingPin> pins_;
    double longest_s_;      ///< for which the series converge fast
    double start_s_ = 0.0;  ///< of the present step
    double time_s_ = 0.0;   ///< the last one that was requested
    std::uint64_t steps_ = 0;
    // At time_s_.
    double decay_ = 1.0;
    double drift_s_ = 0.0;
    Vec2 gain_m_s_;
    Vec2 fall_m_;
};

}  // namespace corda::sim
