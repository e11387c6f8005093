#include "corda/sim/exact.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "corda/core/error.hpp"
#include "corda/sim/chain_dynamics.hpp"
#include "corda/sim/chain_part.hpp"
#include "corda/sim/elastic_dynamics.hpp"
#include "corda/sim/string_part.hpp"
#include "corda/sim/terms.hpp"

namespace corda::sim {
namespace {

/// The series of a longer rope do not fit into a processor's own cache, and fetching them costs more than the
/// longer steps save: at 1000 links they take half the time of Dop853, at 3000 the same, at 100 000 1.6 times
/// as much.
constexpr std::size_t kMostLinksOfSeries = 2000;

bool is_rigid(const Body& body) {
    return body.material.compliance_1_n == 0.0;
}

void refuse_imaginary_bars(const System& system, const Body& body) {
    for (std::size_t k = body.first_bar; k < body.first_bar + body.bar_count; ++k) {
        const Bar& bar = system.bars[k];
        if (bar.reach == 1) continue;
        throw Error(ExitCode::kInvalidScene,
                    "method exact moves links between neighbours only, and this scene has bars of reach " +
                        std::to_string(bar.reach) +
                        ", which would make a rope a rigid rod; set reach = 1 or use method relaxation");
    }
}

void refuse_rigid_graph(const Body& body) {
    if (body.is_chain) return;
    throw Error(ExitCode::kInvalidScene,
                "method exact moves chains of rigid links; a closed rope or a net of rigid bars needs method "
                "rope: set method = \"rope\", or let the bars stretch by a compliance");
}

/// The part that moves a string of rigid links.
std::unique_ptr<ExactPart> string_part(const System& system, const Body& body, const WorldDef& world,
                                       const SolverDef& def) {
    if (!body.is_chain) {
        throw Error(
            ExitCode::kInvalidScene,
            "method exact moves a string of rigid links only where it is an open chain; open it, or let "
            "it stretch by a compliance");
    }
    return std::make_unique<StringPart>(system, body, world, def.tolerance);
}

bool bends(const System& system, const Body& body) {
    return std::any_of(system.bends.begin(), system.bends.end(), [&](const Bend& bend) {
        return bend.b >= body.first_particle && bend.b < body.first_particle + body.particle_count;
    });
}

/// The part that moves a body.
std::unique_ptr<ExactPart> make_part(const System& system, const Body& body, const WorldDef& world,
                                     const SolverDef& def) {
    const bool conserves_energy = world.drag_1_s == 0.0;
    if (kTermsCompiledIn && !is_rigid(body)) {
        return std::make_unique<OdePart>(std::make_unique<ElasticDynamics>(system, body, world),
                                         def.tolerance, conserves_energy);
    }
    if (!body.material.is_string) refuse_rigid_graph(body);
    refuse_imaginary_bars(system, body);
    if (kTermsCompiledIn && body.material.is_string) return string_part(system, body, world, def);
    if (body.link_count <= kMostLinksOfSeries && !(kTermsCompiledIn && bends(system, body))) {
        return std::make_unique<ChainPart>(system, body, world, def.tolerance);
    }
    return std::make_unique<OdePart>(
        std::make_unique<ChainDynamics>(system, std::span<const Body>(&body, 1), world), def.tolerance,
        conserves_energy);
}

}  // namespace

Exact::Exact(const System& system, const WorldDef& world, const SolverDef& def, double /*frame_interval_s*/) {
    for (const Body& body : system.bodies) parts_.push_back(make_part(system, body, world, def));
}

Status Exact::advance_to(double time_s, State& state) {
    for (const auto& part : parts_) {
        if (part->advance_to(time_s, state) == Status::kDiverged) return Status::kDiverged;
    }
    state.time_s = time_s;
    return Status::kOk;
}

double Exact::energy_j() const {
    double energy_j = 0.0;
    for (const auto& part : parts_) energy_j += part->energy_j();
    return energy_j;
}

double Exact::energy_scale_j() const {
    double scale_j = 0.0;
    for (const auto& part : parts_) scale_j += part->energy_scale_j();
    return scale_j;
}

bool Exact::conserves_energy() const {
    return std::all_of(parts_.begin(), parts_.end(),
                       [](const auto& part) { return part->conserves_energy(); });
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
