#include "corda/media/job_memory.hpp"

#include <array>
#include <string_view>
#include <utility>

namespace corda::media {
namespace {

/// Bytes per pixel of the whole process above its 130 MiB, with one job at 1280x720 to 3840x2160: ultrafast
/// 30 to 31, veryfast 86 to 104, medium 172 to 220, slow 207 to 260, veryslow 400 to 470.
constexpr std::array<std::pair<std::string_view, int>, 10> kX264{{{"ultrafast", 32},
                                                                  {"superfast", 60},
                                                                  {"veryfast", 105},
                                                                  {"faster", 150},
                                                                  {"fast", 190},
                                                                  {"medium", 220},
                                                                  {"slow", 260},
                                                                  {"slower", 360},
                                                                  {"veryslow", 470},
                                                                  {"placebo", 600}}};

/// Of the others at 1920x1080: libx265 210, libsvtav1 206, libvpx-vp9 145, ffv1 172.
constexpr int kOthers = 210;

int bytes_per_pixel(const Format& format, const EncoderDef& def) {
    if (std::string_view(format.codec->name) != "libx264") return kOthers;
    const std::string preset = format.preset_of(def);
    for (const auto& [name, bytes] : kX264)
        if (name == preset) return bytes;
    return kX264.back().second;
}

}  // namespace

std::uint64_t bytes_per_job(const Format& format, const VideoDef& def) {
    const std::uint64_t pixels =
        static_cast<std::uint64_t>(def.width_px) * static_cast<std::uint64_t>(def.height_px);
    return pixels * static_cast<std::uint64_t>(bytes_per_pixel(format, def.encoder));
}

}  // namespace corda::media
