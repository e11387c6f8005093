#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/rational.hpp"
#include "corda/media/chunks/track_output.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/read/decoder.hpp"

namespace corda::media {

/// The part file, open for reading its packets.
struct PartInput {
    InputFormat format;
    const AVStream* stream = nullptr;
    bool is_matroska = false;  ///< then stamps are rounded to milliseconds
};

/// The order of the frames in a part: packet i, in decoding order, shows frame frame_of[i].
struct PartIndex {
    Rational fps;
    std::vector<std::int64_t> frame_of;
    std::int64_t reorder_depth = 0;  ///< how many frames decoding must run ahead of showing
    AVCodecID codec = AV_CODEC_ID_NONE;
    std::uint64_t bytes = 0;  ///< length of the prefix whose checksums match
    bool is_cut = false;      ///< there is more in the file
    bool is_damaged = false;  ///< the rest is not a chunk that broke off: it has changed
};

/// A part without a whole chunk: nothing of it can be used.
class EmptyPart : public Error {
  public:
    using Error::Error;
};

/// Opens the first `bytes` of a part. Throws corda::Error (kMismatch) if there is no video in them.
[[nodiscard]] PartInput open_part(const std::string& path, std::uint64_t bytes);

/// Reads all packets of a part. Throws EmptyPart (kMismatch), or corda::Error: kMismatch if it has no
/// constant frame rate, kInterrupted if cancelled.
[[nodiscard]] PartIndex index_part(const std::string& path);

/// Result of checking the checksums of a part.
struct SoundBytes {
    /// Length of the longest prefix that ends with a checksum and whose checksums all match; 0 if there is
    /// none.
    std::uint64_t count = 0;
    bool is_damaged = false;  ///< the checksum after that prefix does not match; otherwise it is missing
};

/// How much of a part is read.
enum class PartExtent { kAll, kFirstChunk };

/// Compares the checksums of a part with its bytes. Throws corda::Error: kIo if the file cannot be read,
/// kInterrupted.
[[nodiscard]] SoundBytes sound_bytes_of(const std::string& path, PartExtent extent);

/// Metadata in the first chunk of a part.
struct PartComment {
    std::optional<std::string> text;  ///< std::nullopt if that chunk is not whole
    bool is_damaged = false;          ///< it does not break off: it has changed
};

/// The comment of a part. Throws as open_part, and corda::Error: kIo, kInterrupted.
[[nodiscard]] PartComment part_comment(const std::string& path);

/// Whether a text is among the first bytes of a file, where a part has its comment: also one that breaks off
/// in its first chunk. Throws corda::Error (kIo).
[[nodiscard]] bool holds_in_front(const std::string& path, std::string_view text);

/// Removes the copy of a part that a killed process has left (see part_copy_path), and no other file of that
/// name. Never throws: it does no harm.
void remove_part_copy(const std::string& part) noexcept;

/// Copies packets of a part, from the first one, into a track, with time stamps computed from frame numbers.
class PacketCopy {
  public:
    /// All must outlive it.
    PacketCopy(const std::string& path, const PartInput& input, const PartIndex& index)
        : path_(&path), input_(&input), index_(&index) {}

    /// Copies the packets up to the one of number `end`. Throws corda::Error: kIo, kInterrupted.
    void copy_to(std::size_t end, TrackOutput& output);

  private:
    const std::string* path_;
    const PartInput* input_;
    const PartIndex* index_;
    std::size_t next_ = 0;
};

}  // namespace corda::media
