#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/media/chunks/chunk.hpp"
#include "corda/media/chunks/chunk_folder.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/encode/encoder.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

/// A video output that check_video_output() has accepted.
struct CheckedVideo {
    /// Value of `end` if the number of frames is unknown.
    static constexpr std::int64_t kNoEnd = std::int64_t{1} << 62U;

    std::string path{};
    VideoDef def{};
    Format format{};
    std::int64_t first = 0;  ///< number of the first frame in the film
    std::int64_t end = kNoEnd;
    bool force = false;   ///< replace an existing video at the end, and chunks of an interrupted render now
    bool resume = false;  ///< keep the chunks of an interrupted render of the same video, if there are any
    std::optional<Shard> shard{};  ///< make only the chunks of this shard, and no video

    [[nodiscard]] ChunkFolder::Use use() const;
};

/// Checks a video, whose format it fills in, before any work is done: everything that check_video_def,
/// find_format and corda::check_output check, whether a hardware encoder opens, and whether its folder of
/// chunks can be used as it is to be. Throws corda::Error (kUsage, kIo, kEncoder).
[[nodiscard]] CheckedVideo check_video_output(CheckedVideo video, const std::string& input = "",
                                              bool is_transparent = false);

/// Metadata of a video file.
struct VideoMetadata {
    std::string title{};
    /// Compact JSON that `verify` reads back; VideoWriter adds "frames", "fps", "crf" and "patches" to it
    /// (see verify.hpp).
    std::string comment_json = "{}";
    bool is_transparent = false;  ///< `is_transparent` of check_video_output(), where the writer calls it
    PictureInfo picture_info{};   ///< of formats of a file for each frame
    std::map<std::string, std::string> made_from{};  ///< see Manifest
};

class VideoSink;

/// Writes a video of one constant rational frame rate, in the format that the ending of its name tells.
///
/// While it runs, each whole chunk becomes a file in the folder `PATH.parts`, which plays by itself. `finish`
/// copies the chunks into a file of temporary name (of an animation, encodes it from their exact pictures),
/// verifies that, and only then gives it the final name. Whatever has the final name is complete and
/// verified. Pictures and standard output have no chunk files: each frame is complete as it is.
class VideoWriter : NonCopyable {
  public:
    /// Opens the folder, for the frames of `output` or fewer. Chunks that are there already count as written:
    /// the video will have the bytes of an uninterrupted render. Throws corda::Error: kIo if the folder
    /// cannot be made or another render uses it, kMismatch if its manifest cannot be read, kUsage if it is of
    /// another video. An encoder that does not open fails with the first frame.
    VideoWriter(const CheckedVideo& output, VideoMetadata metadata);
    /// Checks the output first, and throws as check_video_output() too.
    VideoWriter(const std::string& path, const VideoDef& def, const VideoMetadata& metadata,
                const OutputOptions& options = {});
    /// Without `finish` whole chunks stay in the folder.
    ~VideoWriter();

    /// Adds the next frame of a chunk that is lacking, of the size of `def`. `damage` is what may differ from
    /// the previous frame (the first is taken whole). Throws kEncoder or kIo; ReaderLeft (see
    /// output_file.hpp) if the reader of standard output closed it. After a failure only abandon() is of use.
    void write(const Image& frame, const Damage& damage);

    /// Adds a chunk that was encoded elsewhere, and flushes it to disk. Throws kIo.
    void append(Chunk chunk);

    [[nodiscard]] const Format& format() const { return output_.format; }
    [[nodiscard]] const Manifest& manifest() const { return manifest_; }

    /// Numbers of the chunks that are to be made: they are not there, and of this shard. Needs a known end.
    [[nodiscard]] std::vector<std::int64_t> lacking_chunks() const;

    /// Numbers of the chunks that were there and had changed since they were written: they are lacking.
    [[nodiscard]] std::vector<std::int64_t> damaged_chunks() const;

    /// An encoder of a chunk for append(), from frame `frame` of the film on. May be called by any thread.
    [[nodiscard]] ChunkEncoder chunk_encoder(std::int64_t frame) const;

    /// Frames that are there, with those of the chunk that write() has begun; of a shard, its own.
    [[nodiscard]] std::int64_t frames() const;

    /// Ends the last chunk, joins all, verifies, and gives the video its name; a shard does only the first.
    /// Of codecs that take much longer to encode than to decode (AV1, VP9, H.265) all frames are verified in
    /// any case. Needs at least one frame. Throws kEncoder, kIo, kMismatch (the check found a problem), or
    /// kInterrupted if cancelled; then the chunks stay in `PATH.parts`. `on_progress`: see JoinDef.
    void finish(VerifyDepth depth = VerifyDepth::kKeyFrames, const OnProgress& on_progress = {});

    /// Ends the chunk that write() has begun, although it is short, and returns where the frames are; empty
    /// if there is none. Cannot be cancelled; a chunk whose encoder does not end within a moment is
    /// dropped.
    std::string abandon();

  private:
    void skip_chunks_that_are_there();
    /// Ends the chunk that write() has begun.
    void end_chunk();

    QuietLog quiet_;
    CheckedVideo output_;
    VideoMetadata metadata_;
    Manifest manifest_;
    std::unique_ptr<VideoSink> sink_;
    std::int64_t next_;  ///< number in the film of the frame that write() begins its next chunk with
    std::unique_ptr<ChunkEncoder> encoder_;  ///< of the chunk that write() adds to; null between chunks
};

/// The files that a VideoWriter makes of all chunks of a video or of pictures, in memory: one, or one per
/// frame. The bytes of a video are those that `finish` verifies. Throws corda::Error (kIo, kTemporary).
[[nodiscard]] std::vector<std::string> video_files(const CheckedVideo& video, const VideoMetadata& metadata,
                                                   const std::vector<Chunk>& chunks);

}  // namespace corda::media
