#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "corda/media/animation/animation.hpp"
#include "corda/media/animation/palette.hpp"
#include "corda/media/chunks/track_output.hpp"
#include "corda/media/encode/encoder.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {
namespace {

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

using SharedColors = std::shared_ptr<Colors>;

std::unique_ptr<LibavEncoder> open_encoder(const Ending& ending, Rational fps, const Image& picture,
                                           const SharedColors& colors) {
    const Format format{.ending = &ending, .codec = find_codec("gif"), .pixel_format = "pal8"};
    VideoDef video;
    video.width_px = picture.width();
    video.height_px = picture.height();
    video.fps = FrameRate(fps);
    return std::make_unique<LibavEncoder>(
        format, video,
        [colors](const Image& image, const PixelRect&, AVFrame& frame) { colors->convert(image, frame); });
}

/// Encodes sections of the frames.
class SectionEncoder {
  public:
    SectionEncoder(const Ending& ending, const AnimationDef& def, const Palette& palette)
        : ending_(&ending),
          fps_(def.fps),
          pictures_(def.chunks),
          colors_(std::make_shared<Colors>(palette)) {}

    [[nodiscard]] std::vector<Packet> encode(std::int64_t first, std::int64_t end,
                                             const OrderedWorkers<std::vector<Packet>>& all) {
        std::vector<Packet> packets;
        std::unique_ptr<LibavEncoder> encoder;
        // A frame is encoded as its changes since the frame before.
        for (std::int64_t k = std::max<std::int64_t>(first - 1, 0); k < end && !all.is_stopped(); ++k) {
            if (k != last_) pictures_.go_to(k);
            last_ = k;
            const Image& picture = pictures_.picture();
            if (!encoder) encoder = open_encoder(*ending_, fps_, picture, colors_);
            encoder->encode(picture, {picture.rect()}, [&](AVPacket& packet) {
                if (k < first) return av_packet_unref(&packet);
                packet.pts = packet.dts = k;
                packets.push_back(check_allocated(Packet(av_packet_alloc()), "a packet"));
                av_packet_move_ref(packets.back().get(), &packet);
            });
        }
        return packets;
    }

  private:
    const Ending* ending_;
    Rational fps_;
    LosslessFrames pictures_;
    SharedColors colors_;
    std::int64_t last_ = -1;
};

Palette choose_palette(const AnimationDef& def, const OnProgress& on_progress) {
    PaletteMaker all;
    const auto new_maker = [&def] {
        return [pictures = std::make_shared<LosslessFrames>(def.chunks)](
                   std::int64_t first, std::int64_t end, const OrderedWorkers<PaletteMaker>& every) {
            PaletteMaker colors;
            for (std::int64_t k = first; k < end && !every.is_stopped(); ++k) {
                pictures->go_to(k);
                colors.add(pictures->picture());
            }
            return colors;
        };
    };
    for_each_section<PaletteMaker>(def, on_progress, new_maker,
                                   [&all](const PaletteMaker& colors) { all.add(colors); });
    return all.make();
}

}  // namespace

void write_gif(const Ending& ending, const AnimationDef& def, const OnProgress& on_progress,
               OutputFile& output) {
    // The palette is the first half of the work.
    const auto half = [&](std::int64_t begin) {
        return [&, begin](std::int64_t k, std::int64_t all) {
            return !on_progress || on_progress(begin + k / 2, all);
        };
    };
    const Palette palette = choose_palette(def, half(0));
    LosslessFrames pictures(def.chunks);
    pictures.go_to(0);
    TrackOutput track(
        output, ending.muxer,
        open_encoder(ending, def.fps, pictures.picture(), std::make_shared<Colors>(palette))->parameters(),
        {.fps = def.fps, .title = {}, .comment = {}, .frames = def.frames, .loop = def.loop});
    using Packets = std::vector<Packet>;
    const auto new_maker = [&] {
        return [encoder = std::make_shared<SectionEncoder>(ending, def, palette)](
                   std::int64_t first, std::int64_t end, const OrderedWorkers<Packets>& all) {
            return encoder->encode(first, end, all);
        };
    };
    for_each_section<Packets>(def, half(def.frames / 2), new_maker, [&track](const Packets& packets) {
        for (const Packet& packet : packets) track.write(*packet);
    });
    track.finish();
}

}  // namespace corda::media
