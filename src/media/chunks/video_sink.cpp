#include "corda/media/chunks/video_sink.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/part_file.hpp"
#include "corda/core/range_lock.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/chunks/finish_part.hpp"
#include "corda/media/chunks/part_reader.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/read/decoder.hpp"

namespace corda::media {
namespace {

std::string_view bytes_of(const AVPacket& packet) {
    return {reinterpret_cast<const char*>(packet.data), static_cast<std::size_t>(packet.size)};
}

/// Puts the lengths of NAL units in place of the start codes before them, as a track of MP4 has them: what
/// the muxer does by itself if the header came from the encoder, not from a file. (ISO/IEC 14496-10, annex B;
/// 14496-15, 5.3.)
void put_lengths(AVPacket& packet) {
    const std::string_view bytes = bytes_of(packet);
    constexpr std::string_view kStartCode("\0\0\1", 3);
    std::string units;
    for (std::size_t at = bytes.find(kStartCode); at != std::string_view::npos;) {
        const std::size_t begin = at + kStartCode.size();
        at = bytes.find(kStartCode, begin);
        std::string_view unit = bytes.substr(begin, at == std::string_view::npos ? at : at - begin);
        if (at != std::string_view::npos && unit.ends_with('\0'))
            unit.remove_suffix(1);  // of a code of four bytes
        units += big_endian(unit.size(), 4);
        units += unit;
    }
    Packet changed = check_allocated(Packet(av_packet_alloc()), "a packet");
    check_libav(av_new_packet(changed.get(), static_cast<int>(units.size())), ExitCode::kIo, "a packet");
    std::copy(units.begin(), units.end(), changed->data);
    check_libav(av_packet_copy_props(changed.get(), &packet), ExitCode::kIo, "a packet");
    av_packet_unref(&packet);
    av_packet_move_ref(&packet, changed.get());
}

/// The part file of a video, of which it becomes the finished file.
class PartSink : public VideoSink {
  public:
    PartSink(const Format& format, const std::string& path, const OutputOptions& options)
        : PartSink(format, path, options, PartFile::create(part_path(path), options)) {}
    /// Goes on with `old`, an earlier part: its whole chunks are copied into a new one, which takes its
    /// place.
    PartSink(const Format& format, const std::string& path, const OutputOptions& options, PartFile old,
             const FrameRange& frames)
        : PartSink(format, path, options, create_copy(part_path(path))) {
        try {
            resumed_ = copy_chunks(old.path(), frames);
            if (resumed_ > 0) part_.sync();
        } catch (const Error& error) {
            if (error.code() != ExitCode::kIo) throw;
            throw Error(error.code(), fmt::format("{}; '{}' stays as it is: to resume it, it is first copied "
                                                  "to '{}', which needs as much space again",
                                                  error.what(), old.path(), part_.path()));
        }
        has_chunk_ = resumed_ > 0;
        part_.take_place_of(old);
    }
    PartSink(const PartSink&) = delete;
    PartSink& operator=(const PartSink&) = delete;
    /// Removes a part without a chunk, which is of no use and would make the next render fail.
    ~PartSink() override {
        if (!has_chunk_) part_.remove();
    }

    [[nodiscard]] std::int64_t resumed_frames() const override { return resumed_; }
    [[nodiscard]] bool was_part_damaged() const override { return was_damaged_; }
    void begin(const AVCodecParameters& parameters, const TrackInfo& info) override {
        track_.begin(format_.ending->part_muxer, parameters, info);
    }
    void write(AVPacket& packet) override {
        telling_what_is_kept("the frames before are", [&] {
            if (has_lengths_) put_lengths(packet);
            track_.write(packet);
        });
    }
    void end_chunk() override {
        telling_what_is_kept("the frames before are", [&] {
            track_.flush();
            part_.sync();
        });
        has_chunk_ = true;
    }
    void drain() override {
        telling_what_is_kept("the frames before are", [&] { track_.finish(); });
    }
    void finish(const FinishDef& def) override {
        telling_what_is_kept("all frames are", [&] { finish_part(part_, path_, options_, def); });
    }
    std::string abandon() override {
        part_.sync();
        return part_.path();
    }
    void remove() noexcept override { part_.remove(); }

  private:
    PartSink(const Format& format, const std::string& path, const OutputOptions& options, PartFile part)
        : format_(format),
          path_(path),
          options_(options),
          part_(std::move(part)),
          track_(part_.descriptor(), part_path(path), TrackLayout::kPart) {}

    /// Makes the file that a part is copied to.
    static PartFile create_copy(const std::string& part) {
        const std::string copy = part_copy_path(part);
        std::error_code ignored;
        if (std::filesystem::exists(copy, ignored))
            throw Error(
                ExitCode::kIo,
                fmt::format("'{}' is in the way: to resume '{}', it is first copied there; move it away",
                            copy, part));
        return PartFile::create(copy, {});
    }

    /// Adds to a failure to write where the frames are that were written before it.
    template <class Work>
    void telling_what_is_kept(const char* which, const Work& work) {
        try {
            work();
        } catch (const Error& error) {
            if (error.code() != ExitCode::kIo || (part_.is_named() && !has_chunk_)) throw;
            std::error_code ignored;
            const bool is_taken = !options_.force && std::filesystem::exists(path_, ignored);
            const std::string kept =
                part_.is_named()
                    ? fmt::format("{} in '{}', which plays; --resume{} continues it", which, part_.path(),
                                  is_taken ? " --force" : "")
                    : fmt::format("'{}' was removed meanwhile, and its frames with it", part_.path());
            throw Error(error.code(), fmt::format("{}; {}", error.what(), kept));
        }
    }

