#include "corda/view/lettering.hpp"

#include <algorithm>
#include <cmath>

namespace corda::view {

int rounded(double px) {
    return static_cast<int>(std::lround(px));
}

int em_of(int side_px) {
    constexpr double kEm = 1.0 / 40.0;
    constexpr double kSmallEm = 1.0 / 16.0;  // of frames in which kEm is too small to read
    constexpr double kReadablePx = 12.0;
    constexpr double kMinPx = 7.0;
    return rounded(std::max({kEm * side_px, std::min(kReadablePx, kSmallEm * side_px), kMinPx}));
}

int edge_of(int side_px, int em_px) {
    constexpr double kEdge = 0.03;
    constexpr double kEdgePerEm = 0.45;
    return rounded(std::max(kEdge * side_px, kEdgePerEm * em_px));
}

}  // namespace corda::view
