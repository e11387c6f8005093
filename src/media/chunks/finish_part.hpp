#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/part_file.hpp"
#include "corda/media/verify/verify.hpp"

namespace corda::media {

/// Result of finishing a part file.
struct RemuxResult {
    std::int64_t frames = 0;  ///< frames in the finished video
    bool truncated = false;   ///< the part breaks off in a chunk, or is damaged: the rest was left out
    bool damaged = false;     ///< it has changed since it was written
    bool removed = false;     ///< the part is gone
};

/// Turns the part file of a run that has ended (see VideoWriter) into the finished video `path`: copies its
/// chunks up to the first one that is not whole or whose checksum is wrong, without encoding them again, into
/// a file with its index in front, or makes an animation of its pictures, verifies that, gives it its name,
/// and removes the part, unless that is damaged or `keep_part` is set. Throws corda::Error, and leaves the
/// part as it is: kIo if a file cannot be read or written, or if `path` exists and is not to be replaced;
/// kUsage if the ending of `path` is not that of what the part holds; kMismatch if the part holds no whole
/// chunk, has no constant frame rate, or gives a video that fails its check; kInterrupted if cancelled.
RemuxResult recover_part(const std::string& part_path, const std::string& path,
                         const OutputOptions& options = {}, bool keep_part = false);

/// How a part becomes the finished video.
struct FinishDef {
    std::optional<std::int64_t> frames;  ///< how many it is to have; empty: as many as are there
    VerifyDepth depth = VerifyDepth::kAllFrames;
    std::vector<FrameColors> rendered;  ///< as verify() takes them
    int jobs = 0;                       ///< threads that encode an animation; 0: one per core
    bool keep_part = false;
    bool is_untrusted = false;  ///< its origin is unknown: it is read and decoded in a child process first
    /// Called while the part is read and the video verified, with all frames done; of an animation, with as
    /// many as passes() says, and with those that are encoded.
    OnProgress on_progress = {};
};

/// As recover_part, for a part that this process holds. Also throws kMismatch if it has another number of
/// frames than it is to have.
RemuxResult finish_part(PartFile& part, const std::string& path, const OutputOptions& options,
                        const FinishDef& def);

}  // namespace corda::media
