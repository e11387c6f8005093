#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "corda/scene/readers.hpp"

namespace corda::scene {
namespace {

/// A key that only some methods use, by the names of scene files.
struct MethodKey {
    std::string_view key;
    std::string_view methods;
    bool relaxation;
};

constexpr std::array kMethodKeys{
    MethodKey{"tolerance_px", "\"auto\"", false}, MethodKey{"tolerance", "\"exact\"", false},
    MethodKey{"order", "\"rope\"", false},        MethodKey{"step", "\"rope\" and \"relaxation\"", true},
    MethodKey{"reach", "\"relaxation\"", true},   MethodKey{"sweeps", "\"relaxation\"", true},
    MethodKey{"delta", "\"relaxation\"", true},   MethodKey{"force", "\"relaxation\"", true},
};

/// The methods of the schema that a build may lack.
constexpr std::array<std::string_view, 3> kPlannedMethods{"auto", "rope", "exact"};

sim::Method read_method(const TableReader& solver) {
    const auto value = solver.find("method");
    if (!value) return sim::SolverDef{}.method;
    const auto names = sim::method_names();
    const std::string_view name = value->text("give one of: " + joined(names));
    if (const auto method = sim::parse_method(name)) return *method;
    if (std::find(kPlannedMethods.begin(), kPlannedMethods.end(), name) != kPlannedMethods.end()) {
        value->fail(
            fmt::format("\"{}\" is not available in this version; give one of: {}", name, joined(names)));
    }
    return sim::parse_method(names[value->choice(names)]).value_or(sim::Method::kRelaxation);
}

bool uses(sim::Method method, const MethodKey& key) {
    switch (method) {
        case sim::Method::kRelaxation:
            return key.relaxation;
    }
    return false;
}

void refuse_foreign_keys(const TableReader& solver, sim::Method method) {
    for (const MethodKey& key : kMethodKeys) {
        const auto value = solver.find(key.key);
        if (!value || uses(method, key)) continue;
        value->fail(fmt::format("method \"{}\" does not use it, only {}; remove it", sim::method_name(method),
                                key.methods));
    }
}

/// Keys of methods that do not exist yet: a value that is wrong is wrong whatever the method.
void check_other_methods(const TableReader& solver) {
    constexpr std::string_view kOrder = "give an order of 2, 4, 6 or 8";
    double unused = 0.0;
    solver.read_number("tolerance_px", unused, kPositive, "give a tolerance in pixels");
    solver.read_number("tolerance", unused, {.low = 0.0, .high = 1e-2, .low_open = true},
                       "give a tolerance relative to the rope's length");
    if (const auto order = solver.find("order")) {
        const std::int64_t value = order->integer(2, 8, kOrder);
        if (value % 2 != 0) order->fail(fmt::format("{} is not even; {}", value, kOrder));
    }
}

}  // namespace

sim::SolverDef read_solver(const TableReader& solver) {
    constexpr int kMostSweeps = 1'000'000;
    sim::SolverDef def;
    def.method = read_method(solver);
    check_other_methods(solver);
    solver.read_number("step", def.step_s, {.low = 1e-9}, "give a step in s");
    solver.read_integer("reach", def.reach, 1, static_cast<int>(Limits::kParticles),
                        "give the number of next particles that bars go to");
    solver.read_integer("sweeps", def.sweeps, 1, kMostSweeps, "give the number of passes a step");
    solver.read_number("delta", def.delta, {.low = 0.0, .high = 1.0, .high_open = true},
                       "give the share of the velocity lost a step");
    if (const auto force = solver.find("force")) {
        def.force_n = force->pair(kAnyNumber, "give a force as [fx, fy] in N");
    }
    refuse_foreign_keys(solver, def.method);
    return def;
}

}  // namespace corda::scene
