#include <array>
#include <optional>
#include <string>
#include <vector>

#include "corda/media/animation/webp_reader.hpp"
#include "corda/media/read/color_patch.hpp"
#include "corda/media/verify/decode.hpp"

namespace corda::media {
namespace {

bool is_see_through(const std::uint8_t* rgba, std::size_t pixels) {
    for (std::size_t i = 0; i < pixels; ++i)
        if (rgba[4 * i + 3] < 255) return true;
    return false;
}

/// Mean R'G'B' of a patch that lies within a picture of RGBA.
std::array<double, 3> mean_rgb(const std::uint8_t* rgba, int width_px, const ColorPatch& patch) {
    std::array<double, 3> mean{};
    for (int i = 0; i < kPatchSide * kPatchSide; ++i) {
        const int x = patch.x + i % kPatchSide;
        const int y = patch.y + i / kPatchSide;
        const std::uint8_t* const pixel = rgba + 4 * (std::ptrdiff_t{y} * width_px + x);
        for (std::size_t c = 0; c < mean.size(); ++c) mean[c] += pixel[c];
    }
    for (double& channel : mean) channel /= kPatchSide * kPatchSide;
    return mean;
}

}  // namespace

DecodedVideo decode_webp(const std::string& path, std::optional<Rational> told,
                         const std::vector<FrameColors>& rendered, const OnProgress& on_progress) {
    DecodedVideo video;
    WebpReader reader(path);
    video.opened = reader.is_open();
    if (!video.opened) {
        video.open_reason = "libwebp does not open the file";
        return video;
    }
    video.codec = "webp";
    video.pixel_format = "rgba";
    video.width_px = reader.width_px();
    video.height_px = reader.height_px();
    video.is_rounded = true;
    const std::size_t pixels = static_cast<std::size_t>(video.width_px) * video.height_px;
    while (reader.has_next()) {
        report_progress(on_progress, video.frames, 0);
        const std::uint8_t* const rgba = reader.read();
        if (rgba == nullptr) {
            video.bad_reason = "libwebp does not decode a frame";
            ++video.bad_frames;
            break;
        }
        if (const FrameColors* const colors = find_rendered(rendered, video.frames))
            for (const ColorPatch& patch : colors->patches)
                if (is_within(patch, video.width_px, video.height_px))
                    video.patches.push_back({video.frames, patch, mean_rgb(rgba, video.width_px, patch)});
        if (video.frames++ == 0) video.has_alpha = is_see_through(rgba, pixels);
    }
    video.step = 1;
    video.end = video.frames;
    const auto fps = rate_of_ms(reader.read_ends_ms(), told);
    if (fps) {
        video.tick = {fps->den, fps->num};
    } else {
        video.uneven_at = 1;
    }
    return video;
}

}  // namespace corda::media
