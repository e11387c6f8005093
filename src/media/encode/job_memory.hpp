#pragma once

#include <cstdint>

#include "corda/media/defs.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

/// Some bytes of memory that a chunk takes while it is drawn and encoded, beside the rest of the program: a
/// measured figure per pixel, which for x264 follows from how many frames its preset looks ahead.
[[nodiscard]] std::uint64_t bytes_per_job(const Format& format, const VideoDef& def);

/// Memory of each thread that makes an animation, per pixel: the first thread of a WebP; a further one
/// adds 26.
inline constexpr int kAnimationBytesPerPixel = 50;

/// How many jobs that is: as many as were asked for; for 0, one per core.
[[nodiscard]] int jobs_of(int asked);

/// How many of `wanted` jobs, of so many bytes each, fit into the memory that is free.
[[nodiscard]] int jobs_that_fit(int wanted, std::uint64_t bytes);

}  // namespace corda::media
