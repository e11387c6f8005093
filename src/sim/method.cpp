#include <algorithm>
#include <array>
#include <utility>

#include "corda/sim/defs.hpp"

namespace corda::sim {
namespace {

constexpr std::array<std::pair<Method, std::string_view>, 4> kMethods{{
    {Method::kAuto, "auto"},
    {Method::kRelaxation, "relaxation"},
    {Method::kRope, "rope"},
    {Method::kExact, "exact"},
}};

}  // namespace

SolverDef exact_solver(double tolerance) {
    SolverDef solver;
    solver.method = Method::kExact;
    solver.reach = 1;
    solver.tolerance = tolerance;
    return solver;
}

SolverDef rope_solver(int order, std::optional<double> step_s) {
    SolverDef solver;
    solver.method = Method::kRope;
    solver.reach = 1;
    solver.order = order;
    solver.step_s = step_s;
    return solver;
}

SolverDef relaxation_solver(double step_s, int reach, int sweeps) {
    SolverDef solver;
    solver.method = Method::kRelaxation;
    solver.step_s = step_s;
    solver.reach = reach;
    solver.sweeps = sweeps;
    return solver;
}

std::string_view method_name(Method method) {
    const auto* found = std::find_if(kMethods.begin(), kMethods.end(),
                                     [method](const auto& row) { return row.first == method; });
    return found->second;
}

std::optional<Method> parse_method(std::string_view name) {
    for (const auto& [method, method_text] : kMethods) {
        if (method_text == name) return method;
    }
    return std::nullopt;
}

std::vector<std::string_view> method_names() {
    std::vector<std::string_view> names;
    for (const auto& row : kMethods) names.push_back(row.second);
    return names;
}

}  // namespace corda::sim
