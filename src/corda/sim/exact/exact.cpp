#include "corda/sim/exact/exact.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "corda/core/cancel.hpp"
#include "corda/core/cpu.hpp"
#include "corda/sim/exact/bar_dynamics.hpp"
#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/chain_series.hpp"
#include "corda/sim/exact/elastic_dynamics.hpp"
#include "corda/sim/exact/implicit_part.hpp"
#include "corda/sim/exact/net_dynamics.hpp"
#include "corda/sim/exact/string/part.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

// Steps as shares of the time scale. The first two are for a tolerance of 1 and shrink with its 16th root, so
// that a run and its check at a tighter tolerance take different steps even if nothing else limits them.
constexpr double kFirstStep = 4e-3;
constexpr double kMaxStep = 1.0;
/// Light links that a heavy mass pulls taut are in line for the ratio of their masses times this time scale.
/// A step too short for the time to change ends a run in any case.
constexpr double kMinStep = 1e-18;

/// Share of the tolerance that one step may use. Errors of steps add up and, in a rope, grow. With this
/// share, positions after some seconds are correct to about the tolerance unless the motion is chaotic (R5:
/// 1e-13 .. 6e-10 at 1e-9, R1 after 2000 s: 1e-6; with a share of 1: 5e-8 and 2e-4). Steps shrink with its
/// eighth root.
constexpr double kShareOfAStep = 0.01;

/// Share of a step below which the error estimate is rounding alone.
constexpr double kMinShare = 1e-15;

/// The series of a longer rope exceed a core's cache. Time relative to Dop853: 0.5 at 1000 links, 1 at 3000,
/// 1.6 at 100 000.
constexpr std::size_t kMaxLinksOfSeries = 2000;

void refuse_imaginary_bars(const System& system) {
    for (const Bar& bar : system.bars) {
        if (bar.reach == 1) continue;
        throw Refusal(Refusal::Reason::kImaginaryBars,
                      "method exact moves links between neighbours alone, and the system has bars of reach " +
                          std::to_string(bar.reach) + ", which would make a rope a rigid rod");
    }
}

void refuse_rigid_string_graph(const Body& body) {
    if (body.is_chain) return;
    throw Refusal(Refusal::Reason::kRigidStringGraph,
                  "method exact moves a string of rigid links only if it is an open chain");
}

/// Pins that move alike rest in the frame in which such bodies are solved.
void refuse_unlike_moves(const System& system, const Body& body) {
    if (system.moves.empty()) return;
    if (body.material.is_string)
        throw Refusal(Refusal::Reason::kUnlikeMoves,
                      "a string of rigid links moves only with pins that move alike");
    if (!moves_as_chains(system, body))
        throw Refusal(
            Refusal::Reason::kUnlikeMoves,
            "method exact moves rigid nets only with pins that move alike, and method rattle others too");
}

/// In the rotations of groups of bars if these can turn independently.
std::unique_ptr<Dynamics> make_net_dynamics(const System& system, const Forces& forces) {
    try {
        return std::make_unique<NetDynamics>(system, forces);
    } catch (const Refusal& refused) {
        if (refused.reason() != Refusal::Reason::kRigidGraph) throw;
    }
    return std::make_unique<BarDynamics>(system, forces);
}

/// False with drag, and for rigid strings, whose snaps lose energy.
bool conserves_energy_in(const System& system, const Forces& forces) {
    const MaterialDef& material = system.bodies.front().material;
    return forces.conserve_energy() && !(material.is_string && material.compliance_1_n == 0.0);
}

/// At the limit of stability, steps shrink with the 64th root of the tolerance: those of a check at a ten
/// thousandth of a run's tolerance are 0.87 times as long, and its errors a third.
StepControl steps_of(const Dynamics& dynamics, double tolerance) {
    const double motion_1_s = dynamics.inverse_timescale_1_s();
    const double vibration_1_s = dynamics.inverse_stable_step_1_s();
    StepControl control = step_control(std::max(motion_1_s, vibration_1_s), tolerance);
    if (vibration_1_s == 0.0) return control;
    const double largest_s = step_control(motion_1_s, tolerance).largest_s;
    control.largest_s = std::min(largest_s, std::sqrt(std::sqrt(largest_s * motion_1_s)) / vibration_1_s);
    return control;
}

}  // namespace

