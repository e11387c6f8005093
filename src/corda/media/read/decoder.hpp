#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// Decodes the best video track of a file, VP9 with its alpha.
class Decoder {
  public:
    /// How a packet is decoded.
    enum class PacketUse {
        kDecode,
        kDecodeAlone,  ///< apart from all others, which takes a key frame
        kSkip,
    };

    /// Opens a file of a kind that libav demuxes (see file_kind.hpp). Throws corda::Error (kIo) with libav's
    /// reason if it is of no such kind, has no video track, or needs a decoder that does not open.
    explicit Decoder(std::string path);

    [[nodiscard]] const AVFormatContext& format() const { return *format_; }
    [[nodiscard]] const AVStream& stream() const { return *stream_; }
    [[nodiscard]] AVCodecContext& context() { return *context_; }
    /// True if a frame found no memory, which decoders report as damage.
    [[nodiscard]] bool lacks_memory() const { return *lacks_memory_; }
    /// The frame that was decoded last.
    [[nodiscard]] const AVFrame& frame() const { return *frame_; }

    /// Decodes up to the next frame, in the order in which a player shows them. Returns 0, or AVERROR_EOF
    /// behind the last frame, or libav's status for a packet or frame that does not decode; decoding can go
    /// on then. `use` is asked about each packet of the track. `log` is cleared before a packet is read.
    [[nodiscard]] int next(LogCapture& log, const std::function<PacketUse(const AVPacket&)>& use = {});

    /// As next(), but returns false behind the last frame, and throws corda::Error (kIo) for one that does
    /// not decode cleanly.
    [[nodiscard]] bool read();

    [[noreturn]] void fail(int status) const;

  private:
    int open(const AVCodec* codec, int threads);
    /// Reads the next packet and sends it. Returns libav's status.
    int feed(const std::function<PacketUse(const AVPacket&)>& use);

    std::string path_;
    InputFormat format_;
    const AVStream* stream_ = nullptr;  ///< owned by format_
    std::unique_ptr<std::atomic<bool>> lacks_memory_ = std::make_unique<std::atomic<bool>>(false);
    CodecContext context_;
    Packet packet_;
    Frame frame_;
    bool has_input_ = false;     ///< the decoder may hold a frame
    bool is_drain_due_ = false;  ///< the end of the stream is to be sent
    bool is_draining_ = false;
    bool is_alone_ = false;  ///< its packet is decoded alone
    int drain_errors_ = 0;
};

/// The comment or title in a file's metadata; empty if it has none.
[[nodiscard]] std::string metadata_entry(const AVFormatContext& format, const char* key);

/// True for a track of VP9 that keeps alpha in a second stream.
[[nodiscard]] bool is_marked_as_alpha(const AVStream& stream);

}  // namespace corda::media
