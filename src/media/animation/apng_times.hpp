#pragma once

#include <cstdint>
#include <string>

#include "corda/core/rational.hpp"

namespace corda::media {

/// Times of the frames of an APNG; libav rounds them.
struct ApngTimes {
    Rational delay_s{0, 1};       ///< of the first frame
    std::int64_t uneven_at = -1;  ///< index of the first frame that has another; -1: none
};

/// Reads the chunks of an APNG file, up to one that is not whole. Throws corda::Error (kIo) if it cannot be
/// read.
[[nodiscard]] ApngTimes read_apng_times(const std::string& path);

}  // namespace corda::media