StepControl step_control(double inverse_timescale_1_s, double tolerance) {
    assert(tolerance >= ExactDef::kMinTolerance && tolerance <= ExactDef::kMaxTolerance);
    const double pace = std::sqrt(std::sqrt(std::sqrt(std::sqrt(tolerance))));
    return {std::max(kShareOfAStep * tolerance, kMinShare), pace * kFirstStep / inverse_timescale_1_s,
            pace * kMaxStep / inverse_timescale_1_s, kMinStep / inverse_timescale_1_s};
}

OdePart::OdePart(const System& system, const Forces& forces, std::unique_ptr<Dynamics> dynamics,
                 double tolerance)
    : Exact(system, forces, {tolerance}, dynamics->initial_state()),
      dynamics_(std::move(dynamics)),
      integrator_(*dynamics_, dynamics_->initial_state(), dynamics_->error_scales(),
                  steps_of(*dynamics_, tolerance)) {}

Status OdePart::reach(double time_s, State& state) {
    if (integrator_.advance_to(time_s) == Status::kDiverged) return Status::kDiverged;
    integrator_.interpolate(time_s, output_.data());
    dynamics_->set_time(time_s);
    dynamics_->project(output_.data());
    dynamics_->positions(output_.data(), state);
    // Steps end where tensions are known; the interpolation may ask for them between, where bars are in line.
    const bool is_known = std::ranges::all_of(output_, [](double value) { return std::isfinite(value); });
    return is_known ? Status::kOk : Status::kDiverged;
}

Exact::Exact(const System& system, const Forces& forces, const ExactDef& def, std::vector<double> output)
    : Solver(sim::energy_scale_j(system, forces.on_particles(system)), conserves_energy_in(system, forces)),
      output_(std::move(output)),
      def_(def) {
    assert(system.bodies.size() == 1);
}

std::unique_ptr<Exact> Exact::make(const System& system, const Forces& forces, const ExactDef& def) {
    count_work(1 + system.particle_count());
    const Body& body = system.bodies.front();
    if (def.implicit) {
        refuse_imaginary_bars(system);
        return std::make_unique<ImplicitPart>(system, forces, def);
    }
    if (body.material.compliance_1_n > 0.0) {
        return std::make_unique<OdePart>(system, forces, std::make_unique<ElasticDynamics>(system, forces),
                                         def.tolerance);
    }
    refuse_unlike_moves(system, body);
    if (!body.material.is_string && !moves_as_chains(system, body)) {
        return std::make_unique<OdePart>(system, forces, make_net_dynamics(system, forces), def.tolerance);
    }
    refuse_imaginary_bars(system);
    if (body.material.is_string) {
        refuse_rigid_string_graph(body);
        return std::make_unique<StringPart>(system, forces, def.tolerance);
    }
    if (body.link_count <= kMaxLinksOfSeries && system.bends.empty()) {
        return std::make_unique<ChainPart>(system, forces, def.tolerance);
    }
    return std::make_unique<OdePart>(
        system, forces, std::make_unique<ChainDynamics>(system, system.bodies, forces), def.tolerance);
}

const char* Exact::problem_of(const ExactDef& def) {
    const bool is_in_range =
        def.tolerance >= ExactDef::kMinTolerance && def.tolerance <= ExactDef::kMaxTolerance;
    return is_in_range ? nullptr : "tolerance is not within its range";
}

std::string Exact::text_of(const ExactDef& def) {
    return fmt::format("exact at tolerance {:.3g}{}", def.tolerance, def.implicit ? ", implicit steps" : "");
}

Status Exact::advance_to(double time_s, State& state) {
    const FlushDenormals flush;
    state.time_s = time_s;
    return reach(time_s, state);
}

}  // namespace corda::sim
