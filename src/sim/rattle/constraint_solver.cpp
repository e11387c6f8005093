#include "corda/sim/rattle/constraint_solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "corda/sim/rattle/chain_constraints.hpp"
#include "corda/sim/rattle/graph_constraints.hpp"

namespace corda::sim {

Motion Motion::start_of(const System& system) {
    const std::vector<double> none(system.particle_count(), 0.0);
    return {system.x_m, system.y_m, system.vx_m_s, system.vy_m_s, none, none, none, none};
}

ConstraintSolver::ConstraintSolver(const System& system, std::vector<double> inverse_mass_1_kg)
    : inverse_mass_1_kg_(std::move(inverse_mass_1_kg)) {
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        if (inverse_mass_1_kg_[i] == 0.0) held_.push_back(static_cast<std::uint32_t>(i));
    }
    for (const Bar& bar : rigid_bars(system)) {
        if (inverse_mass_1_kg_[bar.a] > 0.0 || inverse_mass_1_kg_[bar.b] > 0.0)
            links_.push_back({bar.a, bar.b, bar.rest_m});
    }
}

double ConstraintSolver::expected_square_frequency(const System& system, double acceleration_m_s2,
                                                   std::span<const double> multiplier) const {
    std::vector<double> expected = carried_mass(system.mass_kg);
    for (std::size_t k = 0; k < expected.size(); ++k) {
        expected[k] =
            std::max(acceleration_m_s2 * expected[k] / links_[k].rest_m, 2.0 * std::abs(multiplier[k]));
    }
    return square_frequency(expected);
}

void ConstraintSolver::kick(const Stage& stage, Motion& motion) const {
    double* __restrict const vx = motion.vx_m_s.data();
    double* __restrict const vy = motion.vy_m_s.data();
    double* __restrict const lost_x = motion.vx_lost_m_s.data();
    double* __restrict const lost_y = motion.vy_lost_m_s.data();
    const double slowdown = stage.decay - 1.0;
    for (std::size_t i = 0; i < motion.vx_m_s.size(); ++i) {
        add_unrounded(vx[i], lost_x[i], slowdown * vx[i] + stage.push_m_s.x);
        add_unrounded(vy[i], lost_y[i], slowdown * vy[i] + stage.push_m_s.y);
    }
    for (const std::uint32_t i : held_) vx[i] = vy[i] = lost_x[i] = lost_y[i] = 0.0;
}

void ConstraintSolver::drift(double span_s, Motion& motion) {
    double* __restrict const x = motion.x_m.data();
    double* __restrict const y = motion.y_m.data();
    double* __restrict const lost_x = motion.x_lost_m.data();
    double* __restrict const lost_y = motion.y_lost_m.data();
    const double* __restrict const vx = motion.vx_m_s.data();
    const double* __restrict const vy = motion.vy_m_s.data();
    const double* __restrict const lost_vx = motion.vx_lost_m_s.data();
    const double* __restrict const lost_vy = motion.vy_lost_m_s.data();
    for (std::size_t i = 0; i < motion.x_m.size(); ++i) {
        add_unrounded(x[i], lost_x[i], span_s * vx[i] + span_s * lost_vx[i]);
        add_unrounded(y[i], lost_y[i], span_s * vy[i] + span_s * lost_vy[i]);
    }
}

std::unique_ptr<ConstraintSolver> make_constraint_solver(const System& system, const GoesOn& goes_on) {
    if (ChainConstraints::suits(rigid_bars(system))) return std::make_unique<ChainConstraints>(system);
    return std::make_unique<GraphConstraints>(system, goes_on);
}

}  // namespace corda::sim
