#pragma once

#include <optional>
#include <string>

#include "corda/core/image.hpp"

namespace corda::golden {

/// How far two pictures may be apart. Without any limit they must be equal; with some, only those given
/// count.
struct Limits {
    std::optional<double> max;    ///< largest difference of a channel, 0 .. 255
    std::optional<double> mean;   ///< mean difference over all channels and pixels, 0 .. 255
    std::optional<double> share;  ///< share of the pixels that differ at all, 0 .. 1
};

/// How far two pictures are apart.
struct Comparison {
    bool same_size = true;  ///< where false the figures below mean nothing
    bool equal = true;      ///< every byte is the same
    int max = 0;            ///< largest difference of a channel (R, G, B and A)
    double mean = 0.0;      ///< mean difference over all channels and pixels
    double share = 0.0;     ///< share of the pixels that differ in any channel

    /// Whether this is within `limits`.
    [[nodiscard]] bool within(const Limits& limits) const;
};

[[nodiscard]] Comparison compare(const Image& a, const Image& b);

/// A picture of where two of the same size differ: equal pixels as a dim grey copy of `a`, others in red to
/// yellow by the size of the difference, never dimmer than what a person can see.
[[nodiscard]] Image difference_image(const Image& a, const Image& b);

}  // namespace corda::golden
