#pragma once

#include <cstddef>
#include <vector>

#include "corda/sim/system.hpp"

namespace corda::peers {

/// XPBD with small steps: Macklin, Mueller and Chentanez, "XPBD" (2016), and Macklin and others, "Small steps
/// in physics simulation" (2019). Each step makes one Gauss-Seidel pass over the bars in their order, as
/// Mueller's public n-pendulum does (https://matthias-research.github.io/pages/challenges/pendulum.html, 50
/// steps per frame of 1/60 s by default).
class Xpbd {
  public:
    std::vector<Vec2> position_m;
    std::vector<Vec2> velocity_m_s;

    /// Bends of the system are ignored.
    Xpbd(const System& system, Vec2 gravity_m_s2)
        : weight_(system.inverse_mass_1_kg), gravity_(gravity_m_s2) {
        for (std::size_t i = 0; i < system.particle_count(); ++i) {
            position_m.push_back({system.x_m[i], system.y_m[i]});
            velocity_m_s.push_back({system.vx_m_s[i], system.vy_m_s[i]});
        }
        previous_ = position_m;
        for (const Body& body : system.bodies) {
            for (std::size_t k = body.first_bar; k < body.first_bar + body.bar_count; ++k) {
                const Bar& bar = system.bars[k];
                const MaterialDef& material = body.material;
                bars_.push_back(
                    {bar.a, bar.b, bar.rest_m, material.compliance_1_n * bar.rest_m, material.is_string});
            }
        }
    }

    void step(double h) {
        for (std::size_t i = 0; i < position_m.size(); ++i) {
            if (weight_[i] == 0.0) continue;
            velocity_m_s[i] = velocity_m_s[i] + h * gravity_;
            previous_[i] = position_m[i];
            position_m[i] = position_m[i] + h * velocity_m_s[i];
        }
        for (const XpbdBar& bar : bars_) project(bar, h);
        for (std::size_t i = 0; i < position_m.size(); ++i)
            velocity_m_s[i] = (1.0 / h) * (position_m[i] - previous_[i]);
    }

  private:
    struct XpbdBar {
        std::size_t a;
        std::size_t b;
        double rest_m;
        double compliance_m_n;
        bool is_string;
    };

    void project(const XpbdBar& bar, double h) {
        const double weight_a = weight_[bar.a];
        const double weight_b = weight_[bar.b];
        const Vec2 along = position_m[bar.b] - position_m[bar.a];
        const double length_m = sim::length(along.x, along.y);
        const double stretch_m = length_m - bar.rest_m;
        if (length_m == 0.0 || weight_a + weight_b == 0.0 || (bar.is_string && stretch_m < 0.0)) return;
        const double multiplier = stretch_m / (weight_a + weight_b + bar.compliance_m_n / (h * h));
        const Vec2 move = (multiplier / length_m) * along;
        position_m[bar.a] = position_m[bar.a] + weight_a * move;
        position_m[bar.b] = position_m[bar.b] - weight_b * move;
    }

    std::vector<double> weight_;  ///< inverse masses
    Vec2 gravity_;
    std::vector<Vec2> previous_;
    std::vector<XpbdBar> bars_;
};

}  // namespace corda::peers
