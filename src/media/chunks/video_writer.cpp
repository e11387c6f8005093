#include "corda/media/chunks/video_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/part_file.hpp"
#include "corda/media/animation/animation.hpp"
#include "corda/media/chunks/chunk.hpp"
#include "corda/media/chunks/video_sink.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {
namespace {

nlohmann::json parsed_comment(const std::string& text) {
    auto json = nlohmann::json::parse(text, nullptr, false);
    if (json.is_object()) return json;
    throw Error(ExitCode::kUsage, fmt::format("the video comment is not a JSON object: {}", text));
}

nlohmann::json patches_json(const std::vector<ColorPatch>& patches) {
    auto list = nlohmann::json::array();
    for (const ColorPatch& patch : patches) {
        list.push_back({patch.x, patch.y, patch.rgb[0], patch.rgb[1], patch.rgb[2]});
    }
    return list;
}

/// Refuses to replace existing files. The folder is made if there is none.
void check_pictures(const std::string& pattern, const std::string& input, bool force, std::int64_t first,
                    std::int64_t end) {
    const std::filesystem::path folder = std::filesystem::path(pattern).parent_path();
    std::error_code ignored;
    check_folder(folder.string());
    if (!folder.empty() && !std::filesystem::exists(folder, ignored)) return;
    for (std::int64_t k = first; k < end; ++k) check_output(picture_name(pattern, k), input, force);
}

/// Whether a decoder of one takes the other, too.
bool are_of_one_video(const AVCodecParameters& a, const AVCodecParameters& b) {
    return a.width == b.width && a.height == b.height && a.video_delay == b.video_delay &&
           std::equal(a.extradata, a.extradata + a.extradata_size, b.extradata,
                      b.extradata + b.extradata_size);
}

/// The parameters of a chunk for a muxer: libaom gives its header with the first packet, not before.
CodecParameters with_header(const Chunk& chunk) {
    CodecParameters parameters =
        check_allocated(CodecParameters(avcodec_parameters_alloc()), "codec parameters");
    check_libav(avcodec_parameters_copy(parameters.get(), chunk.parameters.get()), ExitCode::kEncoder,
                "cannot copy codec parameters");
    std::size_t bytes = 0;
    const std::uint8_t* const header =
        chunk.packets.empty()
            ? nullptr
            : av_packet_get_side_data(chunk.packets.front().get(), AV_PKT_DATA_NEW_EXTRADATA, &bytes);
    if (header == nullptr || parameters->extradata_size > 0) return parameters;
    parameters->extradata = static_cast<std::uint8_t*>(av_mallocz(bytes + AV_INPUT_BUFFER_PADDING_SIZE));
    if (parameters->extradata == nullptr)
        fail_libav(ExitCode::kTemporary, "cannot copy codec parameters", AVERROR(ENOMEM));
    std::copy_n(header, bytes, parameters->extradata);
    parameters->extradata_size = static_cast<int>(bytes);
    return parameters;
}

}  // namespace

CheckedVideo check_video_output(const std::string& path, const VideoDef& def, const std::string& input,
                                bool force, bool is_transparent, std::int64_t first, std::int64_t end,
                                bool resume) {
    check_video_def(def);
    const Format format = find_format(path, def, is_transparent);
    if (format.codec->is_hardware) static_cast<void>(make_encoder(format, def));
    const std::int64_t known_end = end == CheckedVideo::kNoEnd ? first : end;
    check_animation_frames(*format.ending, known_end - first);
    const bool has_part =
        format.ending->kind == FileKind::kVideo || format.ending->kind == FileKind::kAnimation;
    if (resume && !has_part) {
        throw Error(
            ExitCode::kUsage,
            fmt::format(
                "{} has no part file, so --resume has nothing to continue; render the frames that are "
                "missing (--frames FIRST:END)",
                path));
    }
    switch (format.ending->kind) {
        case FileKind::kStream:
            break;
        case FileKind::kPictures:
            check_pictures(path, input, force, first, known_end);
            break;
        case FileKind::kVideo:
        case FileKind::kAnimation:
            check_output(path, input, force);
            PartFile::check(part_path(path), {.force = force || resume});
    }
    return {path, def, format, first, end, force, resume};
}

