#pragma once

#include <string>

#include "corda/core/rational.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// How a file is laid out.
enum class TrackLayout {
    kPart,   ///< every chunk is complete in itself: the file plays while it grows
    kFinal,  ///< one index, ahead of the pictures
};

/// What a file says of its video track beside its pictures.
struct TrackInfo {
    Rational fps;
    std::string title;
    std::string comment;
    bool has_alpha = false;  ///< of VP9, which keeps alpha in a second stream
};

/// Writes a file with one video track by a muxer of libav to an open file. Time stamps of packets are frame
/// numbers.
class TrackOutput {
  public:
    /// `descriptor` is open for writing and stays open; `path` is where kFinal reads the file again.
    TrackOutput(int descriptor, std::string path);
    TrackOutput(const TrackOutput&) = delete;
    TrackOutput& operator=(const TrackOutput&) = delete;

    /// Writes the header; call it once, before any packet. `container` is libav's name of the muxer. Throws
    /// corda::Error (kIo), like all below.
    void begin(const char* container, TrackLayout layout, const AVCodecParameters& parameters,
               const TrackInfo& info);

    [[nodiscard]] bool begun() const { return begun_; }

    /// Writes a packet (pts and dts in frames, duration 1), which is empty afterwards.
    void write(AVPacket& packet);

    /// Ends the chunk: all packets so far can be played from the file. kPart only.
    void flush();

    /// Writes the trailer and all that is buffered.
    void finish();

  private:
    QuietLog quiet_;
    int descriptor_;
    std::string path_;
    IoContext io_;         // writes to descriptor_
    OutputFormat format_;  // refers to io_
    AVRational frame_base_{};
    bool begun_ = false;
};

}  // namespace corda::media
