#include "corda/sim/simulation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "corda/sim/distance.hpp"
#include "corda/sim/exact.hpp"
#include "corda/sim/flush_denormals.hpp"
#include "corda/sim/rattle.hpp"
#include "corda/sim/relaxation.hpp"

namespace corda::sim {
namespace {

/// Farther out than this nothing is meant to go: the run has diverged.
constexpr double kFarthestMetres = 1e12;

bool is_sound(const State& state) {
    const auto near = [](double x_m) { return std::abs(x_m) < kFarthestMetres; };  // false for NaN
    return std::all_of(state.x_m.begin(), state.x_m.end(), near) &&
           std::all_of(state.y_m.begin(), state.y_m.end(), near);
}

double max_strain(const System& system, const State& state) {
    double largest = 0.0;
    for (const Body& body : system.bodies) {
        for (std::size_t k = body.first_bar; k < body.first_bar + body.link_count; ++k) {
            const Bar& bar = system.bars[k];
            const double distance =
                length(state.x_m[bar.b] - state.x_m[bar.a], state.y_m[bar.b] - state.y_m[bar.a]);
            const double strain = distance / bar.rest_m - 1.0;
            largest = std::max(largest, body.material.is_string ? strain : std::abs(strain));
        }
    }
    return largest;
}

}  // namespace

std::unique_ptr<Solver> make_solver(const System& system, const WorldDef& world, const SolverDef& def,
                                    double frame_interval_s) {
    switch (def.method) {
        case Method::kAuto:
            break;
        case Method::kRelaxation:
            return std::make_unique<Relaxation>(system, world, def, frame_interval_s);
        case Method::kRope:
            return std::make_unique<Rattle>(system, world, def, frame_interval_s);
        case Method::kExact:
            return std::make_unique<Exact>(system, world, def, frame_interval_s);
    }
    assert(false && "make_solver: auto has to be settled by a plan first");
    return nullptr;
}

Simulation::Simulation(System system, const WorldDef& world, const SolverDef& solver, double frame_interval_s,
                       Figured figured)
    : system_(std::move(system)),
      solver_(make_solver(system_, world, solver, frame_interval_s)),
      state_{0.0, system_.x_m, system_.y_m},
      next_(state_),
      figured_(figured),
      conserves_energy_(solver_->conserves_energy()),
      initial_energy_j_(solver_->energy_j()),
      energy_scale_j_(solver_->energy_scale_j()) {
    if (energy_scale_j_ == 0.0) energy_scale_j_ = std::abs(initial_energy_j_);
}

Status Simulation::advance_to(double time_s) {
    assert(time_s >= state_.time_s);
    if (solver_->advance_to(time_s, next_) == Status::kDiverged || !is_sound(next_)) return Status::kDiverged;
    std::swap(state_, next_);
    if (figured_ == Figured::kYes) observe();
    return Status::kOk;
}

void Simulation::observe() {
    const FlushDenormals flush;
    figures_.strain = max_strain(system_, state_);
    largest_.strain = std::max(largest_.strain, figures_.strain);
    if (conserves_energy_ && energy_scale_j_ > 0.0) {
        figures_.energy_error = std::abs(solver_->energy_j() - initial_energy_j_) / energy_scale_j_;
        largest_.energy_error = std::max(largest_.energy_error.value_or(0.0), *figures_.energy_error);
    }
    figures_.loads = solver_->loads();
    if (!figures_.loads) return;
    const Loads before = largest_.loads.value_or(Loads{});
    largest_.loads = Loads{std::max(before.pin_force_n, figures_.loads->pin_force_n),
                           std::max(before.largest_tension_n, figures_.loads->largest_tension_n)};
}

Diagnostics Simulation::diagnostics() const {
    return {solver_->steps(), largest_};
}

}  // namespace corda::sim
