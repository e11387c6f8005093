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
    std::optional<double> max;        ///< largest difference of a channel, 0 .. 255
    std::optional<double> mean;       ///< mean difference over all channels and pixels, 0 .. 255
    std::optional<double> share;      ///< share of the pixels that differ at all, 0 .. 1
    std::optional<double> flip = {};  ///< mean FLIP, 0 .. 1, see flip()
    std::optional<double> ssim = {};  ///< least structural similarity, -1 .. 1, see ssim()
};

/// How far two pictures differ.
struct Difference {
    bool same_size = true;  ///< if false, the figures below are meaningless
    bool equal = true;      ///< all bytes are the same
    int max = 0;            ///< largest difference of a channel (R, G, B and A)
    double mean = 0.0;      ///< mean difference over all channels and pixels
    double share = 0.0;     ///< share of the compared pixels that differ in any channel
    // Not always computed.
    std::optional<double> flip = {};  ///< see flip(); of all pixels, those that a mask leaves out are equal
    std::optional<double> ssim = {};  ///< see ssim(), as above; never of pictures that are too small

    /// Whether the difference is within `limits`.
    [[nodiscard]] bool within(const DifferenceLimits& limits) const;
};

/// "max 3, mean 0.1, share 0.02", and FLIP and SSIM if they were computed.
[[nodiscard]] std::string figures_text(const Difference& difference);

/// Compares all channels of all pixels of two pictures; with a `mask` of their size, of those that are not
/// black in it. Throws corda::Error: kUsage for a mask of another size or without a pixel to compare,
/// kInterrupted if `on_progress`, called with the rows, asks to stop.
[[nodiscard]] Difference compare(const Image& a, const Image& b, const OnProgress& on_progress = {},
                                 const Image* mask = nullptr);

/// Which figures that take long compare_perceived() computes.
struct PerceivedFigures {
    bool flip = false;
    bool ssim = false;
    int threads = 1;  ///< for FLIP
};

/// As compare(), with more figures. Throws kUsage, too, for an ssim() of pictures that are too small and
/// differ.
[[nodiscard]] Difference compare_perceived(const Image& a, const Image& b, const PerceivedFigures& figures,
                                           const OnProgress& on_progress = {}, const Image* mask = nullptr);

/// A picture of where two pictures differ. Equal pixels are a dim grey copy of `a`, and so are those that the
/// mask leaves out. Others go from red to yellow with the size of the difference; even the smallest is bright
/// enough to be seen. What only one of them has is blue. Throws as compare.
[[nodiscard]] Image difference_image(const Image& a, const Image& b, const OnProgress& on_progress = {},
                                     const Image* mask = nullptr);

}  // namespace corda
#pragma GCC visibility pop
