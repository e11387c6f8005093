#include "corda/media/video_writer.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "corda/core/error.hpp"
#include "corda/media/color_patch.hpp"
#include "corda/media/file_ops.hpp"
#include "corda/media/h264_encoder.hpp"
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

const std::vector<std::string>& x264_presets() {
    static const std::vector<std::string> presets{"ultrafast", "superfast", "veryfast", "faster",
                                                  "fast",      "medium",    "slow",     "slower",
                                                  "veryslow",  "placebo"};
    return presets;
}

struct VideoWriter::Impl {
    Impl(std::string final_path, const VideoDef& video, VideoMetadata meta)
        : path(std::move(final_path)),
          part(part_path(path)),
          def(video),
          title(std::move(meta.title)),
          comment(parsed_comment(meta.comment_json)),
          encoder(video),
          output(part) {}

    /// Writes the header, once: it waits for the first frame because the comment holds that frame's colours.
    void begin(const Image* first_frame) {
        if (output.begun()) return;
        comment["fps"] = def.fps.rational().text();
        comment["crf"] = def.encoder.crf;
        comment["patches"] =
            patches_json(first_frame == nullptr ? std::vector<ColorPatch>{} : choose_patches(*first_frame));
        output.begin(Mp4Layout::kFragmented, encoder.parameters(), def.fps.rational(), title, comment.dump());
    }

    void drain_and_close() {
        begin(nullptr);
        encoder.drain([this](AVPacket& packet) { output.write(packet); });
        output.close();
        closed = true;
    }

    std::string path;
    std::string part;
    VideoDef def;
    std::string title;
    nlohmann::json comment;
    H264Encoder encoder;
    Mp4Output output;
    bool closed = false;
};

VideoWriter::VideoWriter(std::string path, const VideoDef& def, VideoMetadata metadata) {
    check_video_def(def);
    impl_ = std::make_unique<Impl>(std::move(path), def, std::move(metadata));
}

VideoWriter::~VideoWriter() {
    // A part file that has not even a header is of no use to anybody.
    if (impl_ && !impl_->output.begun()) remove_quietly(impl_->part);
}

void VideoWriter::write(const Image& frame, const PixelRect& damage) {
    Impl& impl = *impl_;
    if (impl.closed)
        throw Error(ExitCode::kInternal, "a frame was written to a video that is already closed");
    if (frame.width() != impl.def.width_px || frame.height() != impl.def.height_px) {
        throw Error(ExitCode::kInternal,
                    fmt::format("a frame of {}x{} was written to a video of {}x{}", frame.width(),
                                frame.height(), impl.def.width_px, impl.def.height_px));
    }
    impl.begin(&frame);
    impl.encoder.encode(frame, damage, [&impl](AVPacket& packet) { impl.output.write(packet); });
}

std::int64_t VideoWriter::frames() const {
    return impl_->encoder.frames();
}

void VideoWriter::finish() {
    Impl& impl = *impl_;
    if (impl.closed) throw Error(ExitCode::kInternal, "a video was finished twice");
    if (frames() == 0) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("'{}' would have no frame; ask for a duration of at least one frame", impl.path));
    }
    impl.drain_and_close();
    recover_part(impl.part, impl.path, frames());
}

std::string VideoWriter::abandon() {
    if (!impl_->closed) impl_->drain_and_close();
    return impl_->part;
}

}  // namespace corda::media
