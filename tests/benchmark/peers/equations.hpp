#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "benchmark/peers/peer.hpp"

namespace corda::peers {

/// The equations of motion of a problem, for solvers of ordinary differential equations. `Real` is double, or
/// long double for the truth.
///
/// A chain: the angles of the links from +x, then their angular velocities; the tensions solve a tridiagonal
/// system. A net: x, y of the particles, then vx, vy. A string is the chain of its taut part.
template <class Real>
class Equations {
  public:
    explicit Equations(const Problem& problem)
        : problem_(problem), links_(problem.count() - 1), gravity_(-problem.world.gravity_m_s2.y) {
        for (std::vector<Real>* values : {&c_, &s_, &couple_, &diagonal_, &off_, &tension_})
            values->assign(links_ + 2, Real(0));
        for (std::vector<Real>* values : {&fx_, &fy_}) values->assign(problem.count(), Real(0));
        weight_.assign(problem.system.inverse_mass_1_kg.begin(), problem.system.inverse_mass_1_kg.end());
        if (problem.stiffness_n_m == 0.0) {
            length_ = Real(problem.system.bars[0].rest_m);
            // The start as the scene means it, without the rounding of its points.
            if (problem.id == "swing") length_ = std::sqrt(Real(101)) / 10;
            if (problem.id == "chain" || problem.id == "payload") length_ = Real(1) / 10;
            if (problem.id == "bending") length_ = Real(1) / 20;
        }
        if (problem.id == "swing")
            gravity_ = Real(98) / 10;
        else
            gravity_ = Real(981) / 100;
    }

    [[nodiscard]] std::size_t size() const {
        return problem_.stiffness_n_m > 0.0 ? 4 * problem_.count() : 2 * links_;
    }

    [[nodiscard]] std::vector<Real> start() const {
        std::vector<Real> y(size(), Real(0));
        if (problem_.stiffness_n_m == 0.0) {
            Real angle = 0;
            if (problem_.id == "swing") angle = std::atan2(Real(-10), Real(1));
            for (std::size_t i = 0; i < links_; ++i) y[i] = angle;
            return y;
        }
        for (std::size_t i = 0; i < problem_.count(); ++i) {
            y[2 * i] = problem_.system.x_m[i];
            y[2 * i + 1] = problem_.system.y_m[i];
        }
        return y;
    }

    void slope(const Real* y, Real* dy) {
        if (problem_.stiffness_n_m > 0.0) {
            net_slope(y, dy);
        } else {
            chain_slope(y, dy);
        }
    }

    void read(const Real* y, State& state) const {
        const std::size_t count = problem_.count();
        if (problem_.stiffness_n_m > 0.0) {
            for (std::size_t i = 0; i < count; ++i) {
                state.x_m[i] = static_cast<double>(y[2 * i]);
                state.y_m[i] = static_cast<double>(y[2 * i + 1]);
                state.vx_m_s[i] = static_cast<double>(y[2 * (count + i)]);
                state.vy_m_s[i] = static_cast<double>(y[2 * (count + i) + 1]);
            }
            return;
        }
        Real x = 0, z = 0, vx = 0, vz = 0;
        for (std::size_t i = 0; i < links_; ++i) {
            const Real c = length_ * std::cos(y[i]);
            const Real s = length_ * std::sin(y[i]);
            state.x_m[i + 1] = static_cast<double>(x += c);
            state.y_m[i + 1] = static_cast<double>(z += s);
            state.vx_m_s[i + 1] = static_cast<double>(vx -= s * y[links_ + i]);
            state.vy_m_s[i + 1] = static_cast<double>(vz += c * y[links_ + i]);
        }
    }

    [[nodiscard]] Real gravity() const { return gravity_; }

