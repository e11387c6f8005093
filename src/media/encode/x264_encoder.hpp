#pragma once

#include <memory>
#include <string>

#include "corda/media/encode/encoder.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

/// Whether Corda was built with libx264 (CORDA_X264).
[[nodiscard]] bool has_x264();

/// "libx264 164"; empty without it.
[[nodiscard]] std::string x264_version();

/// An encoder of libx264, which is told what libavcodec cannot tell it: which macroblocks are as they were in
/// the previous frame. It does not look at them again. Throws corda::Error (kEncoder).
[[nodiscard]] std::unique_ptr<Encoder> make_x264_encoder(const Format& format, const VideoDef& def);

}  // namespace corda::media
