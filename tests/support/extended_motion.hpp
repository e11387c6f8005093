#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "corda/sim/defs.hpp"
#include "corda/sim/system.hpp"

namespace corda::test {

/// The motion of a system in extended precision (64 bits of mantissa), by a formulation of its own: Cartesian
/// coordinates, the multipliers of rigid bars from a factorisation, elastic bars and bends from their
/// energies, and Gragg's extrapolation in time (E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary
/// Differential Equations I, II.9). Nothing of it is shared with Corda's solvers. Not for strings.
class ExtendedMotion {
  public:
    using Real = long double;
    using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
    using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

    /// Rigid bars keep the exact distance of their ends at the start. `start`: x, then y in m; empty: that of
    /// the system.
    ExtendedMotion(const System& system, const WorldDef& world, const std::vector<Real>& start = {})
        : count_(static_cast<Eigen::Index>(system.particle_count())), world_(world), bends_(system.bends) {
        y_ = Vector::Zero(4 * count_);
        for (Eigen::Index i = 0; i < count_; ++i) {
            const auto k = static_cast<std::size_t>(i);
            y_[i] = start.empty() ? Real{system.x_m[k]} : start[k];
            y_[count_ + i] = start.empty() ? Real{system.y_m[k]} : start[k + system.particle_count()];
            y_[2 * count_ + i] = system.vx_m_s[k];
            y_[3 * count_ + i] = system.vy_m_s[k];
            inverse_mass_.push_back(system.is_pinned(k) ? Real{0} : Real{1} / Real{system.mass_kg[k]});
        }
        for (const Body& body : system.bodies) {
            for (std::size_t k = body.first_bar; k < body.first_bar + body.bar_count; ++k) {
                const Bar& bar = system.bars[k];
                const Elastic joint{bar.a, bar.b, bar.rest_m, body.material.compliance_1_n};
                if (joint.compliance > 0) {
                    elastic_.push_back(joint);
                } else if (!system.is_pinned(bar.a) || !system.is_pinned(bar.b)) {
                    rigid_.push_back(joint);
                }
            }
        }
        size_ = largest_length_m(system);
        matrix_.resize(static_cast<Eigen::Index>(rigid_.size()), static_cast<Eigen::Index>(rigid_.size()));
        for (std::size_t k = 0; k < rigid_.size(); ++k) {
            std::size_t l = 0;
            while (l < k && !touch(rigid_[k], rigid_[l])) ++l;
            first_.push_back(static_cast<Eigen::Index>(l));
        }
        remove_stretching();
    }

    /// Goes on to `time_s`; false if steps become too short.
    [[nodiscard]] bool advance_to(double time_s) {
        while (time_ < time_s) {
            const Real left = time_s - time_;
            const Real step = std::min(step_, left);
            Vector next;
            const Real error = extrapolate(step, next);
            const Real grow = std::pow(kShare / std::max(error, Real{1e-30}), Real{1} / (2 * kColumns - 1));
            if (!(error <= kShare)) {
                step_ = step * std::clamp(Real{0.9} * grow, Real{0.1}, Real{0.7});
                if (!(step_ > Real{1e-12})) return false;
                continue;
            }
            y_ = next;
            time_ = step == left ? Real{time_s} : time_ + step;
            const Real wanted = step * std::clamp(Real{0.9} * grow, Real{0.5}, Real{2});
            step_ = step == left ? std::max(step_, wanted) : wanted;
        }
        return true;
    }

    [[nodiscard]] Real x_m(std::size_t i) const { return y_[static_cast<Eigen::Index>(i)]; }
    [[nodiscard]] Real y_m(std::size_t i) const { return y_[count_ + static_cast<Eigen::Index>(i)]; }

  private:
    struct Elastic {
        std::size_t a;
        std::size_t b;
        Real rest;
        Real compliance;
    };
    [[nodiscard]] static bool touch(const Elastic& p, const Elastic& q) {
        return p.a == q.a || p.a == q.b || p.b == q.a || p.b == q.b;
    }
    static constexpr int kColumns = 9;
    static constexpr Real kShare = 3e-17L;  // of a step's error in the size of the system

