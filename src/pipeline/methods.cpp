#include "corda/pipeline/methods.hpp"

#include <optional>
#include <type_traits>
#include <variant>

namespace corda::pipeline {

sim::NamedMethods named_methods(const Scene& scene) {
    sim::NamedMethods named;
    for (const SolverDef& solver : solvers_of(scene)) {
        named.push_back(std::visit(
            [](const auto& def) -> std::optional<MethodDef> {
                if constexpr (std::is_same_v<std::decay_t<decltype(def)>, AutoDef>)
                    return std::nullopt;
                else
                    return def;
            },
            solver));
    }
    return named;
}

std::vector<MethodDef> if_all_named(const sim::NamedMethods& named) {
    std::vector<MethodDef> methods;
    for (const auto& method : named) {
        if (!method) return {};
        methods.push_back(*method);
    }
    return methods;
}

}  // namespace corda::pipeline
