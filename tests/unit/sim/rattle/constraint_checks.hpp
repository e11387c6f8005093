#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "corda/sim/rattle/constraint_solver.hpp"

// Checks of every ConstraintSolver, with dense matrices.
namespace corda::test {

/// G: a row per link, which gives d . (v_b - v_a) for the velocities of all particles, x before y.
inline Eigen::MatrixXd jacobian(const System& system, std::span<const sim::Link> links) {
    const auto particles = static_cast<Eigen::Index>(system.particle_count());
    Eigen::MatrixXd g = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(links.size()), 2 * particles);
    for (std::size_t k = 0; k < links.size(); ++k) {
        const auto [a, b, rest_m] = links[k];
        const auto row = static_cast<Eigen::Index>(k);
        const double dx = system.x_m[b] - system.x_m[a];
        const double dy = system.y_m[b] - system.y_m[a];
        g(row, a) = -dx;
        g(row, b) = dx;
        g(row, particles + a) = -dy;
        g(row, particles + b) = dy;
    }
    return g;
}

inline Eigen::MatrixXd inverse_masses(const System& system) {
    const auto particles = static_cast<Eigen::Index>(system.particle_count());
    const Eigen::Map<const Eigen::VectorXd> w(system.inverse_mass_1_kg.data(), particles);
    Eigen::VectorXd both(2 * particles);
    both << w, w;
    return both.asDiagonal();
}

/// Difference from the solution with a dense matrix, relative to the largest value.
inline double error_of_solution(sim::ConstraintSolver& constraints, const System& system) {
    const std::size_t count = constraints.links().size();
    std::mt19937 random(5);
    std::vector<double> right(count);
    for (double& value : right) value = static_cast<double>(random()) / 2147483648.0 - 1.0;
    const Eigen::MatrixXd g = jacobian(system, constraints.links());
    const Eigen::Map<const Eigen::VectorXd> dense_right(right.data(), static_cast<Eigen::Index>(count));
    const Eigen::VectorXd expected =
        (g * inverse_masses(system) * g.transpose()).fullPivLu().solve(dense_right);
    EXPECT_TRUE(constraints.solve(sim::Motion::start_of(system), right));
    double largest_error = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
        const double error = std::abs(right[k] - expected(static_cast<Eigen::Index>(k)));
        largest_error = std::max(largest_error, error / expected.cwiseAbs().maxCoeff());
    }
    return largest_error;
}

/// Solves a stage from rest. All bars must have their lengths at its end, by v = push - W G' p: a positive
/// impulse p pulls both ends together.
inline void expect_impulses_along_the_bars(sim::ConstraintSolver& constraints, const System& system) {
    const std::size_t count = constraints.links().size();
    sim::Motion motion = sim::Motion::start_of(system);
    std::vector<double> impulse(count, 0.0);
    const sim::Stage stage{0.01, 0.9, {0.02, -0.05}};
    ASSERT_TRUE(constraints.move(stage, motion, impulse));
    for (const sim::Link& link : constraints.links()) {
        const double length_m =
            std::hypot(motion.x_m[link.b] - motion.x_m[link.a], motion.y_m[link.b] - motion.y_m[link.a]);
        EXPECT_NEAR(length_m / link.rest_m, 1.0, 1e-14);
    }
    const auto particles = static_cast<Eigen::Index>(system.particle_count());
    const Eigen::Map<const Eigen::VectorXd> p(impulse.data(), static_cast<Eigen::Index>(count));
    const Eigen::VectorXd change =
        -(inverse_masses(system) * jacobian(system, constraints.links()).transpose() * p);
    for (Eigen::Index i = 0; i < particles; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const Vec2 push_m_s = system.is_pinned(k) ? Vec2{} : stage.push_m_s;
        EXPECT_NEAR(motion.vx_m_s[k], push_m_s.x + change(i), 1e-14);
        EXPECT_NEAR(motion.vy_m_s[k], push_m_s.y + change(particles + i), 1e-14);
        EXPECT_NEAR(motion.x_m[k], system.x_m[k] + stage.span_s * motion.vx_m_s[k], 1e-15);
    }
}

/// Solves a stage that is too long: a bar would have to turn too far, and no impulses can do that.
inline void expect_to_give_up(sim::ConstraintSolver& constraints, const System& system) {
    sim::Motion motion = sim::Motion::start_of(system);
    std::vector<double> impulse(constraints.links().size(), 0.0);
    EXPECT_FALSE(constraints.move({1.0, 1.0, {0.0, -10.0}}, motion, impulse));
}

}  // namespace corda::test
