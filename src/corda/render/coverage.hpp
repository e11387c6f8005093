#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "corda/core/image.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {

// The arithmetic of a pixel. shaders/capsule.frag and render/paint.cpp repeat these steps: change them
// together. Only single-precision +, - and * with one rounding each, comparisons and integers are allowed:
// IEEE 754 defines these to the last bit, so every driver gives the same result.

/// Distance of the pixel with centre (center_x, center_y) from a capsule's segment, in pixels.
///
/// The distance to a cap needs a square root: three Newton steps for 1 / sqrt from the well-known integer
/// estimate (relative error below 1e-6, far less than 1/255 of a pixel).
[[nodiscard]] inline float segment_distance_px(const view::Capsule& capsule, float center_x, float center_y) {
    const float dx = center_x - capsule.ax;
    const float dy = center_y - capsule.ay;
    const float along = dx * capsule.ux + dy * capsule.uy;
    const float across = dx * capsule.uy - dy * capsule.ux;
    const float past_end = along - capsule.length;
    const float beyond = along < 0.0F ? along : (past_end > 0.0F ? past_end : 0.0F);
    if (beyond == 0.0F) return std::abs(across);
    const float squared = across * across + beyond * beyond;
    const float half_squared = 0.5F * squared;
    float inverse = std::bit_cast<float>(0x5f3759dfU - (std::bit_cast<std::uint32_t>(squared) >> 1U));
    for (int i = 0; i < 3; ++i) inverse = inverse * (1.5F - half_squared * inverse * inverse);
    return squared * inverse;
}

/// Coverage of a pixel by the points within `radius` of a segment, 0 .. 255; 0 for `radius` 0. It is the
/// overlap of the capsule's width with a box filter one pixel wide, which also holds for lines thinner than a
/// pixel. `strength`: that of a pixel that lies within.
[[nodiscard]] inline std::uint32_t coverage_within(float radius, float distance_px, float strength = 255.0F) {
    const float inner = std::min(distance_px + 0.5F, radius);
    const float outer = std::max(distance_px - 0.5F, -radius);
    const float coverage = std::min(std::max(inner - outer, 0.0F), 1.0F);
    // Unlike lround(), this is computed for several pixels at once.
    return static_cast<std::uint32_t>(coverage * strength + 0.5F);  // NOLINT(bugprone-incorrect-roundings)
}

/// v / 255, rounded to the nearest integer, for 0 <= v <= 255 * 255.
[[nodiscard]] inline std::uint32_t over_255(std::uint32_t v) {
    const std::uint32_t t = v + 128;
    return (t + (t >> 8U)) >> 8U;
}

/// Weight of a capsule of a tinted layer in the mean colour of a pixel that it covers by `coverage` / 255: 0
/// without coverage, else 1 .. 256 times its own weight, depending on the share of the pixel that projects
/// onto its segment.
[[nodiscard]] inline std::uint32_t tint_weight(const view::Capsule& capsule, float center_x, float center_y,
                                               std::uint32_t coverage) {
    if (coverage == 0) return 0;
    const float along = (center_x - capsule.ax) * capsule.ux + (center_y - capsule.ay) * capsule.uy;
    const float from = std::max(along - 0.5F, 0.0F);
    const float to = std::min(along + 0.5F, capsule.length);
    const float share = capsule.length == 0.0F ? 1.0F : std::min(std::max(to - from, 0.0F), 1.0F);
    const auto beside =
        static_cast<std::uint32_t>(share * 255.0F + 0.5F);  // NOLINT(bugprone-incorrect-roundings)
    return capsule.tint.weight * (1 + over_255(coverage * beside));
}

/// Sums of weights, and of channels times weights, over the capsules of a tinted layer. They are integers, so
/// that single precision adds them exactly in any order up to 2^24: a pixel fully covered by 257 links.
struct TintSums {
    float r = 0.0F;
    float g = 0.0F;
    float b = 0.0F;
    float weight = 0.0F;

    void add(const view::Tint& tint, std::uint32_t capsule_weight) {
        const auto w = static_cast<float>(capsule_weight);
        r += w * static_cast<float>(tint.r);
        g += w * static_cast<float>(tint.g);
        b += w * static_cast<float>(tint.b);
        weight += w;
    }
    /// The mean of a channel, rounded to the nearest integer.
    [[nodiscard]] std::uint32_t mean(float sum) const {
        constexpr float kLargest = 2147483520.0F;  // the largest float below 2^31
        const auto total = static_cast<std::uint32_t>(std::min(weight, kLargest));
        const auto part = static_cast<std::uint32_t>(std::min(sum, kLargest));
        return std::min((part + total / 2) / std::max(total, 1U), 255U);
    }
};

/// Paints a channel of a layer over `below` where the layer covers `coverage` / 255 of the pixel. Blends in
/// gamma space: premultiplied 8-bit sRGB, and alpha as the fourth channel in the same way. A layer first
/// paints its halo in the colours of the ground, then its capsules.
[[nodiscard]] inline std::uint32_t paint_over(std::uint32_t below, std::uint32_t channel,
                                              std::uint32_t layer_alpha, std::uint32_t coverage) {
    const std::uint32_t alpha = over_255(coverage * layer_alpha);
    return over_255(below * (255 - alpha) + channel * alpha);
}

/// Divides a pixel's colours by its alpha.
inline void straighten(std::uint8_t* rgba) {
    const std::uint32_t alpha = rgba[3];
    if (alpha == 0 || alpha == 255) return;
    for (int c = 0; c < 3; ++c) rgba[c] = static_cast<std::uint8_t>((rgba[c] * 255U + alpha / 2) / alpha);
}

}  // namespace corda::render
