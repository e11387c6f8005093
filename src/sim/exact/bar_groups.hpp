#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/sim/system.hpp"

namespace corda::sim {

/// The rigid bars of a body that turn together: opposite sides of parallelograms, which stay parallel, and
/// sides of triangles. A parallelogram whose sides come into line could turn into another quadrilateral from
/// there; its motion stays smooth only if it remains one.
struct BarGroups {
    /// Inverse masses of 0 hold particles.
    BarGroups(const System& system, const std::vector<double>& inverse_mass_1_kg);

    std::size_t count = 0;
    std::vector<std::uint32_t> of_bar;  ///< group of each bar; `count` if it never turns
    std::vector<bool> is_held;          ///< particles that never move
};

}  // namespace corda::sim
