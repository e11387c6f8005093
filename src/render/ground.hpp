#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/view/defs.hpp"

namespace corda::render {

/// Writes row `y` of a ground, `width` pixels of RGBA, colours times alpha, in a frame of `height` rows. In
/// integers: where a colour goes from one level to the next, a fixed pattern of 8 x 8 pixels mixes both.
void write_ground_row(const Ground& ground, int y, int width, int height, std::uint8_t* rgba);

/// All rows of a ground.
class GroundRows {
  public:
    /// A row's pixels repeat after so many.
    static constexpr int kPeriodPx = 8;
    using Row = std::array<std::uint8_t, 4 * kPeriodPx>;

    GroundRows(const Ground& ground, int height);

    [[nodiscard]] const Ground& ground() const { return ground_; }
    /// The pixels from the left edge on, or from any multiple of their period.
    [[nodiscard]] const Row& row(int y) const { return rows_[static_cast<std::size_t>(y)]; }
    /// Writes a part of a picture of the ground.
    void write(const PixelRect& part, Image& image) const;

  private:
    Ground ground_;
    std::vector<Row> rows_;
};

/// The colours of a ground for a program that mixes them without regard to their alpha, where one that cannot
/// be seen must not show.
[[nodiscard]] Ground straight_ends(const Ground& ground);

}  // namespace corda::render
