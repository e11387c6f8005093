#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "corda/film/film.hpp"
#include "corda/scene/scene.hpp"

namespace corda::benchmark {

/// One way to encode: the ending of the file, and settings of the scene.
struct Encoding {
    std::string ending;
    std::vector<Setting> settings;
};

/// The presets and crf of x264, 4:4:4, and the other lossy codecs, each with its defaults.
[[nodiscard]] std::vector<Encoding> usual_encodings();

/// A render to measure.
struct EncodingDef {
    Scene scene;                ///< with the settings
    FilmDef film;               ///< which OpenGL draws
    std::string ending;         ///< of the file
    std::int64_t frames = 240;  ///< of the video, if the scene has as many; >= 1
};

/// Figures of a video.
struct MeasuredEncoding {
    std::string codec;       ///< short name
    std::string preset;      ///< empty if the codec has none
    std::optional<int> crf;  ///< empty if the codec has none
    std::string pixels;      ///< libav's name of the pixel format
    std::int64_t frames = 0;
    double wall_s = 0.0;  ///< from the scene to the checked file
    std::uintmax_t bytes = 0;
    double edge_psnr_db = 0.0;  ///< of R, G and B as a player shows them, see test::EdgeQuality
    double edge_ssim = 0.0;
};

/// Renders in a child process, then decodes the video and compares every tenth frame with the exact one. This
/// process must have no other thread, and no OpenGL. Throws corda::Error as measure().
[[nodiscard]] MeasuredEncoding measure_encoding(const EncodingDef& def);

}  // namespace corda::benchmark
