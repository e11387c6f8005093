#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <vector>

#include "corda/scene/readers.hpp"

namespace corda::scene {
namespace {

/// A key that only some methods use.
struct MethodKey {
    std::string_view key;
    std::initializer_list<sim::Method> methods;
    std::string_view remedy = "remove it";
};

const std::array<MethodKey, 8> method_keys{{
    {"tolerance_px", {sim::Method::kAuto}},
    {"tolerance", {sim::Method::kExact}},
    {"order", {sim::Method::kRope}},
    {"step", {sim::Method::kRope, sim::Method::kRelaxation}},
    {"reach",
     {sim::Method::kRelaxation},
     "remove it: bars to farther particles make a straight rope a rigid rod, and its equations singular"},
    {"sweeps", {sim::Method::kRelaxation}},
    {"delta", {sim::Method::kRelaxation}, "remove it, or give world.drag"},
    {"force", {sim::Method::kRelaxation}, "remove it, or give world.gravity"},
}};

sim::Method read_method(const TableReader& solver) {
    const auto value = solver.find("method");
    if (!value) return sim::SolverDef{}.method;
    const auto names = sim::method_names();
    return *sim::parse_method(names[value->choice(names)]);
}

void refuse_foreign_keys(const TableReader& solver, sim::Method method) {
    for (const MethodKey& key : method_keys) {
        const auto value = solver.find(key.key);
        if (!value || std::find(key.methods.begin(), key.methods.end(), method) != key.methods.end())
            continue;
        std::vector<std::string_view> users;
        for (const sim::Method user : key.methods) users.push_back(sim::method_name(user));
        value->fail(fmt::format("method \"{}\" does not use it, only {}; {}", sim::method_name(method),
                                joined(users), key.remedy));
    }
}

void read_order(const TableReader& solver, int& order) {
    constexpr std::string_view kRemedy = "give an order of 2, 4, 6 or 8";
    const auto value = solver.find("order");
    if (!value) return;
    order = static_cast<int>(value->integer(2, 8, kRemedy));
    if (order % 2 != 0) value->fail(fmt::format("{} is not even; {}", order, kRemedy));
}

}  // namespace

sim::SolverDef read_solver(const TableReader& solver) {
    constexpr int kMostSweeps = 1'000'000;
    sim::SolverDef def;
    def.method = read_method(solver);
    solver.read_number("tolerance_px", def.tolerance_px, kPositive, "give a tolerance in pixels");
    solver.read_number("tolerance", def.tolerance, {.low = 1e-15, .high = 1.0},
                       "give a tolerance relative to the rope's length");
    read_order(solver, def.order);
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
    if (def.method != sim::Method::kRelaxation) def.reach = 1;  // links alone
    return def;
}

}  // namespace corda::scene
