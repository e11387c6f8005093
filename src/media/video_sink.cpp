#include "corda/media/video_sink.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <string_view>

#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/part_file.hpp"
#include "corda/media/finish_part.hpp"
#include "corda/media/picture_names.hpp"

namespace corda::media {
namespace {

std::string_view bytes_of(const AVPacket& packet) {
    return {reinterpret_cast<const char*>(packet.data), static_cast<std::size_t>(packet.size)};
}

/// The part file of a video, of which it becomes the finished file.
class PartSink : public VideoSink {
  public:
    PartSink(const Format& format, const std::string& path, const OutputOptions& options)
        : format_(format),
          path_(path),
          options_(options),
          part_(PartFile::create(part_path(path), options)),
          track_(part_.descriptor(), part_.path()) {}
    PartSink(const PartSink&) = delete;
    PartSink& operator=(const PartSink&) = delete;
    /// A part without a chunk is of no use, and would be in the way of the next render.
    ~PartSink() override {
        if (part_.is_empty()) part_.remove();
    }

    void begin(const AVCodecParameters& parameters, const TrackInfo& info) override {
        track_.begin(format_.ending->part_muxer, TrackLayout::kPart, parameters, info);
    }
    void write(AVPacket& packet) override { track_.write(packet); }
    void end_chunk() override {
        track_.flush();
        part_.sync();
    }
    void drain() override { track_.finish(); }
    void finish(std::int64_t frames, VerifyDepth depth) override {
        try {
            finish_part(part_, path_, options_, frames, depth);
        } catch (const Error& error) {
            if (error.code() != ExitCode::kIo) throw;
            throw Error(error.code(),
                        fmt::format("{}; all frames are in '{}', which plays", error.what(), part_.path()));
        }
    }
    std::string abandon() override {
        part_.sync();
        return part_.path();
    }
    void remove() noexcept override { part_.remove(); }

  private:
    Format format_;
    std::string path_;
    OutputOptions options_;
    PartFile part_;
    TrackOutput track_;
};

/// A file for each frame, complete as soon as it has its name.
class PictureSink : public VideoSink {
  public:
    PictureSink(std::string pattern, OutputOptions options, std::int64_t first_frame)
        : pattern_(std::move(pattern)), options_(std::move(options)), first_frame_(first_frame) {
        const std::string folder = std::filesystem::path(pattern_).parent_path().string();
        if (!folder.empty()) make_folder(folder);
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
};

/// Standard output: YUV4MPEG2, or pixels without a header.
class StreamSink : public VideoSink {
  public:
    StreamSink(const Format& format, OutputOptions options) : format_(format), options_(std::move(options)) {}

    void begin(const AVCodecParameters& parameters, const TrackInfo& info) override {
        has_headers_ = std::string_view(format_.pixel_format) != "rgba";
        if (!has_headers_) return;
        const bool is_420 = std::string_view(format_.pixel_format) == "yuv420p";
        put(fmt::format("YUV4MPEG2 W{} H{} F{}:{} Ip A1:1 {} XCOLORRANGE=LIMITED\n", parameters.width,
                        parameters.height, info.fps.num, info.fps.den,
                        is_420 ? "C420mpeg2 XYSCSS=420MPEG2" : "C444 XYSCSS=444"));
    }
    void write(AVPacket& packet) override {
        if (has_headers_) put("FRAME\n");
        put(bytes_of(packet));
        av_packet_unref(&packet);
    }
    void end_chunk() override {}
    std::string abandon() override { return "standard output"; }

  private:
    void put(std::string_view bytes) const {
        const int status = write_all(STDOUT_FILENO, bytes, options_.on_progress);
        if (status == EPIPE) throw ReaderLeft();
        if (status != 0) fail_file("write to", "standard output", status);
    }

    Format format_;
    OutputOptions options_;
    bool has_headers_ = true;
};

}  // namespace

std::unique_ptr<VideoSink> make_sink(const Format& format, const std::string& path,
                                     const OutputOptions& options, std::int64_t first_frame) {
    switch (format.ending->kind) {
        case FileKind::kPictures:
            return std::make_unique<PictureSink>(path, options, first_frame);
        case FileKind::kStream:
            return std::make_unique<StreamSink>(format, options);
        case FileKind::kVideo:
        case FileKind::kAnimation:
            break;
    }
    return std::make_unique<PartSink>(format, path, options);
}

}  // namespace corda::media
