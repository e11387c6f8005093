#include <fmt/format.h>

#include "corda/scene/field.hpp"
#include "corda/scene/readers.hpp"
#include "corda/sim/solver.hpp"

namespace corda::scene {
namespace {

/// An empty definition of a method.
SolverDef solver_named(std::string_view method) {
    SolverDef solver;
    for_each_solver([&](const auto& def) {
        if (method == def.kName) solver = def;
    });
    return solver;
}

SolverGroup read_group(const TableReader& table) {
    SolverTable keys;
    read_fields(table, keys);
    SolverDef def = solver_named(keys.method);
    std::visit([&](auto& method) { read_fields(table, method); }, def);
    if (!std::holds_alternative<RelaxationDef>(def)) return {table, def, 1};
    return {table, def, keys.reach.empty() ? kDefaultReach : keys.reach.front()};
}

/// Puts the bodies of one list of a table of [[solver.bodies]] into the last group. The list is of `count`
/// bodies, the first of which is body `first` of the scene.
std::vector<std::uint32_t> read_members(const TableReader& table, std::string_view key, std::size_t count,
                                        std::size_t first, SolverSection& section) {
    std::vector<std::uint32_t> members;
    const auto list = table.find(key);
    for (std::size_t i = 0; list && i < list->size(); ++i) {
        if (count == 0) {
            list->add_problem(fmt::format("the scene has no {}", key), "remove it");
            break;
        }
        const Value entry = list->at(i);
        const auto index =
            read_index(entry, static_cast<std::int64_t>(count), fmt::format("the scene has {}", key));
        if (!index) continue;
        std::size_t& group = section.group_of_body[first + *index];
        if (group != 0)
            entry.add_problem(fmt::format("{} is named already, by solver.bodies[{}]", *index, group - 1),
                              "remove one");
        group = section.groups.size() - 1;
        members.push_back(*index);
    }
    return members;
}

BodySolverDef read_body_solver(const TableReader& table, const Sections& sections, SolverSection& section) {
    section.groups.push_back(read_group(table));
    const auto is_empty = [&](std::string_view key) {
        const auto list = table.find(key);
        return table.is_sound(key) && (!list || list->size() == 0);
    };
    if (is_empty("ropes") && is_empty("nets"))
        table.add_problem("names no body", "give ropes or nets, the indices of [[rope]] or [[net]] tables");
    const std::size_t ropes = sections.ropes.size();
    const std::size_t nets = sections.nets.size();
    // A list with problems of its own may have lost some of its tables.
    const Problems& problems = table.problems();
    BodySolverDef def;
    if (problems.is_sound("rope")) def.ropes = read_members(table, "ropes", ropes, 0, section);
    if (problems.is_sound("net")) def.nets = read_members(table, "nets", nets, ropes, section);
    // `auto` stands for a missing method, which is already a problem.
    def.method = method_in(section.groups.back().def).value_or(MethodDef{});
    return def;
}

}  // namespace

SolverSection read_solver(const Sections& sections, Scene& scene) {
    SolverSection section{{read_group(sections.solver)},
                          std::vector<std::size_t>(sections.ropes.size() + sections.nets.size())};
    scene.solver = section.groups.front().def;
    for (const TableReader& table : sections.solver.tables("bodies"))
        scene.body_solvers.push_back(read_body_solver(table, sections, section));
    return section;
}

void check_tensions(const Sections& sections, const SolverSection& solver, Scene& scene) {
    struct Shown {
        bool tensions;
        const char* key;
        const char* others;
    };
    for (const auto& [tensions, key, others] :
         {Shown{scene.style.color_by == ColorBy::kTension, "color_by", "\"speed\" or \"strain\""},
          Shown{scene.style.arrows == Arrows::kTension, "arrows", "\"velocity\" or \"weight\""}}) {
        if (!tensions) continue;
        const Value shown = *sections.style.find(key);
        scene.tensions_place = shown.place();
        for (const SolverGroup& group : solver.groups) {
            const std::optional<MethodDef> method = method_in(group.def);
            if (!method || sim::knows_tensions(*method)) continue;
            shown.add_problem(fmt::format("method \"{}\" knows no tensions", method_name(*method)),
                              fmt::format("give {}, or another solver.method", others));
            break;
        }
    }
}

}  // namespace corda::scene
