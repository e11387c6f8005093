#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "corda/media/encode/encoder.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

// Options of each family of libav's encoders: Codec::settings.
[[nodiscard]] EncoderSettings nvenc_settings(const Format& format, const VideoDef& def);
[[nodiscard]] EncoderSettings x265_settings(const Format& format, const VideoDef& def);
[[nodiscard]] EncoderSettings svt_av1_settings(const Format& format, const VideoDef& def);
[[nodiscard]] EncoderSettings aom_av1_settings(const Format& format, const VideoDef& def);
[[nodiscard]] EncoderSettings vp9_settings(const Format& format, const VideoDef& def);
[[nodiscard]] EncoderSettings prores_settings(const Format& format, const VideoDef& def);
[[nodiscard]] EncoderSettings ffv1_settings(const Format& format, const VideoDef& def);
[[nodiscard]] EncoderSettings exact_settings(const Format& format, const VideoDef& def);

/// Metadata of a picture, by its number in the film.
using PictureInfo = std::function<PngInfo(std::int64_t frame)>;

/// Opens the encoder of a format for a definition that was checked, for a chunk that begins with frame
/// `first_frame`; a picture file says what `info` tells. Throws corda::Error (kEncoder).
[[nodiscard]] std::unique_ptr<Encoder> make_encoder(const Format& format, const VideoDef& def,
                                                    std::int64_t first_frame = 0,
                                                    const PictureInfo& info = {});

}  // namespace corda::media
