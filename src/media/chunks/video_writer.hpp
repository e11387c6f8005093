#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/media/chunks/chunk.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/encode/encoder.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

/// A video output that check_video_output() has accepted.
struct CheckedVideo {
    /// Value of `end` if the number of frames is unknown.
    static constexpr std::int64_t kNoEnd = std::int64_t{1} << 62U;

    std::string path;
    VideoDef def;
    Format format;
    std::int64_t first = 0;  ///< number of the first frame in the film
    std::int64_t end = kNoEnd;
    bool force = false;   ///< replace an existing video at the end, and the part of an interrupted render now
    bool resume = false;  ///< continue the part of an interrupted render of the same video, if there is one
};

/// Checks a video of frames first <= k < end before any work is done: everything that check_video_def,
/// find_format and corda::check_output check, whether a hardware encoder opens, and, without `force` and
/// `resume`, that there is no interrupted render of the same name. Throws corda::Error (kUsage, kIo,
/// kEncoder).
CheckedVideo check_video_output(const std::string& path, const VideoDef& def, const std::string& input,
                                bool force, bool is_transparent = false, std::int64_t first = 0,
                                std::int64_t end = CheckedVideo::kNoEnd, bool resume = false);

/// Metadata of a video file.
struct VideoMetadata {
    std::string title{};
    /// Compact JSON that `verify` reads back; VideoWriter adds "frames", "fps", "crf" and "patches" to it
    /// (see verify.hpp). What it tells under kOriginKey (see video_comment.hpp) stays in the part.
    std::string comment_json = "{}";
    bool is_transparent = false;  ///< `is_transparent` of check_video_output(), where the writer calls it
    PictureInfo picture_info{};   ///< of formats of a file for each frame
};

/// Writes a video of one constant rational frame rate, in the format that the ending of its name tells.
///
/// While it runs, whole chunks go to `PATH.part`, which plays at any moment. `finish` ends the last chunk,
/// copies the stream into a file of temporary name (of an animation, encodes it from the exact pictures of
/// the part), verifies that, and only then gives it the final name. Whatever has the final name is complete
/// and verified. Pictures and standard output have no part: each frame is complete as it is.
class VideoWriter {
  public:
    /// Opens the part file, for the frames of `output` or fewer. If it resumes a part, frames() returns the
    /// number of frames in it, and the video will have the bytes of an uninterrupted render. Throws
    /// corda::Error: kIo if the file cannot be created or another render is writing it, kMismatch for a part
    /// that cannot be read. An encoder that does not open fails with the first frame.
    VideoWriter(const CheckedVideo& output, VideoMetadata metadata);
    /// Checks the output first, and throws as check_video_output() too.
    VideoWriter(const std::string& path, const VideoDef& def, const VideoMetadata& metadata,
                const OutputOptions& options = {});
    VideoWriter(VideoWriter&&) noexcept;
    VideoWriter(const VideoWriter&) = delete;
    VideoWriter& operator=(const VideoWriter&) = delete;
    /// Without `finish` or `abandon` the part file stays as it is, unless it is empty.
    ~VideoWriter();

    /// Adds the next frame, of the size of `def`. `damage` is what may differ from the previous frame (the
    /// first is taken whole). With `is_last`, the frame's colours are verified too, as the first frame's are.
    /// Throws kEncoder or kIo; ReaderLeft (see output_file.hpp) if the reader of standard output closed it.
    /// After a failure only abandon() is of use.
    void write(const Image& frame, const Damage& damage, bool is_last = false);

    /// Adds a chunk that was encoded elsewhere, and flushes it to disk. All of the frames so far are in
    /// chunks then, each of which ends where frames_per_chunk() says. Throws kIo, and kInternal if it is no
    /// part of this video.
    void append(Chunk chunk);

    /// The format of the file.
    [[nodiscard]] const Format& format() const;

    /// How many frames a whole chunk has.
    [[nodiscard]] std::int64_t frames_per_chunk() const;

    /// An encoder of a chunk for append(), from frame `frame` of the film on. May be called by any thread.
    [[nodiscard]] ChunkEncoder chunk_encoder(std::int64_t frame) const;

    /// Whether the part that was resumed was damaged after its whole chunks.
    [[nodiscard]] bool was_part_damaged() const;

    /// Frames written so far.
    [[nodiscard]] std::int64_t frames() const;

    /// Ends the last chunk, copies, verifies, and gives the video its name. Of codecs that take much longer
    /// to encode than to decode (AV1, VP9, H.265) all frames are verified in any case. Needs at least one
    /// frame. Throws kEncoder, kIo, kMismatch (the check found a problem), or kInterrupted if cancelled;
    /// then the frames stay in `PATH.part`. `on_progress`: see FinishDef.
    void finish(VerifyDepth depth = VerifyDepth::kKeyFrames, const OnProgress& on_progress = {});

    /// Drains and ends the part file unless `finish` has, so that it stays as a playable `PATH.part`, and
    /// returns its path. Without any frame the part is removed, and the path is empty. Cannot be
    /// cancelled; a chunk whose encoder takes longer than kMomentS to end is dropped.
    std::string abandon();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace corda::media
