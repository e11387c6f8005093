#pragma once

#include <cstdint>

#include "corda/media/defs.hpp"
#include "corda/media/format.hpp"

namespace corda::media {

/// Some bytes of memory that a chunk takes while it is drawn and encoded, beside the rest of the program: a
/// measured figure per pixel, which for x264 follows from how many frames its preset looks ahead.
[[nodiscard]] std::uint64_t bytes_per_job(const Format& format, const VideoDef& def);

}  // namespace corda::media
