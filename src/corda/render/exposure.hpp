#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "corda/core/image.hpp"
#include "corda/view/defs.hpp"

namespace corda::render {

/// Averages images in linear light, like a film exposed to each for the same time. Integer arithmetic with
/// tables: the mean of equal images is that image. In images with transparency, averages alpha and light
/// times alpha.
class Exposure {
  public:
    Exposure(int width, int height);

    /// Discards the images added since the last mean.
    void clear();
    /// Adds a premultiplied image that shows the ground outside of the tiles `touched` (Tiles::touched()).
    void add(const Image& picture, const std::vector<std::uint8_t>& touched, const Ground& ground);
    /// Writes the mean to the tiles that any of the images touches, which touched() returns from now on, and
    /// starts a new mean.
    void develop(const Ground& ground, Image& mean);
    [[nodiscard]] const std::vector<std::uint8_t>& touched() const { return touched_; }

  private:
    int width_;
    int height_;
    std::uint32_t pictures_ = 0;         ///< images added since the last mean
    std::vector<std::uint8_t> touched_;  ///< per tile
    /// A tile that has been touched, and the number of images that touch it.
    struct Sum {
        std::size_t tile;
        std::uint32_t pictures;
    };
    std::vector<Sum> tiles_;
    std::vector<std::size_t> sum_of_;  ///< per tile: 1 + its index in tiles_; 0: none
    std::vector<std::uint32_t> sums_;  ///< per entry of tiles_ and pixel: red, green, blue, alpha
};

}  // namespace corda::render
