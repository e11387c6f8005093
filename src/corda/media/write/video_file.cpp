#include "corda/media/write/video_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/text.hpp"
#include "corda/media/animation/gif.hpp"
#include "corda/media/verify/check_video.hpp"

namespace corda::media {
namespace {

/// Title, comment and rate for the header of a file.
TrackInfo track_info(const CheckedVideo& video, const VideoMetadata& metadata) {
    auto comment = nlohmann::json::parse(metadata.comment_json, nullptr, false);
    if (!comment.is_object())
        throw_usage("the video comment is not a JSON object: {}", metadata.comment_json);
    comment["fps"] = video.def.fps.rational().text();
    comment["frames"] = video.frames();
    if (video.format.codec->crf) comment["crf"] = video.format.crf_of(video.def.encoder);
    return {.fps = video.def.fps.rational(),
            .title = metadata.title,
            .comment = comment.dump(),
            .has_alpha = video.format.has_alpha && std::string_view(video.format.codec->stream) == "vp9"};
}

/// The parameters of a track: libaom gives its header with the first packet, not before.
CodecParameters with_header(const AVCodecParameters& of_encoder, const AVPacket& first) {
    CodecParameters parameters =
        check_allocated(CodecParameters(avcodec_parameters_alloc()), "codec parameters");
    check_libav(avcodec_parameters_copy(parameters.get(), &of_encoder), ExitCode::kEncoder,
                "cannot copy codec parameters");
    std::size_t bytes = 0;
    const std::uint8_t* const header = av_packet_get_side_data(&first, AV_PKT_DATA_NEW_EXTRADATA, &bytes);
    if (header == nullptr || parameters->extradata_size > 0) return parameters;
    parameters->extradata = static_cast<std::uint8_t*>(av_mallocz(bytes + AV_INPUT_BUFFER_PADDING_SIZE));
    if (parameters->extradata == nullptr)
        fail_libav(ExitCode::kTemporary, "cannot copy codec parameters", AVERROR(ENOMEM));
    std::copy_n(header, bytes, parameters->extradata);
    parameters->extradata_size = static_cast<int>(bytes);
    return parameters;
}

/// A file with one track.
class VideoSink : public VideoFile::Sink {
  public:
    VideoSink(const CheckedVideo& video, VideoMetadata metadata)
        : video_(video),
          output_(video.path, {.force = video.force}),
          track_(video, std::move(metadata), output_) {}

    void add(ReadyFrame frame) override { track_.add(std::move(frame)); }

    void commit(const OnProgress& on_progress) override {
        const std::int64_t all = video_.frames();
        const CancelScope progress([&] { report_progress(on_progress, all, all); });
        track_.finish();
        check_video(output_.temporary_path(), video_.format, video_.def, all, track_.first());
        output_.commit();
    }

  private:
    const CheckedVideo& video_;
    OutputFile output_;
    TrackWriter track_;
};

class GifSink : public VideoFile::Sink {
  public:
    explicit GifSink(const CheckedVideo& video)
        : video_(video),
          output_(video.path, {.force = video.force}),
          gif_(video.format, video.def, std::filesystem::path(video.path).parent_path().string()) {}

    void add(ReadyFrame frame) override {
        if (frame.number == video_.first) first_ = std::move(frame.drawn);
        gif_.add(frame);
    }

    void commit(const OnProgress& on_progress) override {
        const std::int64_t all = 2 * video_.frames();
        std::int64_t done = video_.frames();
        const CancelScope progress([&] { report_progress(on_progress, done, all); });
        gif_.write(output_, [&](std::int64_t frames) { done = video_.frames() + frames; });
        check_video(output_.temporary_path(), video_.format, video_.def, video_.frames(), first_);
        output_.commit();
    }

  private:
    const CheckedVideo& video_;
    OutputFile output_;
    GifWriter gif_;
    Image first_;
};

/// A file for each frame, complete as soon as it has its name.
class PictureSink : public VideoFile::Sink {
  public:
    explicit PictureSink(const CheckedVideo& video) : video_(video) {
        const std::string folder = std::filesystem::path(video.path).parent_path().string();
        if (!folder.empty()) make_folder(folder);
    }

    void add(ReadyFrame frame) override {
        save_file(picture_name(video_.path, frame.number), frame.file,
                  {.force = video_.force || video_.resume});
    }

  private:
    const CheckedVideo& video_;
};

/// Standard output: YUV4MPEG2, or pixels without a header.
class StreamSink : public VideoFile::Sink {
  public:
    explicit StreamSink(const CheckedVideo& video) : video_(video) {}

    void add(ReadyFrame frame) override {
        if (std::string_view(video_.format.pixel_format) != "rgba")
            put(frame.number == video_.first ? header() + "FRAME\n" : "FRAME\n");
        const AVFrame& pixels = *frame.pixels;
        const auto format = static_cast<AVPixelFormat>(pixels.format);
        const int count = av_image_get_buffer_size(format, pixels.width, pixels.height, 1);
        bytes_.resize(static_cast<std::size_t>(count));
        check_libav(
            av_image_copy_to_buffer(reinterpret_cast<std::uint8_t*>(bytes_.data()), count, pixels.data,
                                    pixels.linesize, format, pixels.width, pixels.height, 1),
            ExitCode::kInternal, "cannot copy a picture");
        put(bytes_);
    }

