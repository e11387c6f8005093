#include "corda/media/encode/resources.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "corda/core/machine.hpp"
#include "corda/core/text.hpp"

namespace corda::media {
namespace {

constexpr double kMegabyte = 1e6;

/// Free bytes on the disk of an output; std::nullopt if the system does not state them.
std::optional<std::uint64_t> free_disk_bytes(const std::string& path) {
    std::filesystem::path folder = std::filesystem::path(path).parent_path();
    std::error_code failure;
    // One that is still to be made is on the disk of the folder above it.
    while (!folder.empty() && !std::filesystem::exists(folder, failure)) folder = folder.parent_path();
    const std::filesystem::space_info space = std::filesystem::space(folder.empty() ? "." : folder, failure);
    // Some file systems that are no disks state 0 bytes.
    if (failure || space.capacity == 0) return std::nullopt;
    return space.available;
}

}  // namespace

std::uint64_t bytes_per_job(const Format& format, const VideoDef& def) {
    const Codec& codec = *format.codec;
    int bytes = codec.job_bytes;
    for (std::size_t i = 0; i < codec.preset_job_bytes.size(); ++i)
        if (format.preset_of(def.encoder) == codec.presets[i]) bytes = codec.preset_job_bytes[i];
    return static_cast<std::uint64_t>(def.width_px) * static_cast<std::uint64_t>(def.height_px) *
           static_cast<std::uint64_t>(bytes);
}

int jobs_that_fit(int wanted, std::uint64_t bytes) {
    const auto available = available_memory_bytes();
    if (!available) return wanted;
    return static_cast<int>(std::min(static_cast<std::uint64_t>(wanted), *available / bytes));
}

int jobs_of(int asked) {
    return asked > 0 ? asked : usable_cores();
}

DiskNeed disk_need(const Format& format, const VideoDef& def, std::int64_t frames) {
    if (format.ending->kind == FileKind::kStream) return {};
    const DiskBytes& bytes = format.codec->disk_bytes;
    // The smaller a picture, the larger the share of its pixels that lines cover.
    constexpr double kMeasuredPixels = 640.0 * 360.0;
    const double pixels = static_cast<double>(def.width_px) * def.height_px;
    const double usual_pixels = kMeasuredPixels * std::pow(pixels / kMeasuredPixels, 0.75);
    const double copies = format.ending->kind == FileKind::kPictures ? 1.0 : 2.0;
    const double pictures = copies * static_cast<double>(frames);
    return {static_cast<std::uint64_t>(pictures * bytes.min * pixels),
            static_cast<std::uint64_t>(pictures * bytes.usual * usual_pixels)};
}

void check_disk_space(const Format& format, const std::string& path, const VideoDef& def, std::int64_t frames,
                      std::uint64_t there) {
    const DiskNeed need = disk_need(format, def, frames);
    const auto free = free_disk_bytes(path);
    if (!free || need.least <= *free + there) return;
    throw_error(ExitCode::kIo,
                "'{}' does not fit on its disk: {} frames of {}x{} as {} take {:.3g} MB at least while it is "
                "made, and {:.3g} are free; free some space, or write to another disk",
                path, frames, def.width_px, def.height_px, format.words(),
                static_cast<double>(need.least) / kMegabyte, static_cast<double>(*free) / kMegabyte);
}

std::string disk_warning(const Format& format, const std::string& path, const VideoDef& def,
                         std::int64_t frames) {
    const DiskNeed need = disk_need(format, def, frames);
    const auto free = free_disk_bytes(path);
    if (!free || need.usual <= *free) return {};
    return fmt::format(
        "{} may not fit on its disk: such videos take some {:.3g} MB while they are made, and "
        "{:.3g} are free",
        path, static_cast<double>(need.usual) / kMegabyte, static_cast<double>(*free) / kMegabyte);
}

}  // namespace corda::media