    [[nodiscard]] Eigen::Matrix<Real, 2, 1> apart(const Vector& y, std::size_t a, std::size_t b,
                                                  Eigen::Index first) const {
        const auto i = static_cast<Eigen::Index>(a);
        const auto j = static_cast<Eigen::Index>(b);
        return {y[first + j] - y[first + i], y[first + count_ + j] - y[first + count_ + i]};
    }

    /// Adds what a force does to the acceleration of a particle, or an impulse to its velocity.
    void push(Vector& slope, std::size_t i, const Eigen::Matrix<Real, 2, 1>& force) const {
        const auto k = static_cast<Eigen::Index>(i);
        slope[2 * count_ + k] += inverse_mass_[i] * force[0];
        slope[3 * count_ + k] += inverse_mass_[i] * force[1];
    }

    void add_bends(const Vector& y, Vector& slope) const {
        for (const Bend& bend : bends_) {
            const auto p = apart(y, bend.a, bend.b, 0);
            const auto q = apart(y, bend.b, bend.c, 0);
            const Real pp = p.norm();
            const Real qq = q.norm();
            const Real cosine = p.dot(q) / (pp * qq);
            // -dE/dp and -dE/dq of E = -k cosine.
            const Eigen::Matrix<Real, 2, 1> fp =
                bend.stiffness_n_m * (q / (pp * qq) - cosine / (pp * pp) * p);
            const Eigen::Matrix<Real, 2, 1> fq =
                bend.stiffness_n_m * (p / (pp * qq) - cosine / (qq * qq) * q);
            push(slope, bend.a, -fp);
            push(slope, bend.b, fp - fq);
            push(slope, bend.c, fq);
        }
    }

    /// How strongly two rigid bars pull at each other's ends.
    [[nodiscard]] Real coupling(const Vector& y, const Elastic& bar, const Elastic& other) const {
        const Real weight =
            (bar.a == other.a ? inverse_mass_[bar.a] : 0) + (bar.b == other.b ? inverse_mass_[bar.b] : 0) -
            (bar.a == other.b ? inverse_mass_[bar.a] : 0) - (bar.b == other.a ? inverse_mass_[bar.b] : 0);
        return weight * apart(y, bar.a, bar.b, 0).dot(apart(y, other.a, other.b, 0));
    }

    /// The multipliers of the rigid bars: solves L D L^T in the profile of the matrix.
    Vector solve(const Vector& y, Vector right) {
        const Eigen::Index n = right.size();
        for (Eigen::Index k = 0; k < n; ++k) {
            const auto row = static_cast<std::size_t>(k);
            for (Eigen::Index l = first_[row]; l <= k; ++l) {
                Real sum = coupling(y, rigid_[row], rigid_[static_cast<std::size_t>(l)]);
                for (Eigen::Index m = std::max(first_[row], first_[static_cast<std::size_t>(l)]); m < l; ++m)
                    sum -= matrix_(k, m) * matrix_(l, m) * matrix_(m, m);
                matrix_(k, l) = l < k ? sum / matrix_(l, l) : sum;
            }
            for (Eigen::Index m = first_[row]; m < k; ++m) right[k] -= matrix_(k, m) * right[m];
        }
        for (Eigen::Index k = 0; k < n; ++k) right[k] /= matrix_(k, k);
        for (Eigen::Index k = n; k-- > 0;) {
            for (Eigen::Index m = first_[static_cast<std::size_t>(k)]; m < k; ++m)
                right[m] -= matrix_(k, m) * right[k];
        }
        return right;
    }

    /// Forces or impulses of the rigid bars at `y`: each bar's multiplier times what leads from `a` to `b`,
    /// on `b`.
    void push_along_bars(Vector& slope, const Vector& y, const Vector& multiplier) const {
        for (Eigen::Index k = 0; k < multiplier.size(); ++k) {
            const Elastic& bar = rigid_[static_cast<std::size_t>(k)];
            const Eigen::Matrix<Real, 2, 1> force = multiplier[k] * apart(y, bar.a, bar.b, 0);
            push(slope, bar.a, -force);
            push(slope, bar.b, force);
        }
    }

