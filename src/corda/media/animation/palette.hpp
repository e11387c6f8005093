#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "corda/core/image.hpp"

namespace corda::media {

/// The colours of a GIF: 255 at most, and the last entry, which is transparent.
class Palette {
  public:
    static constexpr std::size_t kSize = 256;
    static constexpr std::uint8_t kTransparent = 255;

    explicit Palette(std::vector<Color> colors) : colors_(std::move(colors)) {}

    /// Blue, green, red and alpha of an entry; black if it is not used.
    [[nodiscard]] std::array<std::uint8_t, 4> bgra(std::size_t index) const;

    /// The entries of `count` RGBA pixels of a picture from (x, y) on; pixels that are less than half opaque
    /// are transparent. A colour between two entries is a pattern of both, which depends on the place of a
    /// pixel and its colour alone: what stands still has the same entries in all pictures.
    void map(const std::uint8_t* rgba, int count, int x, int y, std::uint8_t* indices);

  private:
    /// A colour as a pattern of two entries.
    struct Mix {
        std::uint8_t first = 0;
        std::uint8_t second = 0;
        std::uint8_t share = 0;  ///< of the second one, in 64 pixels
    };

    [[nodiscard]] std::uint8_t nearest(const std::array<int, 3>& rgb) const;
    [[nodiscard]] Mix mix_of(std::uint32_t rgb) const;

    std::vector<Color> colors_;
    std::unordered_map<std::uint32_t, Mix> known_;
};

/// Pixels of colours that agree in their first bits.
struct PaletteBin {
    std::uint64_t count = 0;
    std::array<std::uint64_t, 3> sums{};
};

/// Chooses the palette of some pixels: their own colours if there are few enough, otherwise the means of
/// boxes in the colour cube, each cut in two at its widest where most different colours are (P. Heckbert:
/// Color image quantization for frame buffer display. SIGGRAPH 1982). A colour counts by the logarithm of its
/// pixels, or a ground would take all entries.
class PaletteMaker {
  public:
    /// Adds `count` pixels of a colour, RGBA; none if they are less than half opaque.
    void add(const std::uint8_t* rgba, std::uint64_t count);
    [[nodiscard]] Palette make() const;

  private:
    static constexpr int kBits = 6;
    static constexpr std::size_t kMaxColors = Palette::kSize - 1;

    [[nodiscard]] std::vector<Color> cut_boxes() const;

    std::unordered_set<std::uint32_t> exact_;  ///< all colours, while there are few
    std::vector<PaletteBin> bins_ = std::vector<PaletteBin>(std::size_t{1} << (3 * kBits));
};

}  // namespace corda::media
