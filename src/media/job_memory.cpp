#include "corda/media/job_memory.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace corda::media {
namespace {

using BytesPerPixel = std::pair<std::string_view, int>;

/// Bytes per pixel of the whole process above its 130 MiB, with one job at 1280x720 to 3840x2160: ultrafast
/// 13 to 20, veryfast 61 to 77, medium 175 to 220, slow 207 to 260, veryslow 400 to 470.
constexpr std::array<BytesPerPixel, 10> kX264{{{"ultrafast", 24},
                                               {"superfast", 60},
                                               {"veryfast", 90},
                                               {"faster", 150},
                                               {"fast", 190},
                                               {"medium", 220},
                                               {"slow", 260},
                                               {"slower", 360},
                                               {"veryslow", 470},
                                               {"placebo", 600}}};

/// Of the others by default, at 1920x1080 or 3840x2160, the larger one: libx265 163, libsvtav1 220,
/// libaom-av1 231, libvpx-vp9 147, prores_ks 19, ffv1 177, qtrle with the animation that is made of it 47
/// (.webp), png 4, rawvideo 16.
constexpr std::array<BytesPerPixel, 10> kOthers{{{"libx265", 210},
                                                 {"libsvtav1", 230},
                                                 {"libaom-av1", 240},
                                                 {"libvpx-vp9", 155},
                                                 {"prores_ks", 22},
                                                 {"ffv1", 185},
                                                 {"qtrle", 50},
                                                 {"png", 11},
                                                 {"rawvideo", 18},
                                                 {"h264_nvenc", 50}}};  // not measured

int bytes_per_pixel(const Format& format, const EncoderDef& def) {
    const bool is_x264 = format.codec->origin == EncoderOrigin::kX264;
    const std::string name = is_x264 ? format.preset_of(def) : format.codec->name;
    const std::array<BytesPerPixel, 10>& table = is_x264 ? kX264 : kOthers;
    const auto* const row = std::find_if(
        table.begin(), table.end(), [&](const BytesPerPixel& candidate) { return candidate.first == name; });
    return row == table.end() ? table.back().second : row->second;
}

}  // namespace

std::uint64_t bytes_per_job(const Format& format, const VideoDef& def) {
    const std::uint64_t pixels =
        static_cast<std::uint64_t>(def.width_px) * static_cast<std::uint64_t>(def.height_px);
    return pixels * static_cast<std::uint64_t>(bytes_per_pixel(format, def.encoder));
}

}  // namespace corda::media
