#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/media/chunks/finish_part.hpp"
#include "corda/media/chunks/track_output.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// Destination of the packets of a video, whose time stamps count frames from the first one. All functions
/// throw corda::Error (kIo).
class VideoSink {
  public:
    VideoSink() = default;
    VideoSink(const VideoSink&) = delete;
    VideoSink& operator=(const VideoSink&) = delete;
    virtual ~VideoSink() = default;

    /// Number of frames taken over from an interrupted render, always whole chunks. If there are any, begin()
    /// is not called.
    [[nodiscard]] virtual std::int64_t resumed_frames() const { return 0; }
    /// Whether the interrupted render's part was damaged after these frames.
    [[nodiscard]] virtual bool was_part_damaged() const { return false; }
    /// Called once, before the first packet.
    virtual void begin(const AVCodecParameters& parameters, const TrackInfo& info) = 0;
    virtual void write(AVPacket& packet) = 0;
    /// All packets so far are to be safe.
    virtual void end_chunk() = 0;
    /// No more packets come; what there is so far is whole.
    virtual void drain() {}
    /// After drain(): gives the video its name. Throws kMismatch if it is not sound.
    virtual void finish(const FinishDef& /*def*/) {}
    /// After drain(): leaves what there is, of at least one frame, and tells where.
    virtual std::string abandon() = 0;
    /// Nothing was written: leaves no trace.
    virtual void remove() noexcept {}
};

/// The frames of a video.
struct FrameRange {
    std::int64_t first = 0;      ///< number in the film
    std::int64_t end = 0;        ///< one past the last
    std::int64_t per_chunk = 1;  ///< chunks begin at multiples of this
};

/// Destination of the packets of a format, under this name. With `resume`, a part of an interrupted render of
/// the same frames is resumed, if there is one. Throws corda::Error: kIo, and kMismatch for a part that
/// cannot be read.
[[nodiscard]] std::unique_ptr<VideoSink> make_sink(const Format& format, const std::string& path,
                                                   const OutputOptions& options, const FrameRange& frames,
                                                   bool resume);

}  // namespace corda::media
