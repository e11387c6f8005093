#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "corda/core/file.hpp"
#include "corda/media/defs.hpp"

struct AVSHA;

namespace corda::media {

/// The last `bytes` bytes of a number, the largest first.
[[nodiscard]] std::string big_endian(std::uint64_t value, std::size_t bytes);

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

/// The bytes of the file that write_png() writes; with `keeps_alpha`, an opaque picture has alpha, too.
/// Throws corda::Error (kIo, kInterrupted) as that does.
[[nodiscard]] std::string png_bytes(const Image& image, const PngInfo& info, bool keeps_alpha = false);

}  // namespace corda::media
