#include "corda/sim/constraint_solver.hpp"

#include "corda/sim/chain_constraints.hpp"
#include "corda/sim/graph_constraints.hpp"

namespace corda::sim {

Motion Motion::start_of(const System& system) {
    const std::vector<double> none(system.particle_count(), 0.0);
    return {system.x_m, system.y_m, system.vx_m_s, system.vy_m_s, none, none, none, none};
}

ConstraintSolver::ConstraintSolver(const System& system) : inverse_mass_1_kg_(system.inverse_mass_1_kg) {
    for (std::size_t i = 0; i < system.particle_count(); ++i) {
        if (system.is_pinned(i)) pinned_.push_back(static_cast<std::uint32_t>(i));
    }
    for (const Bar& bar : rigid_bars(system)) {
        if (!system.is_pinned(bar.a) || !system.is_pinned(bar.b))
            links_.push_back({bar.a, bar.b, bar.rest_m});
    }
}

void ConstraintSolver::kick(const Stage& stage, Motion& motion) const {
    double* __restrict const vx = motion.vx_m_s.data();
    double* __restrict const vy = motion.vy_m_s.data();
    double* __restrict const rest_x = motion.vx_rest_m_s.data();
    double* __restrict const rest_y = motion.vy_rest_m_s.data();
    const double lost = stage.decay - 1.0;
    for (std::size_t i = 0; i < motion.vx_m_s.size(); ++i) {
        add_unrounded(vx[i], rest_x[i], lost * vx[i] + stage.push_m_s.x);
        add_unrounded(vy[i], rest_y[i], lost * vy[i] + stage.push_m_s.y);
    }
    for (const std::uint32_t i : pinned_) vx[i] = vy[i] = rest_x[i] = rest_y[i] = 0.0;
}

void ConstraintSolver::drift(double span_s, Motion& motion) {
    double* __restrict const x = motion.x_m.data();
    double* __restrict const y = motion.y_m.data();
    double* __restrict const rest_x = motion.x_rest_m.data();
    double* __restrict const rest_y = motion.y_rest_m.data();
    const double* __restrict const vx = motion.vx_m_s.data();
    const double* __restrict const vy = motion.vy_m_s.data();
    const double* __restrict const rest_vx = motion.vx_rest_m_s.data();
    const double* __restrict const rest_vy = motion.vy_rest_m_s.data();
    for (std::size_t i = 0; i < motion.x_m.size(); ++i) {
        add_unrounded(x[i], rest_x[i], span_s * vx[i] + span_s * rest_vx[i]);
        add_unrounded(y[i], rest_y[i], span_s * vy[i] + span_s * rest_vy[i]);
    }
}

std::unique_ptr<ConstraintSolver> make_constraint_solver(const System& system) {
    if (ChainConstraints::suits(rigid_bars(system))) return std::make_unique<ChainConstraints>(system);
    return std::make_unique<GraphConstraints>(system);
}

}  // namespace corda::sim
