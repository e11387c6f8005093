#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "corda/pipeline/describe.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/scene/write_scene.hpp"

namespace corda {

Scene frozen_scene(Film& film) {
    Scene scene = film.scene();
    std::vector<MethodGroup> groups = groups_of(film.plan());
    // [solver] is for the largest group.
    std::stable_sort(groups.begin(), groups.end(), [](const MethodGroup& a, const MethodGroup& b) {
        return a.bodies.size() > b.bodies.size();
    });
    scene.solver = solver_of(groups.front().method);
    scene.body_solvers.clear();
    for (std::size_t i = 1; i < groups.size(); ++i) {
        BodySolverDef& own = scene.body_solvers.emplace_back();
        own.method = groups[i].method;
        for (const std::size_t body : groups[i].bodies) {
            const bool is_rope = body < scene.ropes.size();
            (is_rope ? own.ropes : own.nets)
                .push_back(static_cast<std::uint32_t>(is_rope ? body : body - scene.ropes.size()));
        }
    }
    scene.camera = film.camera();
    return scene;
}

std::string frozen_toml(Film& film) {
    constexpr std::array<std::string_view, 3> kSections{"solver", "solver.bodies", "camera"};
    return write_sections(frozen_scene(film), kSections);
}

}  // namespace corda
