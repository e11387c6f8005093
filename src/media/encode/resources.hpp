#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "corda/media/defs.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

/// Some bytes of memory that a chunk takes while it is drawn and encoded, beside the rest of the program: a
/// measured figure per pixel, which for x264 follows from how many frames its preset looks ahead.
[[nodiscard]] std::uint64_t bytes_per_job(const Format& format, const VideoDef& def);

/// How many jobs that is: as many as were asked for; for 0, one per core.
[[nodiscard]] int jobs_of(int asked);

/// How many of `wanted` jobs, of so many bytes each, fit into the memory that is free.
[[nodiscard]] int jobs_that_fit(int wanted, std::uint64_t bytes);

/// How many bytes of a disk a video takes while it is made: with its part, which the finished file stands
/// beside.
struct DiskNeed {
    std::uint64_t least = 0;  ///< of a drawing of a few lines
    std::uint64_t usual = 0;  ///< of half of the examples; what moves all over takes ten times as much
};

/// The need of so many frames, by measured bytes per pixel; 0 for standard output.
[[nodiscard]] DiskNeed disk_need(const Format& format, const VideoDef& def, std::int64_t frames);

/// How many bytes are free on the disk of an output; std::nullopt if the system does not tell.
[[nodiscard]] std::optional<std::uint64_t> free_disk_bytes(const std::string& path);

/// Refuses a video that cannot fit onto its disk, of which `there` bytes stand already. Throws corda::Error
/// (kIo).
void check_disk_space(const Format& format, const std::string& path, const VideoDef& def, std::int64_t frames,
                      std::uint64_t there);

/// A warning if the usual need is more than what is free; empty otherwise.
[[nodiscard]] std::string disk_warning(const Format& format, const std::string& path, const VideoDef& def,
                                       std::int64_t frames);

}  // namespace corda::media
