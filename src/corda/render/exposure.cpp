#include "corda/render/exposure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "corda/render/coverage.hpp"
#include "corda/render/paint.hpp"
#include "corda/render/tiles.hpp"

namespace corda::render {
namespace {

constexpr int kTilePx = Tiles::kSidePx;
constexpr std::ptrdiff_t kTileRow = std::ptrdiff_t{4} * kTilePx;  // sums
constexpr std::size_t kSumsPerTile = std::size_t{4} * kTilePx * kTilePx;
constexpr std::uint32_t kWhite = 65535;  // in linear light

/// The transfer function of IEC 61966-2-1 and its inverse, with light in 16 bits. No value is so close to a
/// rounding boundary that it depends on the C library.
struct Tables {
    std::array<std::uint16_t, 256> linear{};
    std::vector<std::uint8_t> srgb;  ///< of every linear value

    Tables() : srgb(kWhite + 1) {
        const auto light = [](double level) {
            const double v = level / 255.0;
            return kWhite * (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
        };
        std::size_t next = 0;
        for (int level = 0; level < 256; ++level) {
            linear[level] = static_cast<std::uint16_t>(std::lround(light(level)));
            const double end = level == 255 ? kWhite : light(level + 0.5);
            for (; next <= kWhite && static_cast<double>(next) <= end; ++next)
                srgb[next] = static_cast<std::uint8_t>(level);
        }
    }
};

const Tables& tables() {
    static const Tables made;
    return made;
}

/// Adds a row of premultiplied pixels. Sums are of light, at most 64 * 65535; on a transparent ground, of
/// light times alpha, which fits into 32 bits too.
template <bool kIsOpaque>
void add_row(const std::uint8_t* rgba, int count, std::uint32_t* sums) {
    const auto& linear = tables().linear;
    for (int x = 0; x < count; ++x, rgba += 4, sums += 4) {
        if constexpr (kIsOpaque) {
            for (int c = 0; c < 3; ++c) sums[c] += linear[rgba[c]];
        } else {
            std::array<std::uint8_t, 4> straight{rgba[0], rgba[1], rgba[2], rgba[3]};
            straighten(straight.data());
            for (int c = 0; c < 3; ++c) sums[c] += std::uint32_t{linear[straight[c]]} * straight[3];
            sums[3] += straight[3];
        }
    }
}

/// Writes rows of means. `bare`: 8 pixels of the ground, which `bare_pictures` of the images show here.
class MeanRow {
  public:
    explicit MeanRow(std::uint32_t pictures)
        : pictures_(pictures), reciprocal_(((std::uint64_t{1} << kShift) + pictures - 1) / pictures) {}

    template <bool kIsOpaque>
    void write(const std::array<std::uint8_t, 32>& bare, std::uint32_t bare_pictures, int count,
               std::uint32_t* sums, std::uint8_t* rgba) const {
        std::array<std::uint32_t, 32> rest{};
        add_row<kIsOpaque>(bare.data(), 8, rest.data());
        for (std::uint32_t& sum : rest) sum *= bare_pictures;
        for (int x = 0; x < count; ++x, rgba += 4, sums += 4) {
            std::array<std::uint32_t, 4> sum{};
            for (int c = 0; c < 4; ++c) sum[c] = sums[c] + rest[4 * (x % 8) + c];
            if constexpr (kIsOpaque) {
                for (int c = 0; c < 3; ++c) rgba[c] = level((sum[c] + pictures_ / 2) * reciprocal_ >> kShift);
                rgba[3] = 255;
            } else {
                const std::uint32_t alpha = (sum[3] + pictures_ / 2) / pictures_;
                for (int c = 0; c < 3 && sum[3] > 0; ++c) {
                    const std::uint64_t light = (std::uint64_t{sum[c]} + sum[3] / 2) / sum[3];
                    rgba[c] = static_cast<std::uint8_t>(over_255(level(light) * alpha));
                }
                if (sum[3] == 0) std::fill_n(rgba, 3, std::uint8_t{0});
                rgba[3] = static_cast<std::uint8_t>(alpha);
            }
        }
    }

  private:
    // Multiplication by the reciprocal gives the exact quotient for sums below 2^23.
    static constexpr int kShift = 40;
    static std::uint8_t level(std::uint64_t light) { return tables().srgb[light]; }

    std::uint32_t pictures_;
    std::uint64_t reciprocal_;
};

}  // namespace

Exposure::Exposure(int width, int height)
    : width_(width),
      height_(height),
      touched_(tile_count(width, height)),
      sum_of_(tile_count(width, height)) {}

void Exposure::clear() {
    pictures_ = 0;
    tiles_.clear();
    std::fill(sum_of_.begin(), sum_of_.end(), 0);
}

void Exposure::add(const Image& picture, const std::vector<std::uint8_t>& touched, const Ground& ground) {
    const auto add = ground.is_opaque() ? add_row<true> : add_row<false>;
    ++pictures_;
    for (std::size_t tile = 0; tile < touched.size(); ++tile) {
        if (touched[tile] == 0) continue;
        if (sum_of_[tile] == 0) {
            tiles_.push_back({tile, 0});
            sum_of_[tile] = tiles_.size();
            const std::size_t end = tiles_.size() * kSumsPerTile;
            if (sums_.size() < end) sums_.resize(end);
            std::fill_n(&sums_[end - kSumsPerTile], kSumsPerTile, 0U);
        }
        const std::size_t place = sum_of_[tile] - 1;
        ++tiles_[place].pictures;
        const PixelRect rect = tile_rect(tile, width_, height_);
        std::uint32_t* sums = &sums_[place * kSumsPerTile];
        for (int y = rect.y0; y < rect.y1; ++y, sums += kTileRow)
            add(picture.pixel(rect.x0, y), rect.width(), sums);
    }
}

void Exposure::develop(const Ground& ground, Image& mean) {
    const MeanRow means(pictures_);
    std::fill(touched_.begin(), touched_.end(), std::uint8_t{0});
    for (std::size_t place = 0; place < tiles_.size(); ++place) {
        touched_[tiles_[place].tile] = 1;
        const PixelRect rect = tile_rect(tiles_[place].tile, width_, height_);
        const std::uint32_t bare_pictures = pictures_ - tiles_[place].pictures;
        std::uint32_t* sums = &sums_[place * kSumsPerTile];
        for (int y = rect.y0; y < rect.y1; ++y, sums += kTileRow) {
            std::array<std::uint8_t, 32> bare{};
            write_ground_row(ground, y, 8, height_, bare.data());
            std::uint8_t* row = mean.pixel(rect.x0, y);
            if (ground.is_opaque())
                means.write<true>(bare, bare_pictures, rect.width(), sums, row);
            else
                means.write<false>(bare, bare_pictures, rect.width(), sums, row);
        }
    }
    clear();
}

}  // namespace corda::render
