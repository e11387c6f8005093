#include <cstdint>
#include <string>
#include <string_view>

#include "corda/media/animation/animation.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/libav_handles.hpp"

// Portable Network Graphics (PNG) Specification, third edition: 5.3 and 11.3.6, the chunks of animations.

namespace corda::media {
namespace {

std::string chunk(std::string_view type, std::string_view data) {
    std::string bytes;
    bytes += big_endian(data.size(), 4);
    bytes.append(type).append(data);
    const std::uint32_t crc =
        ~av_crc(av_crc_get_table(AV_CRC_32_IEEE_LE), ~0U,
                reinterpret_cast<const std::uint8_t*>(bytes.data()) + 4, bytes.size() - 4);
    bytes += big_endian(crc, 4);
    return bytes;
}

/// A frame, as far as it does not depend on those before.
struct ApngFrame {
    PixelRect part;
    bool is_blended = false;
    std::string head;  ///< what a PNG file of this picture has before its pixels, from the signature on
    std::string data;  ///< its compressed pixels
};

ApngFrame encode_apng(const PictureChange& change) {
    ApngFrame frame{change.part, change.is_blended, {}, {}};
    const std::string png = png_bytes(change.picture, {}, true);
    ByteReader bytes(png);
    static_cast<void>(bytes.skip(kPngSignature.size()));
    for (std::uint64_t at = bytes.position(); const auto chunk = next_png_chunk(bytes);
         at = bytes.position()) {
        const std::string data = bytes.take(chunk->length);
        if (chunk->type == "IDAT" && frame.head.empty()) frame.head = png.substr(0, at);
        if (chunk->type == "IDAT") frame.data += data;
        static_cast<void>(bytes.skip(PngChunk::kChecksumBytes));
    }
    return frame;
}

class ApngFile {
  public:
    ApngFile(const AnimationDef& def, OutputFile& output)
        : fps_(def.fps), frames_(def.frames), loop_(def.loop), output_(output) {}

    void write(const ApngFrame& frame) {
        if (written_++ == 0) {
            output_.write(frame.head + chunk("acTL", plays()) + control(frame) + chunk("IDAT", frame.data));
        } else {
            const std::string head = control(frame);
            output_.write(head + chunk("fdAT", big_endian(sequence_++, 4) + frame.data));
        }
    }
    void finish() {
        output_.write(chunk("IEND", {}));
        output_.flush();
    }

  private:
    [[nodiscard]] std::string plays() const {
        return big_endian(static_cast<std::uint64_t>(frames_), 4) +
               big_endian(static_cast<std::uint64_t>(loop_), 4);
    }
    /// Where and how long a frame is shown; it stays, under the next one.
    std::string control(const ApngFrame& frame) {
        std::string data = big_endian(sequence_++, 4);
        for (const int side : {frame.part.width(), frame.part.height(), frame.part.x0, frame.part.y0})
            data += big_endian(static_cast<std::uint64_t>(side), 4);
        data += big_endian(static_cast<std::uint64_t>(fps_.den), 2);
        data += big_endian(static_cast<std::uint64_t>(fps_.num), 2);
        data += big_endian(0, 1);
        data += big_endian(frame.is_blended ? 1 : 0, 1);
        return chunk("fcTL", data);
    }

    Rational fps_;
    std::int64_t frames_;
    int loop_;
    OutputFile& output_;
    std::int64_t written_ = 0;
    std::uint32_t sequence_ = 0;
};

}  // namespace

void write_apng(const Ending& /*ending*/, const AnimationDef& def, const OnProgress& on_progress,
                OutputFile& output) {
    ApngFile file(def, output);
    for_each_frame<ApngFrame>(
        def, on_progress, [](const LosslessFrames& pictures) { return encode_apng(pictures.change()); },
        [&file](const ApngFrame& frame) { file.write(frame); });
    file.finish();
}

}  // namespace corda::media
