#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>

#include "corda/sim/solver.hpp"

namespace corda::sim {

/// Makes the solver of a part of a body, without events. `bars`: the number of each of its bars among those
/// of the body.
using MakePart = std::function<std::unique_ptr<Solver>(
    const System& part, const Forces& forces, const MethodDef& method, std::span<const std::size_t> bars)>;

/// A solver of a system of one body whose pins are let go or whose bars are cut. At each of these times it
/// stops exactly, and for each part that bars still hold together a solver from `make` takes over the
/// positions and velocities; particles without bars fall by themselves. A part that implicit steps cannot
/// move is moved by explicit ones. A default step is one that suits all phases. Events after the last
/// requested time cost nothing.
///
/// Throws corda::Refusal, as does advance_to(), if a method cannot run a part, with the time of the event.
[[nodiscard]] std::unique_ptr<Solver> solve_in_phases(const System& body, const Forces& forces,
                                                      const MethodDef& method, MakePart make);

}  // namespace corda::sim
