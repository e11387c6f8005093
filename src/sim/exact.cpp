#include "corda/sim/exact.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <string>

#include "corda/core/error.hpp"
#include "corda/sim/chain_part.hpp"

namespace corda::sim {
namespace {

/// The series of a longer rope do not fit into a processor's own cache, and fetching them costs more than the
/// longer steps save: at 1000 links they take half the time of Dop853, at 3000 the same, at 100 000 1.6 times
/// as much.
constexpr std::size_t kMostLinksOfSeries = 2000;

void refuse_imaginary_bars(const System& system) {
    for (const Bar& bar : system.bars) {
        if (bar.reach == 1) continue;
        throw Error(ExitCode::kInvalidScene,
                    "method exact moves links between neighbours only, and this scene has bars of reach " +
                        std::to_string(bar.reach) +
                        ", which would make a rope a rigid rod; set reach = 1 or use method relaxation");
    }
}

}  // namespace

Exact::Exact(const System& system, const WorldDef& world, const SolverDef& def, double /*frame_interval_s*/) {
    refuse_imaginary_bars(system);
    for (const Body& body : system.bodies) {
        if (system.bends.empty() && body.link_count <= kMostLinksOfSeries) {
            parts_.push_back(std::make_unique<ChainPart>(system, body, world, def.tolerance));
        } else {
            parts_.push_back(std::make_unique<OdePart>(
                std::make_unique<ChainDynamics>(system, std::span<const Body>(&body, 1), world),
                def.tolerance, world.drag_1_s == 0.0));
        }
    }
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
