#pragma once

#include <string>

#include "corda/core/rational.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// How an MP4 file is laid out.
enum class Mp4Layout {
    kFragmented,  ///< every group of pictures is complete in itself: the file plays while it grows
    kFaststart,   ///< one index, ahead of the pictures
};

/// Writes an MP4 file with one video track to an open file. Time stamps of packets are frame numbers.
class Mp4Output {
  public:
    /// `descriptor` is open for writing and stays open; `path` is where kFaststart reads the file again.
    Mp4Output(int descriptor, std::string path);
    Mp4Output(const Mp4Output&) = delete;
    Mp4Output& operator=(const Mp4Output&) = delete;

    /// Writes the header; call it once, before any packet. `container` is libav's name of the muxer. Throws
    /// corda::Error (kIo), like all below.
    void begin(const char* container, Mp4Layout layout, const AVCodecParameters& parameters, Rational fps,
               const std::string& title, const std::string& comment);

    [[nodiscard]] bool begun() const { return begun_; }

    /// Writes a packet (pts and dts in frames, duration 1), which is empty afterwards.
    void write(AVPacket& packet);

    /// Ends the fragment: all packets so far can be played from the file. kFragmented only.
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
