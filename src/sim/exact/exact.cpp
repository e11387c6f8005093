#include "corda/sim/exact/exact.hpp"

#include <cassert>
#include <string>

#include "corda/core/cpu.hpp"
#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/chain_part.hpp"
#include "corda/sim/exact/elastic_dynamics.hpp"
#include "corda/sim/exact/string/part.hpp"
#include "corda/sim/refusal.hpp"

namespace corda::sim {
namespace {

/// The series of a longer rope do not fit into a processor's own cache, and fetching them costs more than
/// longer steps save: they take half the time of Dop853 at 1000 links, the same at 3000, 1.6 times as much at
/// 100 000.
constexpr std::size_t kMaxLinksOfSeries = 2000;

void refuse_imaginary_bars(const System& system) {
    for (const Bar& bar : system.bars) {
        if (bar.reach == 1) continue;
        throw Refusal(Refusal::Reason::kImaginaryBars,
                      "method exact moves links between neighbours alone, and the system has bars of reach " +
                          std::to_string(bar.reach) + ", which would make a rope a rigid rod");
    }
}

void refuse_rigid_graph(const Body& body) {
    if (body.is_chain) return;
    throw Refusal(
        Refusal::Reason::kRigidGraph,
        "method exact moves rigid links only if they form an open chain, not a closed rope or a net");
}

/// The part that moves a string of rigid links.
std::unique_ptr<ExactPart> string_part(const System& system, const Forces& forces, const ExactDef& def,
                                       StopCheck& stop) {
    const Body& body = system.bodies.front();
    if (!body.is_chain) {
        throw Refusal(Refusal::Reason::kRigidStringGraph,
                      "method exact moves a string of rigid links only if it is an open chain");
    }
    return std::make_unique<StringPart>(system, body, forces, def.tolerance, stop);
}

/// The part that moves a body.
std::unique_ptr<ExactPart> make_part(const System& system, const Forces& forces, const ExactDef& def,
                                     const GoesOn& goes_on) {
    StopCheck stop(goes_on);
    stop.spend(1 + system.particle_count());
    const Body& body = system.bodies.front();
    if (body.material.compliance_1_n > 0.0) {
        return std::make_unique<OdePart>(std::make_unique<ElasticDynamics>(system, body, forces),
                                         def.tolerance);
    }
    if (!body.material.is_string) refuse_rigid_graph(body);
    refuse_imaginary_bars(system);
    if (body.material.is_string) return string_part(system, forces, def, stop);
    if (body.link_count <= kMaxLinksOfSeries && system.bends.empty()) {
        return std::make_unique<ChainPart>(system, body, forces, def.tolerance);
    }
    return std::make_unique<OdePart>(std::make_unique<ChainDynamics>(system, system.bodies, forces),
                                     def.tolerance);
}

/// Snaps of rigid strings take energy, as drag does.
bool conserves_energy_in(const System& system, const Forces& forces) {
    const MaterialDef& material = system.bodies.front().material;
    return forces.conserve_energy() && !(material.is_string && material.compliance_1_n == 0.0);
}

}  // namespace

Exact::Exact(const System& system, const Forces& forces, const ExactDef& def, const GoesOn& goes_on)
    : Solver(sim::energy_scale_j(system, forces.on_particles(system)), conserves_energy_in(system, forces)),
      def_(def),
      part_(make_part(system, forces, def, goes_on)) {
    assert(system.bodies.size() == 1);
}

Status Exact::advance_to(double time_s, State& state, StopCheck& stop) {
    const FlushDenormals flush;
    state.time_s = time_s;
    return part_->advance_to(time_s, state, stop);
}

}  // namespace corda::sim
