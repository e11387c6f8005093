#pragma once

#include <string>

#include "corda/core/rational.hpp"
#include "corda/media/chunks/part_checksum.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// How a file is laid out.
enum class TrackLayout {
    kPart,   ///< every chunk is complete in itself, and has a checksum: the file plays while it grows
    kFinal,  ///< one index, ahead of the pictures
};

/// Metadata of a video track.
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
    TrackOutput(int descriptor, std::string path, TrackLayout layout);
    TrackOutput(const TrackOutput&) = delete;
    TrackOutput& operator=(const TrackOutput&) = delete;
    ~TrackOutput();

    /// Writes the header; call it once, before any packet. `container` is libav's name of the muxer. Throws
    /// corda::Error (kIo), like all below.
    void begin(const char* container, const AVCodecParameters& parameters, const TrackInfo& info);

    /// Writes a packet (pts and dts in frames, duration 1), which is empty afterwards.
    void write(AVPacket& packet);

    /// Ends the chunk: all packets so far can be played from the file. kPart only.
    void flush();

    /// Writes the trailer and all that is buffered.
    void finish();

  private:
    static int write_bytes(void* output, const std::uint8_t* bytes, int count);
    static std::int64_t seek(void* output, std::int64_t offset, int whence);
    /// Flushes the buffer; in a part, also a checksum of all bytes since the previous one.
    void end_bytes(const std::string& what);
    /// True if the header must be renewed at the end, to that of newer versions of FFmpeg.
    [[nodiscard]] bool has_old_header() const;
    void renew_header(const std::string& what);

    QuietLog quiet_;
    int descriptor_;
    std::string path_;
    TrackLayout layout_;
    PartChecksum checksum_;
    IoContext io_;         // writes to descriptor_
    OutputFormat format_;  // refers to io_
    AVRational frame_base_{};
    bool begun_ = false;
    bool ended_ = false;
};

}  // namespace corda::media
