#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "corda/core/basics.hpp"

namespace corda::media {

/// Checksums in a part file, one after each chunk, so that changed or lost bytes are found without decoding:
/// most decoders do not notice them. Each is in an element that players skip, and covers all bytes since the
/// previous one.
class PartChecksum {
  public:
    /// Counts bytes that have been written.
    void add(std::string_view bytes);
    /// Whether bytes were counted since the last checksum.
    [[nodiscard]] bool is_due() const { return bytes_ > 0; }
    /// The element to write next, which is not counted. `container` is libav's name of the muxer.
    [[nodiscard]] std::string element(std::string_view container);
    /// The element without its head: a mark, the number of bytes counted and their checksum. The bytes of the
    /// head are counted before it.
    [[nodiscard]] std::string record() const;

  private:
    std::uint64_t bytes_ = 0;  ///< since the last checksum
    std::uint32_t crc_ = 0;
};

/// The length of the longest beginning of a part that ends with a checksum and in which all are right; 0
/// without any. Throws corda::Error: kIo if the file cannot be read, kInterrupted.
[[nodiscard]] std::uint64_t sound_part_bytes(const std::string& path, const OnProgress& on_progress = {});

}  // namespace corda::media
