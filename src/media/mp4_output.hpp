#pragma once

#include <string>

#include "corda/core/rational.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// How an MP4 file is laid out.
enum class Mp4Layout {
    kFragmented,  ///< each group of pictures is complete in itself: playable while it grows
    kFaststart,   ///< one index, ahead of the pictures
};

/// An MP4 file with one video track that is being written. Time stamps of packets are frame numbers.
class Mp4Output {
  public:
    /// Creates the file. Throws corda::Error (kIo).
    explicit Mp4Output(std::string path);

    /// Writes the header; once, before any packet. Throws corda::Error (kIo).
    void begin(Mp4Layout layout, const AVCodecParameters& parameters, Rational fps, const std::string& title,
               const std::string& comment);

    [[nodiscard]] bool begun() const { return begun_; }

    /// Writes a packet (pts and dts in frames, duration 1), which is empty afterwards. Throws corda::Error
    /// (kIo).
    void write(AVPacket& packet);

    /// Writes the trailer and closes, each checked. Throws corda::Error (kIo).
    void close();

  private:
    std::string path_;
    IoContext file_;
    OutputFormat format_;  // refers to file_
    AVRational frame_base_{};
    bool begun_ = false;
};

}  // namespace corda::media
