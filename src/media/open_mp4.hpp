#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "corda/media/libav_handles.hpp"

namespace corda::media {

/// An MP4 file with a decoder for its best video track, ready to read.
struct OpenMp4 {
    InputFormat format;
    const AVStream* stream = nullptr;  ///< owned by `format`
    /// Whether a frame found no memory, which decoders report as damage.
    std::unique_ptr<std::atomic<bool>> lacks_memory = std::make_unique<std::atomic<bool>>(false);
    CodecContext context;
};

/// Opens `path` for decoding. Throws corda::Error (kIo) in libav's words if it is no MP4 file, has no
/// video track, or needs a decoder that does not open.
[[nodiscard]] OpenMp4 open_mp4(const std::string& path);

}  // namespace corda::media
