#pragma once

#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"

namespace corda::media {

/// Pictures whose transparent pixels have the colour of the nearest pixels that show. What is there unseen
/// would darken the edges: 4:2:0 has one colour for four pixels, and a lossy codec spreads a jump over a
/// block.
class AlphaBleed {
  public:
    /// How far colours are spread.
    static constexpr int kReachPx = 4;
    /// Pixels of less alpha get another colour: their own, divided by so small an alpha, is imprecise.
    static constexpr int kMinAlpha = 32;

    /// Takes the part of a picture that differs from the last one, or all of another size; returns what of
    /// picture() that changes.
    PixelRect update(const Image& image, const PixelRect& part);
    [[nodiscard]] const Image& picture() const { return picture_; }

  private:
    struct Found {
        std::uint8_t r = 0, g = 0, b = 0;
        std::uint8_t distance = 0;  ///< in the row, in pixels; kReachPx + 1: there is none
    };
    void search_row(const Image& image, int y, const PixelRect& grown, Found* row) const;

    Image picture_;
    std::vector<Found> rows_;  ///< of the part, in its columns
};

}  // namespace corda::media
