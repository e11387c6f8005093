#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/view/defs.hpp"

namespace corda::render {

/// Several pictures as one: their mean in linear light, what a film shows that was exposed to all of them for
/// the same time. In integers, through tables; pictures that are equal give that picture.
///
/// Of a see-through picture the mean is of alpha, and of light times alpha.
class Exposure {
  public:
    Exposure(int width, int height);

    /// Forgets the pictures that were added since the last mean.
    void clear();
    /// Adds a picture, colours times alpha, that is the ground but in some tiles: Tiles::touched().
    void add(const Image& picture, const std::vector<std::uint8_t>& touched, const Ground& ground);
    /// Writes the mean to the tiles that one of the pictures touches, and begins anew. Those are touched()
    /// now.
    void develop(const Ground& ground, Image& mean);
    [[nodiscard]] const std::vector<std::uint8_t>& touched() const { return touched_; }

  private:
    int width_;
    int height_;
    std::uint32_t pictures_ = 0;         ///< added since the last mean
    std::vector<std::uint8_t> touched_;  ///< per tile
    /// Of each tile that has been touched: where its sums are, and of how many pictures.
    struct Sum {
        std::size_t tile;
        std::uint32_t pictures;
    };
    std::vector<Sum> tiles_;
    std::vector<std::size_t> sum_of_;  ///< per tile: 1 + its place in tiles_; 0: none
    std::vector<std::uint32_t> sums_;  ///< per place in tiles_ and pixel: red, green, blue, alpha
};

}  // namespace corda::render
