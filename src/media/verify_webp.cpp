#include <webp/decode.h>
#include <webp/demux.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/file.hpp"
#include "corda/core/image.hpp"
#include "corda/media/color_patch.hpp"
#include "corda/media/verify_decode.hpp"

namespace corda::media {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 31;

using Decoder = std::unique_ptr<WebPAnimDecoder, decltype(&WebPAnimDecoderDelete)>;

std::string all_of(const std::string& path) {
    const FileHandle file = open_for_reading(path);
    std::string all;
    std::array<char, 1 << 16> piece{};
    for (std::size_t count = 1; count > 0 && all.size() < kMostBytes;) {
        count = std::fread(piece.data(), 1, piece.size(), file.get());
        all.append(piece.data(), count);
    }
    return all;
}

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

bool fits(Rational fps, const std::vector<std::int64_t>& ends_ms) {
    std::int64_t k = 0;
    return std::all_of(ends_ms.begin(), ends_ms.end(), [&](std::int64_t end) {
        ++k;
        return (std::int64_t{2000} * k * fps.den + fps.num) / (2 * fps.num) == end;
    });
}

/// The fraction of smallest denominator that fits.
std::optional<Rational> simplest_rate(const std::vector<std::int64_t>& ends_ms) {
    constexpr std::int64_t kLargestDenominator = 10'000;
    double low = 0.0;  // that fitting rates are above, and those up to which they are
    double high = 2000.0;
    for (std::size_t i = 0; i < ends_ms.size(); ++i) {
        const double frames = 2000.0 * static_cast<double>(i + 1);
        const double twice_end = 2.0 * static_cast<double>(ends_ms[i]);
        low = std::max(low, frames / (twice_end + 1.0));
        if (twice_end > 0.0) high = std::min(high, frames / (twice_end - 1.0));
    }
    for (std::int64_t den = 1; den <= kLargestDenominator; ++den) {
        const auto num = static_cast<std::int64_t>(std::floor(high * static_cast<double>(den)));
        if (num > 0 && static_cast<double>(num) > low * static_cast<double>(den) && fits({num, den}, ends_ms))
            return Rational{num, den};
    }
    return std::nullopt;
}

}  // namespace

std::optional<Rational> rate_of_ms(const std::vector<std::int64_t>& ends_ms, std::optional<Rational> told) {
    if (ends_ms.empty() || ends_ms.back() <= 0) return std::nullopt;
    if (told && fits(*told, ends_ms)) return told;
    for (const Rational usual :
         {Rational{60, 1}, Rational{30, 1}, Rational{25, 1}, Rational{24, 1}, Rational{50, 1},
          Rational{30000, 1001}, Rational{24000, 1001}, Rational{60000, 1001}})
        if (fits(usual, ends_ms)) return usual;
    const Rational mean = Rational::reduced(1000 * std::ssize(ends_ms), ends_ms.back());
    return mean.den == 1 && fits(mean, ends_ms) ? mean : simplest_rate(ends_ms);
}

DecodedVideo decode_webp(const std::string& path, std::optional<Rational> told,
                         const std::vector<FrameColors>& rendered, const OnProgress& on_progress) {
    DecodedVideo video;
    const std::string bytes = all_of(path);
    const WebPData data{reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
    WebPAnimDecoderOptions options{};
    WebPAnimDecoderOptionsInit(&options);
    options.color_mode = MODE_RGBA;
    WebPAnimInfo info{};
    const Decoder decoder(WebPAnimDecoderNew(&data, &options), &WebPAnimDecoderDelete);
    video.opened = decoder && WebPAnimDecoderGetInfo(decoder.get(), &info) != 0 &&
                   is_picture_size(info.canvas_width, info.canvas_height);
    if (!video.opened) {
        video.open_reason = "libwebp does not open the file";
        return video;
    }
    video.codec = "webp";
    video.pixel_format = "rgba";
    video.width_px = static_cast<int>(info.canvas_width);
    video.height_px = static_cast<int>(info.canvas_height);
    video.is_rounded = true;
    const std::size_t pixels = std::size_t{info.canvas_width} * info.canvas_height;
    std::vector<std::int64_t> ends_ms;
    std::uint8_t* rgba = nullptr;
    int end_ms = 0;
    while (WebPAnimDecoderHasMoreFrames(decoder.get()) != 0) {
        report_progress(on_progress, video.frames, 0);
        if (WebPAnimDecoderGetNext(decoder.get(), &rgba, &end_ms) == 0) {
            video.bad_reason = "libwebp does not decode a frame";
            ++video.bad_frames;
            break;
        }
        if (const FrameColors* const colors = find_rendered(rendered, video.frames))
            for (const ColorPatch& patch : colors->patches)
                if (is_within(patch, video.width_px, video.height_px))
                    video.patches.push_back({video.frames, patch, mean_rgb(rgba, video.width_px, patch)});
        if (video.frames++ == 0) video.has_alpha = is_see_through(rgba, pixels);
        ends_ms.push_back(end_ms);
    }
    video.step = 1;
    video.end = video.frames;
    const auto fps = rate_of_ms(ends_ms, told);
    if (fps) {
        video.tick = {fps->den, fps->num};
    } else {
        video.uneven_at = 1;
    }
    return video;
}

}  // namespace corda::media