struct VideoWriter::Impl {
    Impl(const CheckedVideo& output, VideoMetadata meta)
        : path(output.path),
          def(output.def),
          metadata(std::move(meta)),
          format(output.format),
          comment(parsed_comment(metadata.comment_json)),
          first_frame(output.first),
          sink(make_sink(format, path, {.force = output.force},
                         {output.first, output.end, media::frames_per_chunk(format, def.fps)},
                         output.resume)),
          written(sink->resumed_frames()) {
        if (written == 0) return;
        parameters = check_allocated(CodecParameters(avcodec_parameters_alloc()), "codec parameters");
        check_libav(avcodec_parameters_copy(parameters.get(), &make_encoder(format, def)->parameters()),
                    ExitCode::kEncoder, "cannot copy codec parameters");
    }

    [[nodiscard]] ChunkEncoder chunk_encoder(std::int64_t frame) const {
        return ChunkEncoder(make_encoder(format, def, frame, metadata.picture_info));
    }

    /// Writes the header, with the colours of the first frame.
    void begin(Chunk& chunk) {
        comment["fps"] = def.fps.rational().text();
        if (format.codec->crf) comment["crf"] = format.crf_of(def.encoder);
        comment["patches"] = patches_json(chunk.colors.front().patches);
        const CodecParameters stored = with_header(chunk);
        parameters = std::move(chunk.parameters);
        sink->begin(*stored, {.fps = def.fps.rational(),
                              .title = metadata.title,
                              .comment = comment.dump(),
                              .has_alpha = format.has_alpha && parameters->codec_id == AV_CODEC_ID_VP9});
    }

    void append(Chunk chunk) {
        if (chunk.frames == 0) return;
        if (!parameters)
            begin(chunk);
        else if (!are_of_one_video(*parameters, *chunk.parameters))
            throw Error(ExitCode::kInternal, "two chunks of a video have different parameters");
        is_broken = true;  // until all of the chunk is written
        const bool has_whole_packets =
            format.ending->kind == FileKind::kPictures || format.ending->kind == FileKind::kStream;
        const std::int64_t first = written;
        // The n-th packet is decoded at frame n, earlier by as many as it takes to put frames in order.
        std::int64_t decoded = first - parameters->video_delay;
        for (const Packet& packet : chunk.packets) {
            packet->pts += first;
            packet->dts = decoded++;
            packet->duration = 1;
            if (packet->pts < packet->dts || packet->pts >= first + chunk.frames)
                throw Error(ExitCode::kInternal, "a chunk has a packet at a time that cannot be");
            sink->write(*packet);
            if (has_whole_packets) ++written;
        }
        sink->end_chunk();
        for (FrameColors& frame : chunk.colors) {
            frame.frame += first;
            colors.push_back(std::move(frame));
        }
        written = first + chunk.frames;
        is_broken = false;
    }

    void check_goes_on() const {
        if (drained) throw Error(ExitCode::kInternal, "this video has already ended");
        if (is_broken)
            throw Error(ExitCode::kInternal, "writing this video has failed: it can only be abandoned");
    }

    /// Ends the chunk that write() has begun.
    void end_chunk(std::function<bool()> goes_on = {}) {
        const auto ended = std::exchange(encoder, nullptr);
        if (ended && ended->frames() > 0) append(ended->finish(std::move(goes_on)));
    }

    [[nodiscard]] std::int64_t frames() const { return written + (encoder ? encoder->frames() : 0); }

    /// The number in the film of the next frame that write() is given.
    [[nodiscard]] std::int64_t next_frame() const { return first_frame + frames(); }

