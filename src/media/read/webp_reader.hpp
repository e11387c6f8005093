#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/rational.hpp"

namespace corda::media {

/// Reads the pictures of an animated WebP, by libwebp: libavcodec does not decode them.
class WebpReader {
  public:
    /// Throws corda::Error (kIo) if the file cannot be opened for reading.
    explicit WebpReader(const std::string& path);
    WebpReader(const WebpReader&) = delete;
    WebpReader& operator=(const WebpReader&) = delete;
    ~WebpReader();

    /// Whether libwebp accepts the file; if not, there is nothing to read.
    [[nodiscard]] bool is_open() const;
    [[nodiscard]] int width_px() const;
    [[nodiscard]] int height_px() const;

    /// Whether there are further pictures.
    [[nodiscard]] bool has_next() const;
    /// The next picture: RGBA, straight alpha, row 0 on top, until the next call. Null if it does not decode.
    [[nodiscard]] const std::uint8_t* read();

    /// When the pictures end, in ms: as far as they were read, or all by the file's own account.
    [[nodiscard]] const std::vector<std::int64_t>& read_ends_ms() const;
    [[nodiscard]] std::vector<std::int64_t> told_ends_ms() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The rate whose frames, rounded to milliseconds, end at these times: of several `told`, a usual one, or the
/// simplest. The times are those of frames 1, 2, ... and of the end; std::nullopt if no rate fits.
[[nodiscard]] std::optional<Rational> rate_of_ms(const std::vector<std::int64_t>& ends_ms,
                                                 std::optional<Rational> told = {});

}  // namespace corda::media
