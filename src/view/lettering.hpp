#pragma once

namespace corda::view {

// Sizes of texts in a frame: those of what follows as shares of the em.
inline constexpr double kAscent = 0.76;   ///< of DejaVu's capitals
inline constexpr double kDescent = 0.24;  ///< below the baseline
inline constexpr double kLine = 1.5;      ///< from a baseline to the next
inline constexpr double kGap = 0.4;       ///< between a text and what else is drawn

[[nodiscard]] int rounded(double px);
/// The em in a frame whose shorter side is `side_px`.
[[nodiscard]] int em_of(int side_px);
/// From the edges of that frame to its texts, of that em.
[[nodiscard]] int edge_of(int side_px, int em_px);

}  // namespace corda::view