    /// Ends the stream. After a chunk that could not be written, nothing more is written.
    void drain(std::function<bool()> goes_on = {}) {
        if (is_broken) encoder.reset();
        end_chunk(std::move(goes_on));
        if (!is_broken && written > 0) sink->drain();
        drained = true;
    }

    std::string path;
    VideoDef def;
    VideoMetadata metadata;
    Format format;
    nlohmann::json comment;
    std::int64_t first_frame;
    std::unique_ptr<ChunkEncoder> encoder;  ///< of the chunk that write() adds to; null between chunks
    CodecParameters parameters;
    std::unique_ptr<VideoSink> sink;
    std::int64_t written = 0;         ///< frames of whole chunks, or whole ones if each stands alone
    std::vector<FrameColors> colors;  ///< of frames in them
    bool drained = false;
    bool is_broken = false;  ///< a chunk could not be written, or not all of it
};

VideoWriter::VideoWriter(const CheckedVideo& output, VideoMetadata metadata)
    : impl_(std::make_unique<Impl>(output, std::move(metadata))) {}

VideoWriter::VideoWriter(const std::string& path, const VideoDef& def, const VideoMetadata& metadata,
                         const OutputOptions& options)
    : VideoWriter(check_video_output(path, def, "", options.force, metadata.is_transparent), metadata) {}

VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter::~VideoWriter() = default;

void VideoWriter::write(const Image& frame, const Damage& damage, bool is_last) {
    Impl& impl = *impl_;
    impl.check_goes_on();
    if (frame.width() != impl.def.width_px || frame.height() != impl.def.height_px) {
        throw Error(ExitCode::kInternal,
                    fmt::format("a frame of {}x{} was written to a video of {}x{}", frame.width(),
                                frame.height(), impl.def.width_px, impl.def.height_px));
    }
    if (!impl.encoder) impl.encoder = std::make_unique<ChunkEncoder>(impl.chunk_encoder(impl.next_frame()));
    const bool ends_chunk = is_last || (impl.next_frame() + 1) % frames_per_chunk() == 0;
    impl.encoder->encode(frame, damage, ends_chunk);
    if (ends_chunk) impl.end_chunk();
}

void VideoWriter::append(Chunk chunk) {
    Impl& impl = *impl_;
    impl.check_goes_on();
    impl.end_chunk();
    impl.append(std::move(chunk));
}

const Format& VideoWriter::format() const {
    return impl_->format;
}

std::int64_t VideoWriter::frames_per_chunk() const {
    return media::frames_per_chunk(impl_->format, impl_->def.fps);
}

ChunkEncoder VideoWriter::chunk_encoder(std::int64_t frame) const {
    return impl_->chunk_encoder(frame);
}

bool VideoWriter::was_part_damaged() const {
    return impl_->sink->was_part_damaged();
}

std::int64_t VideoWriter::frames() const {
    return impl_->frames();
}

void VideoWriter::finish(VerifyDepth depth, const OnProgress& on_progress) {
    Impl& impl = *impl_;
    impl.check_goes_on();
    if (frames() == 0) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("'{}' would have no frame; ask for a duration of at least one frame", impl.path));
    }
    impl.drain();
    const bool takes_all = depth == VerifyDepth::kKeyFrames && impl.format.codec->verifies_all;
    if (takes_all) depth = VerifyDepth::kAllFrames;
    impl.sink->finish({.frames = frames(),
                       .depth = depth,
                       .rendered = impl.colors,
                       .jobs = impl.def.encoder.jobs,
                       .on_progress = on_progress});
}

std::string VideoWriter::abandon() {
    if (!impl_->drained) {
        try {
            impl_->drain([end_s = now_s() + kMomentS] { return now_s() < end_s; });
        } catch (const Error& error) {
            if (!is_interruption(error.code())) throw;
            impl_->drain();  // without the frames that the encoder held back
        }
    }
    if (frames() == 0) {
        impl_->sink->remove();
        return {};
    }
    return impl_->sink->abandon();
}

}  // namespace corda::media