  private:
    void net_slope(const Real* y, Real* dy) {
        const std::size_t count = problem_.count();
        for (std::size_t i = 0; i < count; ++i) fx_[i] = fy_[i] = 0;
        const Real stiffness = problem_.stiffness_n_m;
        for (const Bar& bar : problem_.system.bars) {
            const Real dx = y[2 * bar.b] - y[2 * bar.a];
            const Real dz = y[2 * bar.b + 1] - y[2 * bar.a + 1];
            const Real pull = stiffness * (1 - Real(bar.rest_m) / std::sqrt(dx * dx + dz * dz));
            fx_[bar.a] += pull * dx;
            fy_[bar.a] += pull * dz;
            fx_[bar.b] -= pull * dx;
            fy_[bar.b] -= pull * dz;
        }
        for (std::size_t i = 0; i < 2 * count; ++i) dy[i] = y[2 * count + i];
        for (std::size_t i = 0; i < count; ++i) {
            dy[2 * (count + i)] = weight_[i] * fx_[i];
            dy[2 * (count + i) + 1] = weight_[i] > 0 ? weight_[i] * fy_[i] - gravity_ : Real(0);
        }
    }

    /// Link i leads from particle i to i + 1.
    void chain_slope(const Real* y, Real* dy) {
        const Real* const omega = y + links_;
        // Two loops, so that a compiler can take vector functions of the C library.
        for (std::size_t i = 0; i < links_; ++i) c_[i] = std::cos(y[i]);
        for (std::size_t i = 0; i < links_; ++i) s_[i] = std::sin(y[i]);
        find_couples();
        for (std::size_t i = 0; i < links_; ++i) {
            const Real near = weight_[i];
            const Real far = weight_[i + 1];
            // The difference of the forces per mass without tensions at the ends of the link.
            fx_[i] = far * force_x(i + 1) - near * force_x(i);
            fy_[i] = far * force_y(i + 1) - near * force_y(i) - (near == 0 ? gravity_ : Real(0));
            const Real right = length_ * omega[i] * omega[i] + c_[i] * fx_[i] + s_[i] * fy_[i];
            const Real before = i == 0 ? Real(0) : near * (c_[i] * c_[i - 1] + s_[i] * s_[i - 1]);
            const Real share = i == 0 ? Real(0) : before / diagonal_[i - 1];
            diagonal_[i] = near + far - share * before;
            tension_[i] = right + (i == 0 ? Real(0) : share * tension_[i - 1]);
            off_[i] = before;
        }
        tension_[links_] = 0;
        tension_[links_ - 1] /= diagonal_[links_ - 1];
        for (std::size_t i = links_ - 1; i-- > 0;)
            tension_[i] = (tension_[i] + off_[i + 1] * tension_[i + 1]) / diagonal_[i];
        for (std::size_t i = 0; i < links_; ++i) {
            Real ax = fx_[i] + weight_[i + 1] * tension_[i + 1] * c_[i + 1];
            Real ay = fy_[i] + weight_[i + 1] * tension_[i + 1] * s_[i + 1];
            if (i > 0) {
                ax += weight_[i] * tension_[i - 1] * c_[i - 1];
                ay += weight_[i] * tension_[i - 1] * s_[i - 1];
            }
            dy[i] = omega[i];
            dy[links_ + i] = (c_[i] * ay - s_[i] * ax) / length_;
        }
    }

    /// The torque of the bends on each link, as a couple of forces at its ends.
    void find_couples() {
        if (problem_.bend_n_m == 0.0) return;
        const Real stiffness = problem_.bend_n_m;
        for (std::size_t i = 0; i < links_; ++i) couple_[i] = 0;
        for (std::size_t i = 0; i + 1 < links_; ++i) {
            const Real turn = stiffness * (c_[i] * s_[i + 1] - s_[i] * c_[i + 1]) / length_;
            couple_[i] += turn;
            couple_[i + 1] -= turn;
        }
    }
    /// Force of the couples on a particle.
    [[nodiscard]] Real force_x(std::size_t i) const {
        return couple_[i] * s_[i] - (i == 0 ? Real(0) : couple_[i - 1] * s_[i - 1]);
    }
    [[nodiscard]] Real force_y(std::size_t i) const {
        return (i == 0 ? Real(0) : couple_[i - 1] * c_[i - 1]) - couple_[i] * c_[i];
    }

    const Problem& problem_;
    std::size_t links_;
    Real gravity_;
    Real length_ = 0;
    std::vector<Real> weight_, c_, s_, couple_, diagonal_, off_, tension_, fx_, fy_;
};

}  // namespace corda::peers
