#include "corda/sim/body_solvers.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "corda/sim/figures.hpp"

namespace corda::sim {
namespace {

double sum_of_scales_j(const std::vector<BodySolvers::Part>& parts) {
    return std::accumulate(parts.begin(), parts.end(), 0.0, [](double sum_j, const BodySolvers::Part& part) {
        return sum_j + part.solver->energy_scale_j();
    });
}

bool all_conserve_energy(const std::vector<BodySolvers::Part>& parts) {
    return std::all_of(parts.begin(), parts.end(),
                       [](const BodySolvers::Part& part) { return part.solver->conserves_energy(); });
}

void put(const std::vector<double>& values, std::size_t first, std::vector<double>& all) {
    std::copy(values.begin(), values.end(), all.begin() + static_cast<std::ptrdiff_t>(first));
}

}  // namespace

BodySolvers::BodySolvers(std::vector<Part> parts)
    : Solver(sum_of_scales_j(parts), all_conserve_energy(parts)), parts_(std::move(parts)) {}

Status BodySolvers::advance_to(double time_s, State& state, StopCheck& stop) {
    for (Part& part : parts_) {
        if (part.solver->advance_to(time_s, part.state, stop) == Status::kDiverged) return Status::kDiverged;
        put(part.state.x_m, part.first_particle, state.x_m);
        put(part.state.y_m, part.first_particle, state.y_m);
    }
    state.time_s = time_s;
    return Status::kOk;
}

double BodySolvers::energy_j() const {
    double energy_j = 0.0;
    for (const Part& part : parts_) energy_j += part.solver->energy_j();
    return energy_j;
}

bool BodySolvers::has_branched() const {
    return std::any_of(parts_.begin(), parts_.end(),
                       [](const Part& part) { return part.solver->has_branched(); });
}

std::optional<Loads> BodySolvers::loads() const {
    std::optional<Loads> largest = Loads{};
    for (const Part& part : parts_) largest = loads_of_both(largest, part.solver->loads());
    return largest;
}

void BodySolvers::velocities(std::vector<double>& vx_m_s, std::vector<double>& vy_m_s) {
    for (Part& part : parts_) {
        part.state.vx_m_s.assign(part.state.x_m.size(), 0.0);
        part.state.vy_m_s.assign(part.state.x_m.size(), 0.0);
        part.solver->velocities(part.state.vx_m_s, part.state.vy_m_s);
        put(part.state.vx_m_s, part.first_particle, vx_m_s);
        put(part.state.vy_m_s, part.first_particle, vy_m_s);
    }
}

bool BodySolvers::tensions(std::vector<double>& tension_n) {
    bool are_known = true;
    for (Part& part : parts_) {
        are_known = part.solver->tensions(part.state.tension_n) && are_known;
        put(part.state.tension_n, part.first_bar, tension_n);
    }
    return are_known;
}

std::uint64_t BodySolvers::steps() const {
    std::uint64_t steps = 0;
    for (const Part& part : parts_) steps += part.solver->steps();
    return steps;
}

std::vector<MethodDef> BodySolvers::methods() const {
    std::vector<MethodDef> methods;
    for (const Part& part : parts_) methods.push_back(part.solver->methods().front());
    return methods;
}

}  // namespace corda::sim
