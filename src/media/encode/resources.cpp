#include "corda/media/encode/resources.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <span>
#include <string_view>
#include <utility>

#include "corda/core/basics.hpp"
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

namespace {

/// Measured bytes per pixel of a frame. `least` is at most half of what two links on a black ground take at
/// 3840x2160; `usual` is the median of the 17 examples at 640x360, which take from 0.4 to 16 times as much.
/// The figures of libaom-av1 and h264_nvenc are those of their like, and PNG's least is that of APNG: not
/// measured.
struct DiskBytes {
    std::string_view name;
    double least;
    double usual;
};

constexpr std::array kDiskTable{DiskBytes{"libx264", 1e-4, 0.0035},    DiskBytes{"libx265", 9e-5, 0.0028},
                                DiskBytes{"libsvtav1", 4e-5, 0.0023},  DiskBytes{"libaom-av1", 4e-5, 0.0023},
                                DiskBytes{"libvpx-vp9", 4e-5, 0.0026}, DiskBytes{"prores_ks", 0.01, 0.31},
                                DiskBytes{"ffv1", 0.0015, 0.16},       DiskBytes{"gif", 2e-4, 0.016},
                                DiskBytes{"apng", 0.001, 0.034},       DiskBytes{"webp", 8e-4, 0.027},
                                DiskBytes{"png", 0.001, 0.053},        DiskBytes{"h264_nvenc", 4e-5, 0.0035}};

constexpr double kMegabyte = 1e6;

}  // namespace

DiskNeed disk_need(const Format& format, const VideoDef& def, std::int64_t frames) {
    if (format.ending->kind == FileKind::kStream) return {};
    const std::string name = format.encoder_name();
    const auto* const row = std::find_if(kDiskTable.begin(), kDiskTable.end(),
                                         [&name](const DiskBytes& each) { return each.name == name; });
    if (row == kDiskTable.end()) return {};
    // The smaller a picture, the larger the share of its pixels that lines cover.
    constexpr double kMeasuredPixels = 640.0 * 360.0;
    const double pixels = static_cast<double>(def.width_px) * def.height_px;
    const double usual_pixels = kMeasuredPixels * std::pow(pixels / kMeasuredPixels, 0.75);
    const double copies = format.ending->kind == FileKind::kPictures ? 1.0 : 2.0;
    const double pictures = copies * static_cast<double>(frames);
    return {static_cast<std::uint64_t>(pictures * row->least * pixels),
            static_cast<std::uint64_t>(pictures * row->usual * usual_pixels)};
}

std::optional<std::uint64_t> free_disk_bytes(const std::string& path) {
    std::filesystem::path folder = std::filesystem::path(path).parent_path();
    std::error_code failure;
    // One that is still to be made is on the disk of the folder above it.
    while (!folder.empty() && !std::filesystem::exists(folder, failure)) folder = folder.parent_path();
    const std::filesystem::space_info space = std::filesystem::space(folder.empty() ? "." : folder, failure);
    // Some file systems that are no disks tell 0 of all.
    if (failure || space.capacity == 0) return std::nullopt;
    return space.available;
}

void check_disk_space(const Format& format, const std::string& path, const VideoDef& def, std::int64_t frames,
                      std::uint64_t there) {
    const DiskNeed need = disk_need(format, def, frames);
    const auto free = free_disk_bytes(path);
    if (!free || need.least <= *free + there) return;
    throw Error(
        ExitCode::kIo,
        fmt::format("'{}' does not fit onto its disk: {} frames of {}x{} as {} take {:.3g} MB at least "
                    "while it is made, and {:.3g} are free; free some space, or write to another disk",
                    path, frames, def.width_px, def.height_px, format.words(),
                    static_cast<double>(need.least) / kMegabyte, static_cast<double>(*free) / kMegabyte));
}

std::string disk_warning(const Format& format, const std::string& path, const VideoDef& def,
                         std::int64_t frames) {
    const DiskNeed need = disk_need(format, def, frames);
    const auto free = free_disk_bytes(path);
    if (!free || need.usual <= *free) return {};
    return fmt::format(
        "{} may not fit onto its disk: such videos take some {:.3g} MB while they are made, and "
        "{:.3g} are free",
        path, static_cast<double>(need.usual) / kMegabyte, static_cast<double>(*free) / kMegabyte);
}

}  // namespace corda::media
