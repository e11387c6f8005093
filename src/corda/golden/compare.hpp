#pragma once

#include <optional>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"

#pragma GCC visibility push(default)
namespace corda {

/// How far two pictures may differ. If no limit is given they must be equal; otherwise only the given limits
/// count.
struct DifferenceLimits {
    std::optional<double> max;    ///< largest difference of a channel, 0 .. 255
    std::optional<double> mean;   ///< mean difference over all channels and pixels, 0 .. 255
    std::optional<double> share;  ///< share of the pixels that differ at all, 0 .. 1
};

/// How far two pictures differ.
struct Difference {
    bool same_size = true;  ///< if false, the figures below are meaningless
    bool equal = true;      ///< all samples are the same
    double max = 0.0;       ///< largest difference of a channel (R, G, B and A), 0 .. 255
    double mean = 0.0;      ///< mean difference over all channels and pixels, 0 .. 255
    double share = 0.0;     ///< share of the compared pixels that differ in any channel

    /// Whether the difference is within `limits`.
    [[nodiscard]] bool within(const DifferenceLimits& limits) const;
};

/// "max 3, mean 0.1, share 0.02".
[[nodiscard]] std::string figures_text(const Difference& difference);

/// Compares all channels of all pixels of two pictures; with a `mask` of their size, of those that are not
/// black in it. Throws corda::Error: kUsage for a mask of another size or without a pixel to compare,
/// kInterrupted if cancelled.
[[nodiscard]] Difference compare(const Image& a, const Image& b, const Image* mask = nullptr);

/// As above, at 16 bits if one of them has as many. A difference of 1 in 65535 is then one of 1/257.
[[nodiscard]] Difference compare(const Picture& a, const Picture& b, const Image* mask = nullptr);

/// A picture of where two pictures differ. Equal pixels are a dim grey copy of `a`, and so are those that the
/// mask leaves out. Others go from red to yellow with the size of the difference; even the smallest, at 16
/// bits, too, is bright enough to be seen. What only one of them has is blue. Throws as compare().
[[nodiscard]] Image difference_image(const Picture& a, const Picture& b, const Image* mask = nullptr);
[[nodiscard]] Image difference_image(const Image& a, const Image& b, const Image* mask = nullptr);

}  // namespace corda
#pragma GCC visibility pop
