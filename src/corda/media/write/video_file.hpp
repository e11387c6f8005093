#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/core/output_file.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/encode/encoder.hpp"
#include "corda/media/encode/frame_maker.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/write/track_output.hpp"

namespace corda::media {

/// A video output that check_video_output() has accepted: the frames first <= k < end of a film, the last of
/// which is repeated as frames `end` and on.
struct CheckedVideo {
    std::string path{};
    VideoDef def{};
    Format format{};
    std::int64_t first = 0;
    std::int64_t end = 1;
    std::int64_t held = 0;                ///< how often it is repeated
    bool force = false;                   ///< replace what is there
    bool resume = false;                  ///< of pictures: keep those that are there and belong to the film
    std::vector<std::int64_t> to_draw{};  ///< see frames_to_draw()

    [[nodiscard]] std::int64_t frames() const { return end - first + held; }
};

/// Checks a video, whose format it fills in, before any work is done: everything that check_video_def,
/// find_format and corda::check_output check, and whether a hardware encoder opens. Throws corda::Error
/// (kUsage, kIo, kEncoder).
[[nodiscard]] CheckedVideo check_video_output(CheckedVideo video, const std::string& input = "",
                                              bool is_transparent = false);

/// The frames that are to be drawn, in order: of pictures that are continued, those that are missing or
/// damaged. Throws corda::Error: kUsage, without `force`, for a picture that is not as `info` tells, because
/// it is of another scene or another version of Corda, which `difference_of` its texts says in words; kIo.
[[nodiscard]] std::vector<std::int64_t> frames_to_draw(
    const CheckedVideo& video, const PictureInfo& info,
    const std::function<std::string(const PngInfo&)>& difference_of);

/// Metadata of a video file.
struct VideoMetadata {
    std::string title{};
    /// A JSON object, to which a VideoFile adds "frames", "fps" and "crf".
    std::string comment_json = "{}";
};

/// One encoder and one muxer: encodes frames in order into an open file.
class TrackWriter : NonCopyable {
  public:
    /// Opens the encoder. `output` must outlive this. Throws corda::Error (kEncoder, kIo), like all below.
    TrackWriter(const CheckedVideo& video, VideoMetadata metadata, const OutputFile& output);

    void add(ReadyFrame frame);
    /// Drains the encoder and writes the trailer. Throws kInterrupted if cancelled.
    void finish();
    /// The first frame as it was drawn.
    [[nodiscard]] const Image& first() const { return first_; }

  private:
    void write(AVPacket& packet);

    const CheckedVideo& video_;
    VideoMetadata metadata_;
    const OutputFile& output_;
    std::unique_ptr<Encoder> encoder_;
    std::optional<TrackOutput> track_;  ///< once there is a packet, which may tell the header
    Image first_;
    std::int64_t packets_ = 0;
};

/// Writes the frames of a video, in the format that the ending of its name tells.
///
/// A video is a file of temporary name beside its own until `commit` has checked it; whatever has the final
/// name is complete. Without `commit` nothing is left. Pictures and standard output have each frame as soon
/// as it is added.
class VideoFile : NonCopyable {
  public:
    /// `video` must outlive this. Throws corda::Error (kIo, kEncoder).
    VideoFile(const CheckedVideo& video, VideoMetadata metadata);
    ~VideoFile();

    /// Adds the next frame. Throws kEncoder or kIo; ReaderLeft (see output_file.hpp) if the reader of
    /// standard output closed it.
    void add(ReadyFrame frame);

    /// Ends the file, checks it by check_video(), flushes it to the disk and gives it its name. Calls
    /// `on_progress` meanwhile with all frames; of a GIF, whose frames are encoded now, with twice as many as
    /// there are, and with those that are done. Throws kEncoder, kIo, or kInterrupted if cancelled.
    void commit(const OnProgress& on_progress = {});

    /// Where frames go: each kind of file has one.
    class Sink : NonCopyable {
      public:
        virtual ~Sink() = default;
        virtual void add(ReadyFrame frame) = 0;
        /// See `commit`.
        virtual void commit(const OnProgress& /*on_progress*/) {}
    };

  private:
    QuietLog quiet_;
    std::unique_ptr<Sink> sink_;
};

}  // namespace corda::media
