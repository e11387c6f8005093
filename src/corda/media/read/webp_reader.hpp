#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/core/rational.hpp"

struct WebPAnimDecoder;

namespace corda::media {

/// Reads the pictures of an animated WebP, by libwebp: libavcodec does not decode them.
class WebpReader : NonCopyable {
  public:
    /// Throws corda::Error (kIo) if the file cannot be opened for reading.
    explicit WebpReader(const std::string& path);

    /// True if libwebp accepts the file; if not, there is nothing to read.
    [[nodiscard]] bool is_open() const { return decoder_ != nullptr; }
    [[nodiscard]] int width_px() const { return width_px_; }
    [[nodiscard]] int height_px() const { return height_px_; }
    /// True if there are further pictures.
    [[nodiscard]] bool has_next() const;
    /// Puts the next picture into `picture`, which gets its size; returns false if it does not decode.
    [[nodiscard]] bool read(Image& picture);

    /// Ends of the pictures in ms: of those that were read, or of all as the file states them.
    [[nodiscard]] const std::vector<std::int64_t>& read_ends_ms() const { return ends_ms_; }
    [[nodiscard]] std::vector<std::int64_t> stated_ends_ms() const;

  private:
    struct Free {
        void operator()(WebPAnimDecoder* decoder) const;
    };

    std::string bytes_;
    std::unique_ptr<WebPAnimDecoder, Free> decoder_;
    int width_px_ = 0;
    int height_px_ = 0;
    std::vector<std::int64_t> ends_ms_;
};

/// The rate whose frames, rounded to ticks, end at these times: of several `stated`, a usual one, or the
/// simplest. The times are those of frames 1, 2, ... and of the end; std::nullopt if no rate fits.
[[nodiscard]] std::optional<Rational> rate_of_ends(const std::vector<std::int64_t>& ends,
                                                   std::optional<Rational> stated = {},
                                                   std::int64_t ticks_per_second = 1000);

}  // namespace corda::media
