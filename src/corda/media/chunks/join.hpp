#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/media/chunks/chunk.hpp"
#include "corda/media/chunks/chunk_folder.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/verify/verify.hpp"

namespace corda::media {

/// How chunks become the finished video.
struct JoinDef {
    VerifyDepth depth = VerifyDepth::kAllFrames;
    int jobs = 0;  ///< threads that encode an animation; 0: one per core
    /// Called while the chunks are read and the video verified, with all frames done; of an animation, with
    /// as many as passes() says, and with those that are encoded.
    OnProgress on_progress = {};
};

/// Makes the finished video `path` of chunks: copies their packets, without encoding them again, into a file
/// with its index in front, or makes an animation of their pictures, verifies that, and gives it its name.
/// `manifest` gives title and comment. The chunks stay. Throws corda::Error: kIo if a file cannot be read or
/// written, or if `path` exists and is not to be replaced; kUsage if the ending of `path` is not that of what
/// the chunks hold; kMismatch if there is no chunk, or if one of them or the video fails its check;
/// kInterrupted if cancelled.
void join_chunks(const ChunkRun& run, const Manifest& manifest, const std::string& path,
                 const OutputOptions& options, const JoinDef& def);

/// Returns the bytes of the video that join_chunks() makes of such chunks, without verifying them. The format
/// is of a video, not of an animation. Packets must be numbered; they are empty afterwards. A few files are
/// open at a time. Throws corda::Error (kMismatch, kIo, kTemporary, kInterrupted).
[[nodiscard]] std::string join_in_memory(const std::vector<Chunk>& chunks, const Manifest& manifest,
                                         const Format& format);

/// Reads the sound chunks of a folder of any origin in a child process, which libav may end at one. After
/// that this process can read them. Throws corda::Error: kIo, and as work_in_child().
void check_chunks_in_child(const std::string& folder, const Manifest& manifest);

/// Result of recover().
struct Recovered {
    std::int64_t frames = 0;    ///< in the finished video
    std::string gap{};          ///< why it ends before the film does, in words; empty if it does not
    bool is_damaged = false;    ///< a chunk has changed since it was written: the video ends before it
    std::int64_t left_out = 0;  ///< chunk files that are not in the video, with damaged ones
    bool removed = false;       ///< the folder is gone
};

/// Joins the chunks that an interrupted render has left in a folder, up to the first one that is missing or
/// damaged, to the video `path`, in a child process, and removes the folder, unless chunks were left out or
/// `keeps_folder` is set. Throws as ChunkFolder and join_chunks().
Recovered recover(const std::string& folder, const std::string& path, const OutputOptions& options = {},
                  bool keeps_folder = false);

/// "chunk 3 (frames 180..239) is missing": of the gap of a run.
[[nodiscard]] std::string gap_text(const ChunkRun& run, const Manifest& manifest);

/// Joins finished videos that Corda has written, one after the other, to the video `path`, without encoding
/// them again. They are verified first, and decoded in child processes. `comment` is a JSON object to which
/// the rate, the number of frames and the first colours are added. Returns the parts. Throws corda::Error:
/// kUsage if `path` has the ending of another container; kMismatch if one fails its check, or if two differ
/// in anything that a player takes as constant (the message says in what); kIo; kInterrupted if cancelled.
ChunkRun join_videos(const std::vector<std::string>& parts, const std::string& path, const std::string& title,
                     const std::string& comment, const OutputOptions& options);

}  // namespace corda::media
