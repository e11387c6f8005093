#include "corda/media/read/stored_video.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/read/containers.hpp"
#include "corda/media/read/video_reader.hpp"
#include "corda/media/read/webp_reader.hpp"

namespace corda::media {

/// libav reads all but animated WebP.
struct StoredVideo::Impl {
    std::string path;
    Rational rate{0, 1};
    std::optional<VideoReader> video;
    std::optional<WebpReader> webp;
    std::optional<Rational> delay_s;  ///< of every frame of an APNG that has one delay
    std::int64_t frames = 0;          ///< that were read of it
};

StoredVideo::StoredVideo(const std::string& path) : impl_(std::make_unique<Impl>()) {
    impl_->path = path;
    const std::string kind = file_kind(path);
    if (is_truncated(path, kind) || (kind == "mov" && !read_mp4_boxes(path).whole))
        throw Error(ExitCode::kIo,
                    fmt::format("'{}' breaks off before its end; copy or render it again", path));
    if (kind == "webp") {
        impl_->webp.emplace(path);
        if (!impl_->webp->is_open())
            throw Error(ExitCode::kIo, fmt::format("libwebp cannot open '{}' as an animated WebP", path));
        if (const auto rate = rate_of_ms(impl_->webp->told_ends_ms())) impl_->rate = *rate;
        return;
    }
    impl_->video.emplace(path);
    impl_->rate = impl_->video->rate();
    if (kind != "apng") return;  // whose delays libav rounds
    const ApngTimes times = read_apng_times(path);
    if (times.delay_s.num <= 0) return;
    impl_->rate = {times.delay_s.den, times.delay_s.num};
    if (times.uneven_at < 0) impl_->delay_s = times.delay_s;
}

StoredVideo::~StoredVideo() = default;

Rational StoredVideo::rate() const {
    return impl_->rate;
}

bool StoredVideo::read(StoredPicture& picture) {
    if (impl_->video) {
        if (!impl_->video->read(picture)) return false;
        if (const auto& delay = impl_->delay_s)  // libav's stamps, of rounded delays, drift
            picture.time_s =
                static_cast<double>(impl_->frames++ * delay->num) / static_cast<double>(delay->den);
        return true;
    }
    WebpReader& webp = *impl_->webp;
    if (!webp.has_next()) return false;
    const std::int64_t start_ms = webp.read_ends_ms().empty() ? 0 : webp.read_ends_ms().back();
    const std::uint8_t* const rgba = webp.read();
    if (rgba == nullptr) throw Error(ExitCode::kIo, fmt::format("{}: decoding failed", impl_->path));
    picture = StoredPicture{};
    picture.width_px = webp.width_px();
    picture.height_px = webp.height_px();
    picture.format = "rgba";
    picture.time_s = static_cast<double>(start_ms) / 1000.0;
    picture.components = 4;
    picture.is_rgb = true;
    picture.is_full_range = true;
    const std::size_t pixels = static_cast<std::size_t>(picture.width_px) * picture.height_px;
    picture.samples.resize(4 * pixels);
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < 4; ++c) picture.samples[c * pixels + i] = rgba[4 * i + c];
    return true;
}

Image StoredPicture::rgba() const {
    Image image(width_px, height_px);
    const auto pixels = static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
    const double largest = static_cast<double>((1 << bits) - 1);
    const double step = static_cast<double>(1 << (bits - 8));  // of 8-bit levels
    const auto byte = [](double value) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255.0));
    };
    for (int y = 0; y < height_px; ++y) {
        for (int x = 0; x < width_px; ++x) {
            const auto sample = [&](int c, int shift_x, int shift_y) -> double {
                const std::size_t width = static_cast<std::size_t>(ceiling_shift(width_px, shift_x));
                return samples[static_cast<std::size_t>(c) * pixels +
                               static_cast<std::size_t>(y >> shift_y) * width +
                               static_cast<std::size_t>(x >> shift_x)];
            };
            std::uint8_t* const rgba = image.pixel(x, y);
            rgba[3] = components == 4 ? byte(sample(3, 0, 0) / largest) : 255;
            if (is_rgb) {
                for (int c = 0; c < 3; ++c) rgba[c] = byte(sample(c, 0, 0) / largest);
                continue;
            }
            const double luma =
                is_full_range ? sample(0, 0, 0) / largest : (sample(0, 0, 0) / step - 16.0) / 219.0;
            const auto chroma = [&](int c) {
                if (components < 3) return 0.0;
                const double level = sample(c, chroma_shift_x, chroma_shift_y) / step - 128.0;
                return level / (is_full_range ? 255.0 : 224.0);
            };
            const double blue = chroma(1);
            const double red = chroma(2);
            rgba[0] = byte(luma + 1.5748 * red);
            rgba[1] = byte(luma - 0.1873243 * blue - 0.4681243 * red);
            rgba[2] = byte(luma + 1.8556 * blue);
        }
    }
    return image;
}

}  // namespace corda::media
