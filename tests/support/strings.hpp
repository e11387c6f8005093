#pragma once

#include <utility>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"

namespace corda::test {

/// A rope of unit masses whose links pull and never push, with rest lengths `rest_m` (default: their
/// lengths).
inline RopeDef string_of(std::vector<Vec2> points_m, std::vector<double> rest_m) {
    RopeDef rope = reference::rope_through(std::move(points_m));
    rope.rest_m = std::move(rest_m);
    rope.material.is_string = true;
    return rope;
}

}  // namespace corda::test
