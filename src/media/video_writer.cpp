#include "corda/media/video_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/part_file.hpp"
#include "corda/media/chunk.hpp"
#include "corda/media/mp4_output.hpp"
#include "corda/media/mp4_remux.hpp"

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

/// Whether a decoder of one takes the other, too.
bool are_of_one_video(const AVCodecParameters& a, const AVCodecParameters& b) {
    return a.width == b.width && a.height == b.height && a.video_delay == b.video_delay &&
           std::equal(a.extradata, a.extradata + a.extradata_size, b.extradata,
                      b.extradata + b.extradata_size);
}

}  // namespace

void check_video_output(const std::string& path, const VideoDef& def, const std::string& input, bool force) {
    check_video_def(def);
    static_cast<void>(find_format(path, def.encoder.codec));
    check_output(path, input, force);
    PartFile::check(part_path(path), {.force = force});
}

struct VideoWriter::Impl {
    Impl(std::string final_path, const VideoDef& video, VideoMetadata meta,
         const OutputOptions& output_options, std::int64_t first)
        : path(std::move(final_path)),
          options(output_options),
          def(video),
          format(find_format(path, def.encoder.codec)),
          title(std::move(meta.title)),
          comment(parsed_comment(meta.comment_json)),
          first_frame(first),
          encoder(std::make_unique<ChunkEncoder>(format, def)),
          part(PartFile::create(part_path(path), options)),
          mp4(part.descriptor(), part.path()) {}

    /// Writes the header, with the colours of the first frame.
    void begin(Chunk& chunk) {
        comment["fps"] = def.fps.rational().text();
        comment["crf"] = def.encoder.crf;
        comment["patches"] = patches_json(chunk.patches);
        parameters = std::move(chunk.parameters);
        mp4.begin(format.container, Mp4Layout::kFragmented, *parameters, def.fps.rational(), title,
                  comment.dump());
    }

    void append(Chunk chunk) {
        if (chunk.frames == 0) return;
        if (!mp4.begun())
            begin(chunk);
        else if (!are_of_one_video(*parameters, *chunk.parameters))
            throw Error(ExitCode::kInternal, "two chunks of a video have different parameters");
        // The n-th packet is decoded at frame n, earlier by as many as it takes to put frames in order.
        std::int64_t decoded = written - parameters->video_delay;
        for (const Packet& packet : chunk.packets) {
            packet->pts += written;
            packet->dts = decoded++;
            packet->duration = 1;
            if (packet->pts < packet->dts || packet->pts >= written + chunk.frames)
                throw Error(ExitCode::kInternal, "a chunk has a packet at a time that cannot be");
            mp4.write(*packet);
        }
        mp4.flush();
        part.sync();
        written += chunk.frames;
    }

    /// Ends the chunk that write() has begun.
    void end_chunk() {
        if (encoder && encoder->frames() > 0) append(encoder->finish());
        encoder.reset();
    }

    [[nodiscard]] std::int64_t frames() const { return written + (encoder ? encoder->frames() : 0); }

    /// The number in the film of the next frame that write() is given.
    [[nodiscard]] std::int64_t next_frame() const { return first_frame + frames(); }

    void drain() {
        end_chunk();
        mp4.finish();
        drained = true;
    }

    std::string path;
    OutputOptions options;
    VideoDef def;
    const Format& format;
    std::string title;
    nlohmann::json comment;
    std::int64_t first_frame;
    std::unique_ptr<ChunkEncoder> encoder;  ///< of the chunk that write() adds to
    CodecParameters parameters;
    PartFile part;
    Mp4Output mp4;
    std::int64_t written = 0;  ///< frames of whole chunks
    bool drained = false;
};

VideoWriter::VideoWriter(std::string path, const VideoDef& def, VideoMetadata metadata,
                         const OutputOptions& options, std::int64_t first_frame) {
    check_video_output(path, def, "", options.force);
    impl_ = std::make_unique<Impl>(std::move(path), def, std::move(metadata), options, first_frame);
}

VideoWriter::~VideoWriter() {
    // A part without a fragment is of no use, and would be in the way of the next render.
    if (impl_ && impl_->part.is_empty()) impl_->part.remove();
}

void VideoWriter::write(const Image& frame, const Damage& damage) {
    Impl& impl = *impl_;
    if (impl.drained)
        throw Error(ExitCode::kInternal, "a frame was written to a video that has already ended");
    if (frame.width() != impl.def.width_px || frame.height() != impl.def.height_px) {
        throw Error(ExitCode::kInternal,
                    fmt::format("a frame of {}x{} was written to a video of {}x{}", frame.width(),
                                frame.height(), impl.def.width_px, impl.def.height_px));
    }
    if (!impl.encoder) impl.encoder = std::make_unique<ChunkEncoder>(impl.format, impl.def);
    impl.encoder->encode(frame, damage);
    if (impl.next_frame() % frames_per_chunk(impl.def.fps) == 0) impl.end_chunk();
}

void VideoWriter::append(Chunk chunk) {
    Impl& impl = *impl_;
    if (impl.drained) throw Error(ExitCode::kInternal, "a chunk was added to a video that has already ended");
    impl.end_chunk();
    impl.append(std::move(chunk));
}

const Format& VideoWriter::format() const {
    return impl_->format;
}

std::int64_t VideoWriter::frames() const {
    return impl_->frames();
}

void VideoWriter::finish(VerifyDepth depth) {
    Impl& impl = *impl_;
    if (impl.drained) throw Error(ExitCode::kInternal, "a video was finished twice");
    if (frames() == 0) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("'{}' would have no frame; ask for a duration of at least one frame", impl.path));
    }
    impl.drain();
    try {
        finish_part(impl.part, impl.path, impl.options, frames(), depth);
    } catch (const Error& error) {
        if (error.code() != ExitCode::kIo) throw;
        throw Error(error.code(),
                    fmt::format("{}; all frames are in '{}', which plays", error.what(), impl.part.path()));
    }
}

std::string VideoWriter::abandon() {
    if (frames() == 0) {
        impl_->part.remove();
        return {};
    }
    if (!impl_->drained) impl_->drain();
    impl_->part.sync();
    return impl_->part.path();
}

}  // namespace corda::media
