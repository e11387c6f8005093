#pragma once

#include <span>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::view {

/// Where a particle was.
struct TrailPoint {
    double age_s = 0.0;
    Vec2 at_m;  ///< relative to the system's origin
};

/// The path of a particle in order of time, up to its place in the picture.
using Trail = std::vector<TrailPoint>;

/// The same in pixels, with what is left of each point: 1 now, 0 at the end of the trail.
struct FadingPoint {
    PixelPoint at;
    double left = 0.0;
};

/// The free ends of open ropes, one each: the last particle before the first.
[[nodiscard]] std::vector<std::size_t> free_ends(const System& system);

/// Adds a smooth curve through the points of a path, of which no two have the same age. It fades in alpha and
/// width: it is layers each of which holds what is younger than the last: so they add up without a seam where
/// pieces meet or cross. `radius_px` is that of its young end.
void add_trail(std::span<const FadingPoint> points, double radius_px, Color color, DrawList& list);

}  // namespace corda::view
