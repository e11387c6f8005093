#pragma once

#include <array>

#include "corda/sim/spread.hpp"
#include "corda/view/defs.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {

/// How colours tell a quantity, in all pictures of a film: evenly from `low` to `high`.
struct ColorScale {
    Quantity quantity = Quantity::kTension;
    double low = 0.0;
    double high = 1.0;
    bool is_cut = false;            ///< few values lie beyond the ends
    std::array<Color, 9> colors{};  ///< between which others are mixed
    Color unknown;                  ///< of a value that is not a number

    [[nodiscard]] Color color(double value) const;
};

/// From 0, or, if there are values well below 0, from -high to high through grey: `high` is a round number
/// that at most one value in 50 exceeds, if that makes it less than half of the largest.
[[nodiscard]] ColorScale scale_of(Quantity quantity, const sim::Spread& spread, const StyleDef& style);

}  // namespace corda::view
