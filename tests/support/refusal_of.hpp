#pragma once

#include <optional>

#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"

namespace corda::test {

/// The reason why a method cannot run a system; std::nullopt if it can.
inline std::optional<Refusal::Reason> refusal_of(const System& system, const MethodDef& method) {
    try {
        static_cast<void>(sim::make_solver(system, WorldDef{}, {&method, 1}, 1.0 / 60.0));
    } catch (const Refusal& refusal) {
        return refusal.reason();
    }
    return std::nullopt;
}

}  // namespace corda::test
