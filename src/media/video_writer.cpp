#include "corda/media/video_writer.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/part_file.hpp"
#include "corda/media/color_patch.hpp"
#include "corda/media/encoder.hpp"
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

}  // namespace

void check_video_output(const std::string& path, const VideoDef& def, const std::string& input, bool force) {
    check_video_def(def);
    static_cast<void>(find_format(path, def.encoder.codec));
    check_output(path, input, force);
    PartFile::check(part_path(path), {.force = force});
}

struct VideoWriter::Impl {
    Impl(std::string final_path, const VideoDef& video, VideoMetadata meta,
         const OutputOptions& output_options)
        : path(std::move(final_path)),
          options(output_options),
          def(video),
          format(find_format(path, def.encoder.codec)),
          title(std::move(meta.title)),
          comment(parsed_comment(meta.comment_json)),
          encoder(format.make_encoder(format, def)),
          part(PartFile::create(part_path(path), options)),
          mp4(part.descriptor(), part.path()) {}

    /// Writes the header, once: it waits for the first frame because the comment holds that frame's colours.
    void begin(const Image* first_frame) {
        if (mp4.begun()) return;
        comment["fps"] = def.fps.rational().text();
        comment["crf"] = def.encoder.crf;
        comment["patches"] =
            patches_json(first_frame == nullptr ? std::vector<ColorPatch>{} : choose_patches(*first_frame));
        mp4.begin(format.container, Mp4Layout::kFragmented, encoder->parameters(), def.fps.rational(), title,
                  comment.dump());
    }

    void drain() {
        begin(nullptr);
        encoder->drain([this](AVPacket& packet) { mp4.write(packet); });
        mp4.finish();
        drained = true;
    }

    std::string path;
    OutputOptions options;
    VideoDef def;
    const Format& format;
    std::string title;
    nlohmann::json comment;
    std::unique_ptr<Encoder> encoder;
    PartFile part;
    Mp4Output mp4;
    bool drained = false;
};

VideoWriter::VideoWriter(std::string path, const VideoDef& def, VideoMetadata metadata,
                         const OutputOptions& options) {
    check_video_output(path, def, "", options.force);
    impl_ = std::make_unique<Impl>(std::move(path), def, std::move(metadata), options);
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
    impl.begin(&frame);
    impl.encoder->encode(frame, damage, [&impl](AVPacket& packet) { impl.mp4.write(packet); });
}

std::int64_t VideoWriter::frames() const {
    return impl_->encoder->frames();
}

void VideoWriter::finish() {
    Impl& impl = *impl_;
    if (impl.drained) throw Error(ExitCode::kInternal, "a video was finished twice");
    if (frames() == 0) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("'{}' would have no frame; ask for a duration of at least one frame", impl.path));
    }
    impl.drain();
    try {
        finish_part(impl.part, impl.path, impl.options, frames());
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
