#include "corda/media/animation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "corda/media/libav_encoder.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/palette.hpp"
#include "corda/media/track_output.hpp"
#include "corda/media/video_reader.hpp"

namespace corda::media {
namespace {

EncoderSettings no_settings(const Format& /*format*/, const VideoDef& /*def*/) {
    return {-99, {}, 0};
}

constexpr Codec kGif{"gif",       "gif", "GIF", {"pal8"}, {}, "", {}, 0, 1, 0, false, EncoderOrigin::kLibav,
                     &no_settings};
constexpr Codec kApng{"apng", "apng", "APNG", {"rgb24", "rgba"},     {},          "", {}, 0,
                      1,      0,      false,  EncoderOrigin::kLibav, &no_settings};

/// Calls visit(picture, has_alpha) for the first pictures of a part, in order.
template <typename Visit>
void for_each_picture(const std::string& part_path, std::int64_t frames, const OnProgress& on_progress,
                      Visit visit) {
    VideoReader reader(part_path);
    Image picture;
    for (std::int64_t k = 0; k < frames; ++k) {
        report_progress(on_progress, k, frames);
        if (!reader.read(picture))
            throw Error(ExitCode::kIo, fmt::format("'{}' changed while it was read", part_path));
        visit(picture, reader.has_alpha());
    }
}

/// The colours of a GIF, and how pictures get them.
class Colors {
  public:
    explicit Colors(Palette palette) : palette_(std::move(palette)) {}

    void convert(const Image& image, AVFrame& frame) {
        for (std::size_t i = 0; i < Palette::kSize; ++i) {
            const auto [b, g, r, a] = palette_.bgra(i);
            const std::array<std::uint8_t, 4> entry{b, g, r, a};
            std::copy(entry.begin(), entry.end(), frame.data[1] + 4 * i);
        }
        for (int y = 0; y < image.height(); ++y)
            palette_.map(image.pixel(0, y), image.width(),
                         frame.data[0] + std::ptrdiff_t{y} * frame.linesize[0]);
    }

  private:
    Palette palette_;
};

}  // namespace

void check_animation_frames(const Ending& ending, std::int64_t frames) {
    const std::string_view muxer = ending.muxer;
    if (frames != 1 || (muxer != "apng" && muxer != "webp")) return;
    throw Error(ExitCode::kUsage,
                fmt::format("{} holds one frame as a picture, which has no duration; use .gif, or .png "
                            "(corda still)",
                            ending.words));
}

void write_animation(const std::string& part_path, const Ending& ending, Rational fps, std::int64_t frames,
                     const OnProgress& on_progress, OutputFile& output) {
    check_animation_frames(ending, frames);
    const std::string_view muxer = ending.muxer;
    if (muxer == "webp") return write_webp(part_path, fps, frames, on_progress, output);
    const bool is_gif = muxer == "gif";
    bool has_alpha = false;
    PaletteMaker colors;
    VideoDef def;
    for_each_picture(part_path, is_gif ? frames : 1, on_progress,
                     [&](const Image& picture, bool is_see_through) {
                         has_alpha = is_see_through;
                         def.width_px = picture.width();
                         def.height_px = picture.height();
                         if (is_gif) colors.add(picture);
                     });
    def.fps = FrameRate(fps);
    const Format format{.ending = &ending,
                        .codec = is_gif ? &kGif : &kApng,
                        .pixel_format = is_gif      ? "pal8"
                                        : has_alpha ? "rgba"
                                                    : "rgb24",
                        .has_alpha = has_alpha};
    LibavEncoder::Convert convert = convert_pixels;
    if (is_gif) {
        convert = [gif = Colors(colors.make())](const Image& image, const PixelRect&,
                                                AVFrame& frame) mutable { gif.convert(image, frame); };
    }
    LibavEncoder encoder(format, def, std::move(convert));
    TrackOutput track(output.descriptor(), output.temporary_path());
    track.begin(ending.muxer, TrackLayout::kFinal, encoder.parameters(),
                {.fps = fps, .title = {}, .comment = {}});
    const auto write = [&track](AVPacket& packet) {
        packet.dts = packet.pts;
        track.write(packet);
    };
    for_each_picture(part_path, frames, on_progress,
                     [&](const Image& picture, bool) { encoder.encode(picture, {picture.rect()}, write); });
    encoder.drain(write);
    track.finish();
}

}  // namespace corda::media
