#include "corda/sim/exact/exact.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/chain_part.hpp"
#include "corda/sim/exact/elastic_dynamics.hpp"
#include "corda/sim/exact/string/part.hpp"
#include "corda/sim/flush_denormals.hpp"
#include "corda/sim/refusal.hpp"

namespace corda::sim {
namespace {

/// The series of a longer rope do not fit into a processor's own cache, and fetching them costs more than
/// longer steps save: they take half the time of Dop853 at 1000 links, the same at 3000, 1.6 times as much at
/// 100 000.
constexpr std::size_t kMostLinksOfSeries = 2000;

bool is_rigid(const Body& body) {
    return body.material.compliance_1_n == 0.0;
}

void refuse_imaginary_bars(const System& system, const Body& body) {
    for (std::size_t k = body.first_bar; k < body.first_bar + body.bar_count; ++k) {
        const Bar& bar = system.bars[k];
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
std::unique_ptr<ExactPart> string_part(const System& system, const Body& body, const Forces& forces,
                                       const ExactDef& def) {
    if (!body.is_chain) {
        throw Refusal(Refusal::Reason::kRigidStringGraph,
                      "method exact moves a string of rigid links only if it is an open chain");
    }
    return std::make_unique<StringPart>(system, body, forces, def.tolerance);
}

bool bends(const System& system, const Body& body) {
    return std::any_of(system.bends.begin(), system.bends.end(), [&](const Bend& bend) {
        return bend.b >= body.first_particle && bend.b < body.first_particle + body.particle_count;
    });
}

/// The part that moves a body.
std::unique_ptr<ExactPart> make_part(const System& system, const Body& body, const Forces& forces,
                                     const ExactDef& def) {
    if (!is_rigid(body)) {
        return std::make_unique<OdePart>(std::make_unique<ElasticDynamics>(system, body, forces),
                                         def.tolerance);
    }
    if (!body.material.is_string) refuse_rigid_graph(body);
    refuse_imaginary_bars(system, body);
    if (body.material.is_string) return string_part(system, body, forces, def);
    if (body.link_count <= kMostLinksOfSeries && !bends(system, body)) {
        return std::make_unique<ChainPart>(system, body, forces, def.tolerance);
    }
    return std::make_unique<OdePart>(
        std::make_unique<ChainDynamics>(system, std::span<const Body>(&body, 1), forces), def.tolerance);
}

/// Snaps of rigid strings take energy, as drag does.
bool conserves_energy_in(const System& system, const Forces& forces) {
    return forces.conserve_energy() &&
           std::none_of(system.bodies.begin(), system.bodies.end(),
                        [](const Body& body) { return body.material.is_string && is_rigid(body); });
}

}  // namespace

Exact::Exact(const System& system, const Forces& forces, const ExactDef& def)
    : Solver(sim::energy_scale_j(system, forces.on_particles(system)), conserves_energy_in(system, forces)),
      def_(def) {
    for (const Body& body : system.bodies) parts_.push_back(make_part(system, body, forces, def));
}

Status Exact::advance_to(double time_s, State& state, StopCheck& stop) {
    const FlushDenormals flush;
    for (const auto& part : parts_) {
        if (part->advance_to(time_s, state, stop) == Status::kDiverged) return Status::kDiverged;
    }
    state.time_s = time_s;
    return Status::kOk;
}

double Exact::energy_j() const {
    double energy_j = 0.0;
    for (const auto& part : parts_) energy_j += part->energy_j();
    return energy_j;
}

std::optional<Loads> Exact::loads() const {
    Loads largest;
    for (const auto& part : parts_) {
        const Loads loads = part->loads();
        largest.pin_force_n = std::max(largest.pin_force_n, loads.pin_force_n);
        largest.largest_tension_n = std::max(largest.largest_tension_n, loads.largest_tension_n);
    }
    return largest;
}

std::uint64_t Exact::steps() const {
    std::uint64_t steps = 0;
    for (const auto& part : parts_) steps += part->steps();
    return steps;
}

std::uint64_t Exact::rejected_steps() const {
    std::uint64_t steps = 0;
    for (const auto& part : parts_) steps += part->rejected_steps();
    return steps;
}

}  // namespace corda::sim
