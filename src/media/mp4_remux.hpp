#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace corda::media {

/// What became of a part file.
struct RemuxResult {
    std::int64_t frames = 0;  ///< frames in the new file
    bool truncated = false;   ///< the part ended in the middle of a fragment, which was left out
};

/// Copies the whole fragments of the part file `part_path` (see VideoWriter) into a plain faststart MP4 at
/// `out_path`, with time stamps made anew from frame numbers and the frame count in the comment. Nothing is
/// encoded again. The part stays. Throws corda::Error: kIo where a file cannot be read or written, kMismatch
/// where the part holds no whole fragment or no constant frame rate.
RemuxResult remux_part(const std::string& part_path, const std::string& out_path);

/// Makes a part file the finished video `path`: remux_part into `path`.tmp, verify, sync, rename, remove the
/// part. Throws as remux_part, and kMismatch where verify finds a problem; then the part stays and nothing
/// stands under `path` that did not before. With `expected_frames`, another number of frames is a kMismatch
/// too.
RemuxResult recover_part(const std::string& part_path, const std::string& path,
                         std::optional<std::int64_t> expected_frames = std::nullopt);

}  // namespace corda::media