  private:
    static void put(std::string_view bytes) {
        const int status = write_all(STDOUT_FILENO, bytes);
        if (status == EPIPE) throw ReaderLeft();
        if (status != 0) fail_file("write to", "standard output", status);
    }

    [[nodiscard]] std::string header() const {
        const Rational fps = video_.def.fps.rational();
        return fmt::format("YUV4MPEG2 W{} H{} F{}:{} Ip A1:1 {} XCOLORRANGE=LIMITED\n", video_.def.width_px,
                           video_.def.height_px, fps.num, fps.den,
                           std::string_view(video_.format.pixel_format) == "yuv420p"
                               ? "C420mpeg2 XYSCSS=420MPEG2"
                               : "C444 XYSCSS=444");
    }

    const CheckedVideo& video_;
    std::string bytes_;
};

std::unique_ptr<VideoFile::Sink> make_sink(const CheckedVideo& video, VideoMetadata metadata) {
    switch (video.format.ending->kind) {
        case FileKind::kPictures:
            return std::make_unique<PictureSink>(video);
        case FileKind::kStream:
            return std::make_unique<StreamSink>(video);
        case FileKind::kAnimation:
            return std::make_unique<GifSink>(video);
        case FileKind::kVideo:
            break;
    }
    return std::make_unique<VideoSink>(video, std::move(metadata));
}

/// Refuses to replace existing files. The folder is made if there is none.
void check_pictures(const CheckedVideo& video, const std::string& input) {
    const std::string folder = std::filesystem::path(video.path).parent_path().string();
    check_folder(folder);
    if (!folder.empty() && !is_there(folder)) return;
    for (std::int64_t k = video.first; k < video.end; ++k) {
        const std::string path = picture_name(video.path, k);
        if (!video.force && !video.resume && is_there(path))
            throw_error(ExitCode::kIo,
                        "'{}' exists; --resume draws the pictures that are missing, --force all", path);
        check_output(path, input, true);
    }
}

/// Whether there is a whole picture under a name, as `expected` tells. Throws as frames_to_draw().
bool has_picture(const std::string& path, const PngInfo& expected, bool force,
                 const std::function<std::string(const PngInfo&)>& difference_of) {
    if (!is_there(path)) return false;
    PngInfo found;
    try {
        found = read_png_info(path);
    } catch (const Error& error) {
        if (error.code() != ExitCode::kIo) throw;
        return false;  // damaged: it is drawn again
    }
    if (found.text == expected.text) return true;
    if (force) return false;
    throw_usage("'{}' is another picture: {}; write to another folder, or draw such pictures again (--force)",
                path, difference_of(found));
}

}  // namespace

CheckedVideo check_video_output(CheckedVideo video, const std::string& input, bool is_transparent) {
    check_video_def(video.def);
    video.format = find_format(video.path, video.def, is_transparent);
    if (video.format.codec->is_hardware) static_cast<void>(make_encoder(video.format, video.def));
    const FileKind kind = video.format.ending->kind;
    if (video.resume && kind != FileKind::kPictures)
        throw_usage(
            "{}: --resume continues pictures alone; render a long film as pictures (-o frames/%06d.png), and "
            "make the video of them by ffmpeg",
            video.path);
    if (kind == FileKind::kVideo || kind == FileKind::kAnimation)
        check_output(video.path, input, video.force);
    else if (kind == FileKind::kPictures)
        check_pictures(video, input);
    return video;
}

std::vector<std::int64_t> frames_to_draw(const CheckedVideo& video, const PictureInfo& info,
                                         const std::function<std::string(const PngInfo&)>& difference_of) {
    std::vector<std::int64_t> frames;
    for (std::int64_t k = video.first; k < video.first + video.frames(); ++k) {
        check_cancelled();
        const bool is_kept =
            video.resume && has_picture(picture_name(video.path, k), info(k), video.force, difference_of);
        if (!is_kept) frames.push_back(k);
    }
    return frames;
}

TrackWriter::TrackWriter(const CheckedVideo& video, VideoMetadata metadata, const OutputFile& output)
    : video_(video),
      metadata_(std::move(metadata)),
      output_(output),
      encoder_(make_encoder(video.format, video.def)) {}

void TrackWriter::add(ReadyFrame frame) {
    if (frame.number == video_.first) first_ = std::move(frame.drawn);
    encoder_->encode(std::move(frame.pixels), frame.changed, [this](AVPacket& packet) { write(packet); });
}

void TrackWriter::write(AVPacket& packet) {
    if (packet.pts != packets_)
        throw Error(ExitCode::kInternal, "an encoder has given frames in another order");
    if (!track_)
        track_.emplace(output_, video_.format.ending->muxer, *with_header(encoder_->parameters(), packet),
                       track_info(video_, metadata_));
    packet.dts = packets_++;
    packet.duration = 1;
    track_->write(packet);
}

void TrackWriter::finish() {
    encoder_->drain([this](AVPacket& packet) {
        check_cancelled();
        write(packet);
    });
    if (packets_ != video_.frames())
        throw_error(ExitCode::kInternal, "{} of {} frames were encoded", packets_, video_.frames());
    track_->finish();
}

VideoFile::VideoFile(const CheckedVideo& video, VideoMetadata metadata)
    : sink_(make_sink(video, std::move(metadata))) {}

VideoFile::~VideoFile() = default;

void VideoFile::add(ReadyFrame frame) {
    sink_->add(std::move(frame));
}

void VideoFile::commit(const OnProgress& on_progress) {
    sink_->commit(on_progress);
}

}  // namespace corda::media
