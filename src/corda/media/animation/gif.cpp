#include "corda/media/animation/gif.hpp"

#include <fcntl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"
#include "corda/media/encode/encoder.hpp"
#include "corda/media/encode/pixels.hpp"
#include "corda/media/write/track_output.hpp"

namespace corda::media {
namespace {

/// A file that is gone when it is closed: in a folder, or where the system keeps such files if the folder's
/// file system has none. Null with errno if there is none.
FileHandle unnamed_file(const std::string& folder) {
    const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    return FileHandle(descriptor < 0 ? std::tmpfile() : ::fdopen(descriptor, "w+b"));
}

/// A frame of colour numbers, all of them 0.
Frame indexed_frame(const VideoDef& def, const Palette& palette) {
    Frame frame = new_frame(AV_PIX_FMT_PAL8, def.width_px, def.height_px);
    for (std::size_t i = 0; i < Palette::kSize; ++i) {
        const std::array<std::uint8_t, 4> entry = palette.bgra(i);
        std::ranges::copy(entry, frame->data[1] + 4 * i);
    }
    return frame;
}

}  // namespace

GifWriter::GifWriter(const Format& format, const VideoDef& def, const std::string& folder)
    : format_(format),
      def_(def),
      folder_(folder.empty() ? "." : folder),
      last_(def.width_px, def.height_px),
      since_(last_.size_bytes() / 4),
      kept_(unnamed_file(folder_)) {
    if (!kept_) fail_file("make a temporary file in", folder_, errno);
}

void GifWriter::keep(const void* bytes, std::size_t count) {
    if (std::fwrite(bytes, 1, count, kept_.get()) != count)
        fail_file("write a temporary file in", folder_, errno);
}

void GifWriter::read(void* bytes, std::size_t count) {
    if (std::fread(bytes, 1, count, kept_.get()) != count)
        fail_file("read a temporary file in", folder_, errno);
}

void GifWriter::count_pixel(std::size_t index) {
    colors_.add(last_.data() + 4 * index, static_cast<std::uint64_t>(frames_ - since_[index]));
    since_[index] = static_cast<std::int32_t>(frames_);
}

void GifWriter::add_row(const std::uint8_t* row, int y, int x0, int x1) {
    constexpr std::ptrdiff_t kPixel = 4;  // bytes
    std::uint8_t* const before = last_.pixel(0, y);
    const auto differs = [&](int x) {
        return std::memcmp(row + kPixel * x, before + kPixel * x, kPixel) != 0;
    };
    for (int x = x0; x < x1; ++x) {
        if (frames_ > 0 && !differs(x)) continue;
        const int first = x;
        while (x < x1 && (frames_ == 0 || differs(x))) {
            if (frames_ > 0)
                count_pixel(static_cast<std::size_t>(y) * static_cast<std::size_t>(last_.width()) +
                            static_cast<std::size_t>(x));
            ++x;
        }
        const Run run{y, first, x - first};
        const std::size_t bytes = 4 * static_cast<std::size_t>(run.count);
        keep(&run, sizeof run);
        keep(row + kPixel * first, bytes);
        std::memcpy(before + kPixel * first, row + kPixel * first, bytes);
    }
}

void GifWriter::add(const ReadyFrame& frame) {
    const AVFrame& pixels = *frame.pixels;
    const Damage whole{last_.rect()};
    for (const PixelRect& part : frames_ == 0 ? whole : frame.changed) {
        const PixelRect inside = part.intersected(last_.rect());
        for (int y = inside.y0; y < inside.y1; ++y)
            add_row(pixels.data[0] + std::ptrdiff_t{y} * pixels.linesize[0], y, inside.x0, inside.x1);
    }
    const Run end{0, 0, 0};
    keep(&end, sizeof end);
    ++frames_;
}

void GifWriter::write(const OutputFile& output, const std::function<void(std::int64_t)>& on_frames) {
    for (std::size_t i = 0; i < since_.size(); ++i) count_pixel(i);
    Palette palette = colors_.make();
    Format indexed = format_;
    indexed.pixel_format = "pal8";
    LibavEncoder encoder(indexed, def_);
    TrackOutput track(
        output, format_.ending->muxer, encoder.parameters(),
        {.fps = def_.fps.rational(), .title = {}, .comment = {}, .frames = frames_, .loop = def_.loop});
    const auto take = [&track](AVPacket& packet) {
        packet.dts = packet.pts;
        track.write(packet);
    };
    Frame frame = indexed_frame(def_, palette);
    std::vector<std::uint8_t> pixels(4 * static_cast<std::size_t>(def_.width_px));
    if (std::fflush(kept_.get()) != 0) fail_file("write a temporary file in", folder_, errno);
    std::rewind(kept_.get());
    for (std::int64_t k = 0; k < frames_; ++k) {
        check_libav(av_frame_make_writable(frame.get()), ExitCode::kTemporary, "cannot copy a picture");
        for (Run run{}; read(&run, sizeof run), run.count > 0;) {
            read(pixels.data(), 4 * static_cast<std::size_t>(run.count));
            palette.map(pixels.data(), run.count, run.x, run.y,
                        frame->data[0] + std::ptrdiff_t{run.y} * frame->linesize[0] + run.x);
        }
        encoder.encode(check_allocated(Frame(av_frame_clone(frame.get())), "a frame"), {}, take);
        on_frames(k + 1);
        check_cancelled();
    }
    encoder.drain(take);
    track.finish();
}

}  // namespace corda::media
