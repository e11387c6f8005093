#pragma once

#include <cstdint>
#include <string>

#include "corda/media/defs.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

/// Bytes of memory that a chunk takes while it is drawn and encoded, in addition to the rest of the program,
/// by the measured bytes per pixel of the codec.
[[nodiscard]] std::uint64_t bytes_per_job(const Format& format, const VideoDef& def);

/// The number of jobs: as asked for; for 0, one per core.
[[nodiscard]] int jobs_of(int asked);

/// The number of jobs, at most `wanted`, that fit into free memory if each takes `bytes`.
[[nodiscard]] int jobs_that_fit(int wanted, std::uint64_t bytes);

/// Bytes of a disk that a video takes while it is made, with its chunks, which exist until the file is
/// finished.
struct DiskNeed {
    std::uint64_t least = 0;  ///< of a drawing of a few lines
    std::uint64_t usual =
        0;  ///< of half of the examples; motion all over the picture takes ten times as much
};

/// The need of `frames` frames, by the measured bytes per pixel of the codec; 0 for standard output.
[[nodiscard]] DiskNeed disk_need(const Format& format, const VideoDef& def, std::int64_t frames);

/// Refuses a video that cannot fit on its disk, of which `there` bytes exist already. Throws corda::Error
/// (kIo).
void check_disk_space(const Format& format, const std::string& path, const VideoDef& def, std::int64_t frames,
                      std::uint64_t there);

/// A warning if the usual need exceeds the free space; empty otherwise.
[[nodiscard]] std::string disk_warning(const Format& format, const std::string& path, const VideoDef& def,
                                       std::int64_t frames);

}  // namespace corda::media
