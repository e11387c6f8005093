#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "corda/core/file.hpp"
#include "corda/media/defs.hpp"

struct AVSHA;

namespace corda::media {

/// The last `bytes` bytes of a number, the largest first.
[[nodiscard]] std::string big_endian(std::uint64_t value, std::size_t bytes);

/// The number that bytes make, the largest first.
[[nodiscard]] std::uint64_t from_big_endian(std::string_view bytes);

/// Reads a file or a text of any origin from its beginning. What is asked for behind the end is missing, and
/// then nothing is left.
class ByteReader {
  public:
    /// Reads a text, which must outlive the reader.
    explicit ByteReader(std::string_view text) : text_(text), size_(text.size()) {}
    /// Reads a file. Throws corda::Error (kIo), as all below.
    [[nodiscard]] static ByteReader of_file(const std::string& path);

    [[nodiscard]] std::uint64_t position() const { return position_; }
    [[nodiscard]] std::uint64_t left() const { return size_ - position_; }

    /// The next bytes, at most `count`; fewer at the end.
    [[nodiscard]] std::string take(std::uint64_t count);
    /// A number of `bytes` bytes, at most 8, the largest first.
    [[nodiscard]] std::optional<std::uint64_t> number(std::size_t bytes);
    /// Leaves out the next bytes; returns false if there are fewer.
    [[nodiscard]] bool skip(std::uint64_t count);

  private:
    std::string path_;
    FileHandle file_;
    std::string_view text_;  ///< if there is no file
    std::uint64_t size_ = 0;
    std::uint64_t position_ = 0;
};

/// SHA-256 (FIPS 180-4) of the bytes that are added.
class Sha256 : NonCopyable {
  public:
    /// Throws corda::Error (kTemporary).
    Sha256();
    ~Sha256();
    void add(std::string_view bytes);
    /// In hexadecimal. Nothing can be added afterwards.
    [[nodiscard]] std::string text();

  private:
    AVSHA* sum_;
};
/// Of a file. Throws corda::Error (kIo, kInterrupted).
[[nodiscard]] std::string sha256_of_file(const std::string& path);

/// The head of a chunk of a PNG (PNG specification, third edition, 5.3). Behind it are `length` bytes and a
/// checksum.
struct PngChunk {
    static constexpr std::uint64_t kChecksumBytes = 4;
    std::string type;
    std::uint64_t length = 0;
};
[[nodiscard]] std::optional<PngChunk> next_png_chunk(ByteReader& bytes);

/// The head of a box of MP4 (ISO/IEC 14496-12, 4.2). Behind it are `length` bytes, or fewer if the file
/// breaks off.
struct Mp4Box {
    std::string type;
    std::uint64_t length = 0;
};
/// Returns std::nullopt also for a size that is less than that of the head.
[[nodiscard]] std::optional<Mp4Box> next_mp4_box(ByteReader& bytes);

/// A number of variable length of Matroska (RFC 8794, 4), whose first set bit tells how many bytes it has.
struct EbmlNumber {
    std::uint64_t id = 0;      ///< all of its bits
    std::uint64_t length = 0;  ///< without the first set bit
    std::size_t bytes = 0;
    bool is_unknown = false;  ///< all bits of `length` are set
};
[[nodiscard]] std::optional<EbmlNumber> next_ebml_number(ByteReader& bytes);

// Arithmetic on numbers from files: std::nullopt in place of an overflow, which in signed numbers is
// undefined.

template <typename T>
[[nodiscard]] std::optional<T> checked_add(T a, T b) {
    T result = 0;
    return __builtin_add_overflow(a, b, &result) ? std::nullopt : std::optional<T>(result);
}

template <typename T>
[[nodiscard]] std::optional<T> checked_multiply(T a, T b) {
    T result = 0;
    return __builtin_mul_overflow(a, b, &result) ? std::nullopt : std::optional<T>(result);
}

/// True if a time stamp can be right. Others, among them AV_NOPTS_VALUE, are so large that sums of a few of
/// them overflow: 2^60 ticks of the finest clock, 2^-32 s, are eight years.
[[nodiscard]] inline bool is_sane_stamp(std::int64_t ticks) {
    constexpr std::int64_t kLargest = std::int64_t{1} << 60;
    return ticks >= -kLargest && ticks <= kLargest;
}

/// The bytes of the file that write_png() writes; with `keeps_alpha`, an opaque picture has alpha, too.
/// Throws corda::Error (kIo, kInterrupted) as that does.
[[nodiscard]] std::string png_bytes(const Image& image, const PngInfo& info, bool keeps_alpha = false);

}  // namespace corda::media
