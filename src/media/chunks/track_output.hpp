#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "corda/core/rational.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// Checksums in a part file, one after each chunk, so that changed or lost bytes are found without decoding:
/// most decoders do not notice them. Each is in an element that players skip, and covers all bytes since the
/// previous one.
class PartChecksum {
  public:
    /// Start of a record: 16 bytes that no text holds, as \xc3 and a letter are no UTF-8.
    static constexpr std::string_view kMark =
        "\xc3"
        "corda checksum\n";
    static constexpr std::size_t kLengthBytes = 8;
    static constexpr std::size_t kSumBytes = 4;
    static constexpr std::size_t kRecordBytes = kMark.size() + kLengthBytes + kSumBytes;

    /// Counts bytes that have been written.
    void add(std::string_view bytes);
    /// True if bytes were counted since the last checksum.
    [[nodiscard]] bool is_due() const { return bytes_ > 0; }
    /// The element to write next; counting begins again after it. `container` is libav's name of the muxer.
    [[nodiscard]] std::string element(std::string_view container) const;
    /// The element without its head: a mark, the number of bytes counted and their checksum. The bytes of the
    /// head are counted before it.
    [[nodiscard]] std::string record() const;

  private:
    std::uint64_t bytes_ = 0;  ///< since the last checksum
    std::uint32_t crc_ = 0;
};

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

/// True if this libavformat, of FFmpeg 5.1, writes headers of Matroska files that FFmpeg 7.1 writes
/// otherwise. The same video must have the same bytes with either.
inline constexpr bool kHasOldMatroska = LIBAVFORMAT_VERSION_MAJOR < 61;

/// By how much the newer header is larger: a muxer of the older one must leave as much room
/// (AVFormatContext::metadata_header_padding), of which it makes a Void element behind the tags.
inline constexpr int kNewMatroskaBytes = 14;

/// The bytes before the room's end that a longest header has.
inline constexpr std::size_t kMaxMatroskaHeader = std::size_t{1} << 20;

/// `file`, the beginning of a finished Matroska file with one video track and room in its header, as
/// FFmpeg 7.1 writes it: its track has room for HDR metadata that may follow, and its duration in words ends
/// with one zero rather than two. As it is if it has another structure.
[[nodiscard]] std::string with_new_matroska_header(std::string file);

}  // namespace corda::media
