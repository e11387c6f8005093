#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#pragma GCC visibility push(default)
namespace corda {

inline constexpr double kMmPerInch = 25.4;

/// An sRGB colour with straight alpha, 0..255 per channel.
struct Color {
    std::uint8_t r = 0;
    std::uint8_t g = 0;
    std::uint8_t b = 0;
    std::uint8_t a = 255;

    /// Reads "#rgb", "#rgba", "#rrggbb", "#rrggbbaa", one of the 148 names of CSS, such as "red" or
    /// "steelblue", or "transparent"; std::nullopt for any other text.
    static std::optional<Color> parse(std::string_view text);

    /// The names of CSS in alphabetical order.
    static std::vector<std::string_view> names();

    /// "#rrggbb", or "#rrggbbaa" if it is not opaque.
    [[nodiscard]] std::string text() const;

    friend bool operator==(const Color&, const Color&) = default;
};

/// The largest side of a picture that Corda draws or reads, and the most pixels of one.
inline constexpr int kMaxSidePx = 16384;
inline constexpr std::int64_t kMaxPicturePx = std::int64_t{1} << 26;

/// Whether Corda draws and reads pictures of this size.
constexpr bool is_picture_size(std::int64_t width, std::int64_t height) {
    return width >= 1 && height >= 1 && width <= kMaxSidePx && height <= kMaxSidePx &&
           width * height <= kMaxPicturePx;
}

/// A picture size with a name.
struct NamedSize {
    std::string_view name;
    int width_px;
    int height_px;
};
inline constexpr std::array<NamedSize, 4> kNamedSizes{
    {{"4k", 3840, 2160}, {"1080p", 1920, 1080}, {"square", 1080, 1080}, {"portrait", 1080, 1920}}};

/// A half-open rectangle of pixels, x0 <= x < x1 and y0 <= y < y1, row 0 on top.
struct PixelRect {
    int x0 = 0;
    int y0 = 0;
    int x1 = 0;
    int y1 = 0;

    [[nodiscard]] bool empty() const { return x1 <= x0 || y1 <= y0; }
    [[nodiscard]] int width() const { return x1 - x0; }
    [[nodiscard]] int height() const { return y1 - y0; }

    /// The smallest rectangle that holds both; an empty one is ignored.
    [[nodiscard]] PixelRect united(const PixelRect& other) const {
        if (empty()) return other;
        if (other.empty()) return *this;
        return {std::min(x0, other.x0), std::min(y0, other.y0), std::max(x1, other.x1),
                std::max(y1, other.y1)};
    }

    [[nodiscard]] PixelRect intersected(const PixelRect& other) const {
        return {std::max(x0, other.x0), std::max(y0, other.y0), std::min(x1, other.x1),
                std::min(y1, other.y1)};
    }

    friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

/// The parts of a picture that may differ from the last one. They may overlap.
using Damage = std::vector<PixelRect>;

/// A picture of RGBA pixels (sRGB, straight alpha), row by row, row 0 on top, no padding.
template <class Sample>
class BasicImage {
  public:
    BasicImage() = default;
    BasicImage(int width, int height)
        : width_(width),
          height_(height),
          rgba_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4) {}

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] PixelRect rect() const { return {0, 0, width_, height_}; }
    [[nodiscard]] std::size_t row_bytes() const {
        return static_cast<std::size_t>(width_) * 4 * sizeof(Sample);
    }

    [[nodiscard]] Sample* data() { return rgba_.data(); }
    [[nodiscard]] const Sample* data() const { return rgba_.data(); }
    [[nodiscard]] std::size_t size_bytes() const { return rgba_.size() * sizeof(Sample); }

    /// The four samples of pixel (x, y).
    [[nodiscard]] Sample* pixel(int x, int y) { return rgba_.data() + offset(x, y); }
    [[nodiscard]] const Sample* pixel(int x, int y) const { return rgba_.data() + offset(x, y); }

    friend bool operator==(const BasicImage&, const BasicImage&) = default;

  private:
    [[nodiscard]] std::size_t offset(int x, int y) const {
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                static_cast<std::size_t>(x)) *
               4;
    }

    int width_ = 0;
    int height_ = 0;
    std::vector<Sample> rgba_;
};

/// 8 bits per channel, as Corda draws.
using Image = BasicImage<std::uint8_t>;
/// 16 bits per channel, as PNG files of others may have.
using DeepImage = BasicImage<std::uint16_t>;

/// A picture of a file.
struct Picture {
    Image image;                         ///< rounded to 8 bits if the file has more
    std::optional<DeepImage> deep = {};  ///< of files that have 16 bits per channel alone
};

}  // namespace corda
#pragma GCC visibility pop
