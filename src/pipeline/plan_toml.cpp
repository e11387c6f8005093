#include "corda/pipeline/plan_toml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "corda/pipeline/describe.hpp"
#include "corda/pipeline/film.hpp"

namespace corda {
namespace {

struct SolverLines {
    std::string operator()(const ExactDef& def) const {
        return fmt::format("method = \"exact\"\ntolerance = {}\n", def.tolerance);
    }
    std::string operator()(const RattleDef& def) const {
        return fmt::format("method = \"rattle\"\norder = {}\nstep = {}\n", def.order, def.step_s.value());
    }
    std::string operator()(const RelaxationDef& def) const {
        std::string lines = fmt::format("method = \"relaxation\"\nstep = {}\nsweeps = {}\ndelta = {}\n",
                                        def.step_s.value(), def.sweeps, def.delta);
        if (def.force_n) lines += fmt::format("force = [{}, {}]\n", def.force_n->x, def.force_n->y);
        return lines;
    }
};

/// The longest reach of the bars of these ropes: that of all that are long enough for it. A table has but
/// one.
std::uint32_t reach_of(const System& system, const std::vector<std::size_t>& bodies) {
    std::uint32_t longest = 1;
    for (const std::size_t i : bodies) {
        const Body& body = system.bodies[i];
        for (std::size_t k = body.first_bar; !body.is_net && k < body.first_bar + body.bar_count; ++k)
            longest = std::max(longest, system.bars[k].reach);
    }
    for (const std::size_t i : bodies) {
        const Body& body = system.bodies[i];
        const bool closed = body.link_count == body.particle_count;
        if (!body.is_net && body.bar_count != bar_count(body.particle_count, longest, closed)) {
            throw Error(ExitCode::kUsage,
                        "the ropes differ in reach, which a scene file cannot say; give all of them one");
        }
    }
    return longest;
}

std::string lines_of(const System& system, const MethodGroup& group) {
    std::string lines = solver_toml(group.method);
    if (std::holds_alternative<RelaxationDef>(group.method))
        lines += fmt::format("reach = {}\n", reach_of(system, group.bodies));
    return lines;
}

std::string bodies_toml(const System& system, const MethodGroup& group) {
    const std::size_t first_net = rope_count(system);
    std::vector<std::size_t> ropes;
    std::vector<std::size_t> nets;
    for (const std::size_t i : group.bodies) {
        if (i < first_net)
            ropes.push_back(i);
        else
            nets.push_back(i - first_net);
    }
    std::string toml = "\n[[solver.bodies]]\n";
    if (!ropes.empty()) toml += fmt::format("ropes = [{}]\n", fmt::join(ropes, ", "));
    if (!nets.empty()) toml += fmt::format("nets = [{}]\n", fmt::join(nets, ", "));
    return toml + lines_of(system, group);
}

}  // namespace

std::string solver_toml(const MethodDef& method) {
    return std::visit(SolverLines{}, method);
}

std::string frozen_toml(const Film& film) {
    const CameraDef& camera = film.camera();
    std::vector<MethodGroup> groups = groups_of(film.plan());
    // The table [solver] is for the largest group.
    std::stable_sort(groups.begin(), groups.end(), [](const MethodGroup& a, const MethodGroup& b) {
        return a.bodies.size() > b.bodies.size();
    });
    std::string toml = "[solver]\n" + lines_of(film.system(), groups.front());
    for (std::size_t i = 1; i < groups.size(); ++i) toml += bodies_toml(film.system(), groups[i]);
    return toml + fmt::format("\n[camera]\ncenter = [{}, {}]\nheight = {}\n", camera.center_m->x,
                              camera.center_m->y, *camera.height_m);
}

}  // namespace corda