    void derivative(const Vector& y, Vector& slope) {
        slope.head(2 * count_) = y.tail(2 * count_);
        for (Eigen::Index i = 0; i < count_; ++i) {
            const Real falls = inverse_mass_[static_cast<std::size_t>(i)] > 0 ? 1 : 0;
            slope[2 * count_ + i] = falls * world_.gravity_m_s2.x - world_.drag_1_s * y[2 * count_ + i];
            slope[3 * count_ + i] = falls * world_.gravity_m_s2.y - world_.drag_1_s * y[3 * count_ + i];
        }
        for (const Elastic& bar : elastic_) {
            const auto d = apart(y, bar.a, bar.b, 0);
            const Real now = d.norm();
            const Eigen::Matrix<Real, 2, 1> pull = (now / bar.rest - 1) / bar.compliance / now * d;
            push(slope, bar.a, pull);
            push(slope, bar.b, -pull);
        }
        add_bends(y, slope);
        if (rigid_.empty()) return;
        Vector right(static_cast<Eigen::Index>(rigid_.size()));
        for (Eigen::Index k = 0; k < right.size(); ++k) {
            const Elastic& bar = rigid_[static_cast<std::size_t>(k)];
            right[k] = -apart(y, bar.a, bar.b, 2 * count_).squaredNorm() -
                       apart(y, bar.a, bar.b, 0).dot(apart(slope, bar.a, bar.b, 2 * count_));
        }
        push_along_bars(slope, y, solve(y, right));
    }

    /// The impulses of rigid bars that take what would stretch them from the velocities.
    void remove_stretching() {
        if (rigid_.empty()) return;
        Vector right(static_cast<Eigen::Index>(rigid_.size()));
        for (Eigen::Index k = 0; k < right.size(); ++k) {
            const Elastic& bar = rigid_[static_cast<std::size_t>(k)];
            right[k] = -apart(y_, bar.a, bar.b, 0).dot(apart(y_, bar.a, bar.b, 2 * count_));
        }
        push_along_bars(y_, y_, solve(y_, right));
    }

    /// One step; returns the estimate of the positions' largest error in parts of the size.
    Real extrapolate(Real step, Vector& result) {
        std::array<Vector, kColumns> row;
        Vector slope(4 * count_);
        Vector start_slope(4 * count_);
        derivative(y_, start_slope);
        Real error = 0;
        for (int j = 0; j < kColumns; ++j) {
            const int parts = 2 * (j + 1);
            const Real h = step / parts;
            Vector before = y_;
            Vector now = y_ + h * start_slope;
            for (int m = 1; m < parts; ++m) {
                derivative(now, slope);
                before += 2 * h * slope;
                before.swap(now);
            }
            derivative(now, slope);
            Vector value = (before + now + h * slope) / 2;
            for (int l = 0; l < j; ++l) {
                const Real ratio = Real(parts) / Real(2 * (j - l));
                const Vector finer = value + (value - row[static_cast<std::size_t>(l)]) / (ratio * ratio - 1);
                row[static_cast<std::size_t>(l)] = value;
                value = finer;
            }
            if (j == kColumns - 1)
                error = (value - row[static_cast<std::size_t>(j - 1)]).head(2 * count_).cwiseAbs().maxCoeff();
            row[static_cast<std::size_t>(j)] = value;
        }
        result = row[kColumns - 1];
        return std::isfinite(error) ? error / size_ : Real{1};
    }

    Eigen::Index count_;
    WorldDef world_;
    std::vector<Bend> bends_;
    std::vector<Real> inverse_mass_;
    std::vector<Elastic> rigid_;
    std::vector<Elastic> elastic_;
    Real size_ = 1;
    Vector y_;
    Real time_ = 0;
    Real step_ = 1e-3L;
    Matrix matrix_;
    std::vector<Eigen::Index> first_;  ///< per rigid bar: the first one that it is coupled with
};

}  // namespace corda::test
