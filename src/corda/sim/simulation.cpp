#include "corda/sim/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/cpu.hpp"
#include "corda/sim/forces/forces.hpp"
#include "corda/sim/recording.hpp"
#include "corda/sim/solver.hpp"

namespace corda {
namespace {

bool is_sound(const State& state) {
    const auto near = [](double x_m) { return std::abs(x_m) < kMaxCoordinateMetres; };  // false for NaN
    return std::ranges::all_of(state.x_m, near) && std::ranges::all_of(state.y_m, near);
}

/// Throws corda::Refusal for a field outside the range of its declaration.
void check(const WorldDef& world) {
    const auto refuse = [](const char* problem) {
        throw Refusal(Refusal::Reason::kDefinition, std::string("world: ") + problem);
    };
    if (!(world.duration_s > 0.0) || std::isinf(world.duration_s)) refuse("duration_s is not > 0");
    for (const sim::ForceKind& kind : sim::force_kinds()) {
        if (const char* const problem = kind.problem(world)) refuse(problem);
    }
}

}  // namespace

Simulation::Simulation(System system, const WorldDef& world, const MethodDef& method, double frame_interval_s)
    : Simulation(std::move(system), world, std::span(&method, 1), frame_interval_s) {}

Simulation::Simulation(System system, const WorldDef& world, std::span<const MethodDef> methods,
                       double frame_interval_s)
    : system_(std::move(system)) {
    check(world);
    for (const MethodDef& method : methods) sim::validate(method);
    solver_ = sim::make_solver(system_, world, methods, frame_interval_s);
    load_meter_ = std::make_unique<sim::LoadMeter>(system_);
    state_ = {0.0, system_.x_m, system_.y_m};
    next_ = state_;
    conserves_energy_ = solver_->conserves_energy() && system_.moves.empty();  // supports do work
    initial_energy_j_ = solver_->energy_j();
    energy_scale_j_ = solver_->energy_scale_j();
    if (energy_scale_j_ == 0.0) energy_scale_j_ = std::abs(initial_energy_j_);
}

Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

Status Simulation::advance_to(double time_s) {
    if (move_to(time_s, next_) == Status::kDiverged) return Status::kDiverged;
    state_.time_s = next_.time_s;
    state_.x_m.swap(next_.x_m);
    state_.y_m.swap(next_.y_m);
    const CancelScope whole({}, CancelScope::Outer::kIgnored);
    observe();
    return Status::kOk;
}

Status Simulation::pass(double time_s, State& at) {
    return move_to(time_s, at);
}

Status Simulation::move_to(double time_s, State& to) {
    if (is_stepping_) {
        throw Error(ExitCode::kUsage, "advance_to(" + std::to_string(time_s) +
                                          "): the simulation was interrupted; make a new Simulation");
    }
    if (!(time_s >= passed_s_) || std::isinf(time_s)) {
        throw Error(ExitCode::kUsage, "advance_to(" + std::to_string(time_s) + "): the state is already at " +
                                          std::to_string(passed_s_) + " s; make a new Simulation");
    }
    if (has_diverged_) return Status::kDiverged;
    is_stepping_ = true;
    has_diverged_ = solver_->advance_to(time_s, to) == Status::kDiverged || !is_sound(to);
    is_stepping_ = false;
    if (has_diverged_) return Status::kDiverged;
    passed_s_ = time_s;
    return Status::kOk;
}

double Simulation::energy_change_j() const {
    return conserves_energy_ ? figures_.energy_change_j : std::numeric_limits<double>::quiet_NaN();
}

void Simulation::set_outputs(const StateFields& fields) {
    if (fields == fields_) return;
    fields_ = fields;
    if (!fields_.velocities) state_.vx_m_s.clear(), state_.vy_m_s.clear();
    if (!fields_.tensions) state_.tension_n.clear();
    if (fields_.tensions) find_tensions();
    read();
}

void Simulation::read() {
    if (fields_.velocities) {
        for (std::vector<double>* const v_m_s : {&state_.vx_m_s, &state_.vy_m_s}) {
            v_m_s->resize(state_.x_m.size());
            std::ranges::fill(*v_m_s, 0.0);
        }
        solver_->velocities(state_);
    }
    if (!fields_.tensions) return;
    state_.tension_n = tension_n_;
    if (!knows_tensions_ && !fields_.unknown_tensions) {
        throw Refusal(Refusal::Reason::kUnknownTensions,
                      "tensions are asked for, which the method does not know: relaxation has none, and bars "
                      "that depend on each other share them in any way");
    }
}

void Simulation::find_tensions() {
    tension_n_.assign(system_.bars.size(), 0.0);
    knows_tensions_ = solver_->tensions(tension_n_);
}

void Simulation::observe() {
    const FlushDenormals flush;
    find_tensions();
    read();
    figures_.strain = sim::max_strain(system_, state_);
    figures_.energy_change_j = solver_->energy_j() - initial_energy_j_;
    figures_.energy_error = sim::energy_error(energy_change_j(), energy_scale_j_);
    figures_.loads = std::nullopt;
    if (knows_tensions_) figures_.loads = load_meter_->of(system_, state_, tension_n_);
    diagnostics_.steps = solver_->steps();
    diagnostics_.largest = sim::larger_figures(diagnostics_.largest, figures_);
    if (!diagnostics_.branched_s && solver_->has_branched()) diagnostics_.branched_s = state_.time_s;
}

std::vector<MethodDef> Simulation::methods() const {
    std::vector<MethodDef> methods = solver_->methods();
    methods.resize(system_.bodies.size(), methods.front());
    return methods;
}

std::uint64_t Simulation::steps() const {
    return solver_->steps();
}

}  // namespace corda
