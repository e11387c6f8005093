#pragma once

#include "corda/sim/defs.hpp"

namespace corda::reference {

/// The mathematical pendulum let go at rest, theta'' = -omega0^2 sin theta, in closed form:
///
///   sin(theta / 2) = k cd(omega0 t, k),   k = sin(theta(0) / 2),   T = 4 K(k) / omega0,
///
/// Jacobi's cd = cn / dn is computed by the arithmetic-geometric mean in long double (Abramowitz and Stegun,
/// 16.4 and 17.6). The error is some 1e-16 for thousands of seconds.
class Pendulum {
  public:
    /// `omega0_1_s` > 0; `angle_rad` is measured from straight down, 0 <= angle < pi.
    Pendulum(long double omega0_1_s, long double angle_rad);

    [[nodiscard]] double period_s() const { return static_cast<double>(period_s_); }

    /// The unit vector from the pin to the bob; towards +x at the start.
    [[nodiscard]] Vec2 direction(long double time_s) const;

  private:
    static constexpr int kMeans =
        8;  ///< steps of the mean, which converges quadratically: enough for 1 - k = 1e-12
    long double omega0_1_s_;
    long double modulus_;
    long double period_s_;
    long double mean_[kMeans + 1]{};      ///< a_n of the mean
    long double half_gap_[kMeans + 1]{};  ///< c_n
};

/// Angular frequency, in 1/s, of small oscillations of a rigid rod with `particles` equal masses at distances
/// `spacing_m`, 2 `spacing_m`, ... from the pin: omega0^2 = g sum(r) / sum(r^2) (R3).
[[nodiscard]] long double rod_omega0_1_s(int particles, double spacing_m, double gravity_m_s2);

/// The least angular frequency, in 1/s, of small oscillations of a hanging rope of `links` links of the
/// length `spacing_m` with equal masses: omega^2 = (g / a) x, x the least zero of the Laguerre polynomial L_N
/// (R4).
[[nodiscard]] long double rope_omega0_1_s(int links, double spacing_m, double gravity_m_s2);

/// How far a particle has moved, in metres, after `steps` steps of method `relaxation` from rest, if it loses
/// the share `delta` of its velocity per step: (h^2 f / (m delta)) (n - (1 - (1 - delta)^n) / delta) (R10).
[[nodiscard]] double damped_fall_m(double mass_kg, double step_s, int steps, double delta, double force_n);

}  // namespace corda::reference