    /// Copies the whole chunks of an earlier part; returns their frames.
    std::int64_t copy_chunks(const std::string& old, const FrameRange& frames) {
        const LogCapture log;
        PartIndex index;
        try {
            index = index_part(old);
        } catch (const EmptyPart&) {
            return 0;
        }
        was_damaged_ = index.is_damaged;
        const std::int64_t there = std::min(std::ssize(index.frame_of), frames.end - frames.first);
        const auto is_whole = [&](std::int64_t count) {
            return (frames.first + count) % frames.per_chunk == 0 || count == frames.end - frames.first;
        };
        std::int64_t whole = there;
        while (whole > 0 && !is_whole(whole)) --whole;
        if (whole == 0) return 0;
        const PartInput input = open_part(old, index.bytes);
        const AVCodecParameters& parameters = *input.stream->codecpar;
        begin(parameters, {.fps = index.fps,
                           .title = metadata_entry(*input.format, "title"),
                           .comment = metadata_entry(*input.format, "comment"),
                           .has_alpha = is_marked_as_alpha(*input.stream)});
        const bool has_nal_units =
            parameters.codec_id == AV_CODEC_ID_H264 || parameters.codec_id == AV_CODEC_ID_HEVC;
        has_lengths_ = has_nal_units && parameters.extradata_size > 0 && parameters.extradata[0] == 1;
        PacketCopy copy(old, input, index);
        for (std::int64_t count = 1; count <= whole; ++count) {
            if (!is_whole(count)) continue;
            copy.copy_to(static_cast<std::size_t>(count), track_);
            track_.flush();
        }
        return whole;
    }

    Format format_;
    std::string path_;
    OutputOptions options_;
    PartFile part_;
    TrackOutput track_;
    std::int64_t resumed_ = 0;
    bool was_damaged_ = false;
    bool has_chunk_ = false;    ///< a whole one, on the disk
    bool has_lengths_ = false;  ///< whether the track's packets have lengths in place of start codes
};

/// A file for each frame, complete as soon as it has its name.
class PictureSink : public VideoSink {
  public:
    PictureSink(std::string pattern, OutputOptions options, const FrameRange& frames)
        : pattern_(std::move(pattern)), options_(options), first_frame_(frames.first) {
        const std::filesystem::path path(pattern_);
        const std::string folder = path.parent_path().string();
        if (!folder.empty()) make_folder(folder);
        const std::filesystem::path lock_file =
            path.parent_path() / ("." + path.filename().string() + ".lock");
        lock_.emplace(lock_file.string(), frames.first, frames.end, fmt::format("frames of '{}'", pattern_));
        remove_leftovers(folder.empty() ? "." : folder,
                         [this](const std::string& name) { return is_picture_name(pattern_, name); });
    }

    void begin(const AVCodecParameters& /*parameters*/, const TrackInfo& /*info*/) override {}
    void write(AVPacket& packet) override {
        OutputFile file(picture_name(pattern_, first_frame_ + packet.pts), {.force = options_.force});
        file.write(bytes_of(packet));
        file.commit();
        av_packet_unref(&packet);
    }
    void end_chunk() override {}
    std::string abandon() override { return pattern_; }

  private:
    std::string pattern_;
    OutputOptions options_;
    std::int64_t first_frame_;
    std::optional<RangeLock> lock_;
};

/// Standard output: YUV4MPEG2, or pixels without a header.
class StreamSink : public VideoSink {
  public:
    explicit StreamSink(const Format& format) : format_(format) {}

    void begin(const AVCodecParameters& parameters, const TrackInfo& info) override {
        has_headers_ = std::string_view(format_.pixel_format) != "rgba";
        if (!has_headers_) return;
        const bool is_420 = std::string_view(format_.pixel_format) == "yuv420p";
        put(fmt::format("YUV4MPEG2 W{} H{} F{}:{} Ip A1:1 {} XCOLORRANGE=LIMITED\n", parameters.width,
                        parameters.height, info.fps.num, info.fps.den,
                        is_420 ? "C420mpeg2 XYSCSS=420MPEG2" : "C444 XYSCSS=444"));
    }
    void write(AVPacket& packet) override {
        is_cut_ = true;
        if (has_headers_) put("FRAME\n");
        put(bytes_of(packet));
        is_cut_ = false;
        av_packet_unref(&packet);
    }
    void end_chunk() override {}
    std::string abandon() override {
        return is_cut_ ? "standard output, perhaps with a part of the next one" : "standard output";
    }

  private:
    void put(std::string_view bytes) const {
        const int status = write_all(STDOUT_FILENO, bytes);
        if (status == EPIPE) throw ReaderLeft();
        if (status != 0) fail_file("write to", "standard output", status);
    }

    Format format_;
    bool has_headers_ = true;
    bool is_cut_ = false;  ///< the last frame, or that may be
};

}  // namespace

std::unique_ptr<VideoSink> make_sink(const Format& format, const std::string& path,
                                     const OutputOptions& options, const FrameRange& frames, bool resume) {
    switch (format.ending->kind) {
        case FileKind::kPictures:
            return std::make_unique<PictureSink>(path, options, frames);
        case FileKind::kStream:
            return std::make_unique<StreamSink>(format);
        case FileKind::kVideo:
        case FileKind::kAnimation:
            break;
    }
    std::error_code ignored;
    remove_part_copy(part_path(path));
    if (!resume || !std::filesystem::exists(part_path(path), ignored))
        return std::make_unique<PartSink>(format, path, options);
    PartFile old = PartFile::open(part_path(path));
    if (old.is_empty()) {
        old.remove();
        return std::make_unique<PartSink>(format, path, options);
    }
    return std::make_unique<PartSink>(format, path, options, std::move(old), frames);
}

}  // namespace corda::media
