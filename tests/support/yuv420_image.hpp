#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "corda/media/encode/yuv420.hpp"

namespace corda::test {

/// A picture in planar Y'CbCr 4:2:0. Sides are even.
class Yuv420Image {
  public:
    Yuv420Image() = default;
    Yuv420Image(int width, int height) : width_(width), height_(height) {
        for (int index = 0; index < 3; ++index)
            planes_[index].resize(static_cast<std::size_t>(plane_width(index)) *
                                  static_cast<std::size_t>(plane_height(index)));
    }

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    /// Plane 0 is Y' (width x height bytes); 1 and 2 are Cb and Cr (half of each side). No padding.
    [[nodiscard]] const std::uint8_t* plane(int index) const { return planes_[index].data(); }
    [[nodiscard]] std::uint8_t* plane(int index) { return planes_[index].data(); }
    [[nodiscard]] int plane_width(int index) const { return index == 0 ? width_ : width_ / 2; }
    [[nodiscard]] int plane_height(int index) const { return index == 0 ? height_ : height_ / 2; }

    friend bool operator==(const Yuv420Image&, const Yuv420Image&) = default;

  private:
    int width_ = 0;
    int height_ = 0;
    std::array<std::vector<std::uint8_t>, 3> planes_;
};

/// As media::convert_to_yuv420; both pictures have the same size.
inline void convert_to_yuv420(const Image& rgb, const PixelRect& damage, Yuv420Image& yuv) {
    media::convert_to_yuv420(rgb, damage,
                             {{yuv.plane(0), yuv.plane(1), yuv.plane(2)},
                              {yuv.plane_width(0), yuv.plane_width(1), yuv.plane_width(2)}});
}

}  // namespace corda::test
