#pragma once

#include <memory>
#include <string>
#include <vector>

#include "corda/media/format.hpp"

namespace corda::media {

/// The names of x264's presets, fastest first.
[[nodiscard]] const std::vector<std::string>& x264_presets();

/// Format::check of libx264: even sides, preset and crf.
void check_h264(const VideoDef& def);

/// Format::make_encoder of libx264: High profile (Constrained Baseline for the preset ultrafast), which
/// browsers and QuickTime play.
[[nodiscard]] std::unique_ptr<Encoder> make_h264_encoder(const Format& format, const VideoDef& def);

}  // namespace corda::media
