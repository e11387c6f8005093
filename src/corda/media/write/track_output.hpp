#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "corda/core/output_file.hpp"
#include "corda/core/rational.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// Metadata of a video track.
struct TrackInfo {
    Rational fps;
    std::string title;
    std::string comment;
    bool has_alpha = false;  ///< of VP9, which keeps alpha in a second stream
    // Of a GIF.
    std::int64_t frames = 0;
    int loop = 0;  ///< how often it plays; 0: for ever
};

/// Writes a file with one video track by a muxer of libav, with its index ahead of the pictures. Time stamps
/// of packets are frame numbers.
class TrackOutput : NonCopyable {
  public:
    /// Writes the header. `output` must outlive this; `container` is libav's name of the muxer. Throws
    /// corda::Error (kIo), like all below.
    TrackOutput(const OutputFile& output, const char* container, const AVCodecParameters& parameters,
                const TrackInfo& info);
    ~TrackOutput();

    /// Writes a packet (pts and dts in frames, duration 1), which is empty afterwards.
    void write(AVPacket& packet);

    /// Writes the trailer and all that is buffered.
    void finish();

  private:
    static int write_bytes(void* output, const std::uint8_t* bytes, int count);
    static std::int64_t seek(void* output, std::int64_t offset, int whence);

    QuietLog quiet_;
    int descriptor_;
    std::string path_;
    IoContext io_;         // writes to descriptor_
    OutputFormat format_;  // refers to io_
    AVRational frame_base_{};
    std::int64_t bytes_ = 0;   ///< of packets
    std::int64_t frames_ = 0;  ///< their number
    bool ended_ = false;
};

}  // namespace corda::media
