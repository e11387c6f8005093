#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// A video file with a decoder for its best video track, ready to read.
struct OpenVideo {
    InputFormat format;
    const AVStream* stream = nullptr;  ///< owned by `format`
    /// Whether a frame found no memory, which decoders report as damage.
    std::unique_ptr<std::atomic<bool>> lacks_memory = std::make_unique<std::atomic<bool>>(false);
    CodecContext context;
};

/// Opens a file of a kind that libav demuxes (see file_kind.hpp) for decoding, VP9 with its alpha. Throws
/// corda::Error (kIo) in libav's words if it is of no such kind, has no video track, or needs a decoder that
/// does not open. With `bytes`, only so many of its first bytes are read.
[[nodiscard]] OpenVideo open_video(const std::string& path, std::optional<std::uint64_t> bytes = {});

/// Whether a track of VP9 keeps alpha in a second stream.
[[nodiscard]] bool is_marked_as_alpha(const AVStream& stream);

}  // namespace corda::media
