#include "corda/media/chunks/finish_part.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/output_file.hpp"
#include "corda/media/animation/animation.hpp"
#include "corda/media/chunks/part_reader.hpp"
#include "corda/media/chunks/track_output.hpp"
#include "corda/media/encode/resources.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/read/decoder.hpp"
#include "corda/media/read/video_comment.hpp"
#include "corda/media/verify/verify.hpp"

namespace corda::media {
namespace {

std::string listed(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += "\n  - " + line;
    return text;
}

/// Copies the indexed packets into `output`, with time stamps computed from frame numbers and the frame
/// count in the comment.
void remux(const PartIndex& index, const std::string& part_path, const Ending& ending, OutputFile& output) {
    const PartInput input = open_part(part_path, index.bytes);
    TrackOutput track(output.descriptor(), output.temporary_path(), TrackLayout::kFinal);
    track.begin(ending.muxer, *input.stream->codecpar,
                {.fps = index.fps,
                 .title = metadata_entry(*input.format, "title"),
                 .comment = finished_comment(metadata_entry(*input.format, "comment"), index.frame_of.size()),
                 .has_alpha = is_marked_as_alpha(*input.stream)});
    PacketCopy(part_path, input, index).copy_to(index.frame_of.size(), track);
    track.finish();
}

/// The number of threads that make an animation: those that are asked for, as far as memory suffices.
int animation_threads(int jobs, const Ending& ending, const PartInput& part) {
    const AVCodecParameters& parameters = *part.stream->codecpar;
    const std::uint64_t bytes = static_cast<std::uint64_t>(find_codec(ending.codecs.front())->job_bytes) *
                                static_cast<std::uint64_t>(parameters.width) *
                                static_cast<std::uint64_t>(parameters.height);
    return std::max(1, jobs_that_fit(jobs_of(jobs), bytes));
}

/// A part can become what its codec goes into.
void check_ending(const PartIndex& index, const std::string& part_path, const std::string& path,
                  const Ending& ending) {
    const bool is_file = ending.kind == FileKind::kVideo || ending.kind == FileKind::kAnimation;
    const std::string_view stream = avcodec_get_name(index.codec);
    for (const char* const name : ending.codecs)
        if (is_file && name != nullptr && find_codec(name)->stream == stream) return;
    throw Error(
        ExitCode::kUsage,
        fmt::format("'{}' holds {}, which '{}' cannot be made of; give the ending that the render was for",
                    part_path, stream, path));
}

/// Colours of an animation without a record of its rendering.
void check_animation(const PartIndex& index, const Ending& ending, VerifyReport& report) {
    if (ending.kind != FileKind::kAnimation || !report.ok()) return;
    const auto frames = std::ssize(index.frame_of);
    if (report.frames != frames)
        report.problems.push_back(
            fmt::format("{} frames were rendered but {} decode", frames, report.frames));
    if (report.fps != index.fps)
        report.problems.push_back(fmt::format("it was rendered for {} fps but plays at {} fps",
                                              index.fps.text(), report.fps.text()));
}

}  // namespace

RemuxResult finish_part(PartFile& part, const std::string& path, const OutputOptions& options,
                        const FinishDef& def) {
    const LogCapture log;
    const Ending& ending = find_ending(path);
    const std::int64_t total = passes(ending) * def.frames.value_or(0);
    std::int64_t done = def.frames.value_or(0);
    const CancelScope progress([&] {
        report_progress(def.on_progress, done, total);
        return true;
    });
    if (def.is_untrusted) check_part_in_child(part.path(), ending.kind == FileKind::kAnimation);
    const PartIndex index = index_part(part.path());
    RemuxResult result{static_cast<std::int64_t>(index.frame_of.size()), index.is_cut || index.is_damaged,
                       index.is_damaged};
    if (def.frames && *def.frames != result.frames) {
        throw Error(ExitCode::kMismatch, fmt::format("'{}' holds {} frames instead of {}; it stays as it is",
                                                     part.path(), result.frames, *def.frames));
    }
    check_ending(index, part.path(), path, ending);
    remove_leftovers(path);
    OutputFile output(path, options);
    if (ending.kind == FileKind::kAnimation) {
        const OnProgress encoded = [&](std::int64_t frame, std::int64_t) {
            if (def.frames) done = result.frames + frame;
            return true;
        };
        const int threads = animation_threads(def.jobs, ending, open_part(part.path(), index.bytes));
        write_animation(ending, {part.path(), index.bytes, result.frames, index.fps, threads}, encoded,
                        output);
    } else {
        remux(index, part.path(), ending, output);
    }
    done = total;
    VerifyReport report = def.is_untrusted
                              ? verify_in_child(output.temporary_path(), index.fps)
                              : verify(output.temporary_path(), def.depth, def.rendered, index.fps);
    check_animation(index, ending, report);
    if (!report.ok()) {
        throw Error(ExitCode::kMismatch,
                    fmt::format("the video for '{}' failed its check and stays as '{}':{}", path, part.path(),
                                listed(report.problems)));
    }
    output.commit();
    result.removed = !result.damaged && !def.keep_part;
    if (result.removed) part.remove();
    remove_part_copy(part.path());
    return result;
}

RemuxResult recover_part(const std::string& part_path, const std::string& path, const OutputOptions& options,
                         bool keep_part) {
    PartFile part = PartFile::open(part_path);
    FinishDef def;
    def.keep_part = keep_part;
    def.is_untrusted = true;
    return finish_part(part, path, options, def);
}

}  // namespace corda::media
