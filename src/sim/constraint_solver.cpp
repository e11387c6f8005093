#include "corda/sim/constraint_solver.hpp"

#include "corda/sim/chain_constraints.hpp"
#include "corda/sim/graph_constraints.hpp"

namespace corda::sim {

std::unique_ptr<ConstraintSolver> make_constraint_solver(const System& system) {
    if (ChainConstraints::suits(rigid_bars(system))) return std::make_unique<ChainConstraints>(system);
    return std::make_unique<GraphConstraints>(system);
}

}  // namespace corda::sim
