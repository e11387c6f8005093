#pragma once

#include <string>

namespace corda::test {

/// What the program ffprobe finds in a video.
struct VideoFacts {
    int frames = 0;  ///< that it decodes
    int width_px = 0;
    int height_px = 0;
    std::string codec;            ///< libav's name: "h264"
    std::string profile;          ///< "High"
    std::string pixel_format;     ///< "yuv420p"
    std::string colors;           ///< range, matrix, primaries and transfer: "tv bt709 bt709 iec61966-2-1"
    std::string chroma_location;  ///< "left"
    double duration_s = 0.0;
    double tick_s = 0.0;  ///< of the clock that its times count in
};

/// Decodes all frames of a video. Throws std::runtime_error if ffprobe reports any error.
[[nodiscard]] VideoFacts probe(const std::string& path);

}  // namespace corda::test
