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
    /// The element to write next; counting begins again after it. `container` is libav's name of the muxer.
    [[nodiscard]] std::string element(std::string_view container) const;
    /// The element without its head: a mark, the number of bytes counted and their checksum. The bytes of the
    /// head are counted before it.
    [[nodiscard]] std::string record() const;

  private:
    std::uint64_t bytes_ = 0;  ///< since the last checksum
    std::uint32_t crc_ = 0;
};

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
[[nodiscard]] SoundBytes sound_bytes_of(const std::string& path, PartExtent extent,
                                        const OnProgress& on_progress = {});

}  // namespace corda::media
