#include "corda/media/encode/job_memory.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "corda/core/machine.hpp"

namespace corda::media {
namespace {

using BytesPerPixel = std::pair<std::string_view, int>;

/// Memory that one job adds, per pixel, to the 130 MiB of the process; measured at 1280x720 to 3840x2160:
/// ultrafast 13 to 20, veryfast 61 to 77, medium 175 to 220, slow 207 to 260, veryslow 400 to 470.
constexpr std::array kX264{BytesPerPixel{"ultrafast", 24}, BytesPerPixel{"superfast", 60},
                           BytesPerPixel{"veryfast", 90},  BytesPerPixel{"faster", 150},
                           BytesPerPixel{"fast", 190},     BytesPerPixel{"medium", 220},
                           BytesPerPixel{"slow", 260},     BytesPerPixel{"slower", 360},
                           BytesPerPixel{"veryslow", 470}, BytesPerPixel{"placebo", 600}};

/// The same of the other encoders at their defaults, the larger of the values measured at 1920x1080 and
/// 3840x2160: libx265 163, libsvtav1 220, libaom-av1 231, libvpx-vp9 147, prores_ks 19, ffv1 177, qtrle with
/// the animation that is made of it 47 (.webp), png 4, rawvideo 16. Any other one is taken for the largest.
constexpr std::array kOthers{
    BytesPerPixel{"libx265", 210},    BytesPerPixel{"libsvtav1", 230},
    BytesPerPixel{"libvpx-vp9", 155}, BytesPerPixel{"prores_ks", 22},
    BytesPerPixel{"ffv1", 185},       BytesPerPixel{"qtrle", kAnimationBytesPerPixel},
    BytesPerPixel{"png", 11},         BytesPerPixel{"rawvideo", 18},
    BytesPerPixel{"libaom-av1", 240}};

int bytes_of(std::span<const BytesPerPixel> table, std::string_view name) {
    const auto row = std::find_if(table.begin(), table.end(),
                                  [&](const BytesPerPixel& candidate) { return candidate.first == name; });
    return row == table.end() ? table.back().second : row->second;
}

int bytes_per_pixel(const Format& format, const EncoderDef& def) {
    return format.codec->origin == EncoderOrigin::kX264 ? bytes_of(kX264, format.preset_of(def))
                                                        : bytes_of(kOthers, format.codec->name);
}

}  // namespace

std::uint64_t bytes_per_job(const Format& format, const VideoDef& def) {
    const std::uint64_t pixels =
        static_cast<std::uint64_t>(def.width_px) * static_cast<std::uint64_t>(def.height_px);
    return pixels * static_cast<std::uint64_t>(bytes_per_pixel(format, def.encoder));
}

int jobs_that_fit(int wanted, std::uint64_t bytes) {
    const auto available = available_memory_bytes();
    if (!available) return wanted;
    return static_cast<int>(std::min(static_cast<std::uint64_t>(wanted), *available / bytes));
}

int jobs_of(int asked) {
    return asked > 0 ? asked : usable_cores();
}

}  // namespace corda::media
