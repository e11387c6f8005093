#include "corda/media/chunks/join.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "corda/core/cancel.hpp"
#include "corda/core/image.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/media/animation/animation.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/chunks/track_output.hpp"
#include "corda/media/encode/resources.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/read/decoder.hpp"
#include "corda/media/read/video_comment.hpp"

namespace corda::media {
namespace {

[[noreturn]] void fail_damaged(const ChunkFile& file, const std::string& reason) {
    throw_error(ExitCode::kMismatch, "'{}' is damaged: {}; remove it, and make it again (--resume)",
                file.path, reason);
}

[[noreturn]] void fail_differing(const std::string& part, const std::string& first,
                                 const std::string& problem) {
    throw_error(ExitCode::kMismatch, "'{}' cannot be joined to '{}': {}; render both with the same options",
                part, first, problem);
}

/// A chunk file, open for reading its packets.
class ChunkInput {
  public:
    /// Throws corda::Error (kMismatch) if there is no video in it.
    ChunkInput(const ChunkFile& file, Rational fps) : file_(file), fps_(fps) {
        const LogCapture log;
        AVFormatContext* format = nullptr;
        const AVInputFormat* const demuxer = av_find_input_format(file_kind(file.path).c_str());
        const int status = demuxer == nullptr
                               ? AVERROR_INVALIDDATA
                               : avformat_open_input(&format, file_url(file.path).c_str(), demuxer, nullptr);
        if (status < 0) fail_damaged(file, libav_text(status));
        format_.reset(format);
        const int index = av_find_best_stream(format, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
        if (index < 0) fail_damaged(file, "it has no video track");
        if (format->nb_streams > 1) fail_damaged(file, "it has other tracks, which would be lost");
        stream_ = format->streams[index];
        const AVCodecParameters& codec = parameters();
        if (!is_picture_size(codec.width, codec.height))
            fail_damaged(file, fmt::format("its frames would be {}x{} pixels", codec.width, codec.height));
    }

    [[nodiscard]] const ChunkFile& file() const { return file_; }
    [[nodiscard]] const AVCodecParameters& parameters() const { return *stream_->codecpar; }
    [[nodiscard]] bool has_alpha() const { return is_marked_as_alpha(*stream_); }
    /// Colours of its first and its last frame, whose numbers count from `first`.
    [[nodiscard]] std::vector<FrameColors> colors(std::int64_t first) const {
        const std::string comment = metadata_entry(*format_, "comment");
        return {{first, comment_patches(comment)},
                {first + file_.frames - 1, comment_patches(comment, "last_patches")}};
    }
    /// Gives `take` all packets, in order; their stamps are frame numbers from `first` on. Throws
    /// corda::Error: kMismatch if there are others than one per frame, kInterrupted.
    template <class Take>
    void read(std::int64_t first, const Take& take) {
        const LogCapture log;
        const Packet packet = check_allocated(Packet(av_packet_alloc()), "a packet");
        std::int64_t frames = 0;
        for (int status = 0; (status = av_read_frame(format_.get(), packet.get())) != AVERROR_EOF;) {
            check_cancelled();
            if (status < 0) fail_damaged(file_, libav_text(status));
            const bool is_next =
                is_sane_stamp(packet->pts) && (packet->flags & AV_PKT_FLAG_CORRUPT) == 0 &&
                av_rescale_q(packet->pts, stream_->time_base, frame_time_base(fps_)) == frames;
            if (!is_next) fail_damaged(file_, fmt::format("frame {} is not where it belongs", frames));
            packet->pts = packet->dts = first + frames++;
            packet->duration = 1;
            take(*packet);
            av_packet_unref(packet.get());
        }
        if (frames != file_.frames) fail_damaged(file_, fmt::format("it has {} frames", frames));
    }

  private:
    ChunkFile file_;
    Rational fps_;
    InputFormat format_;
    const AVStream* stream_ = nullptr;  ///< owned by format_
};

/// Whether a decoder of one takes the other, too.
bool are_of_one_video(const AVCodecParameters& a, const AVCodecParameters& b) {
    return a.codec_id == b.codec_id && a.width == b.width && a.height == b.height &&
           std::equal(a.extradata, a.extradata + a.extradata_size, b.extradata,
                      b.extradata + b.extradata_size);
}

/// Chunks of a video, of which one at a time is open.
struct Chunks {
    std::size_t count = 0;
    std::function<ChunkInput(std::size_t index)> open;
    std::int64_t frames = 0;  ///< of all
};

Chunks chunks_of(const ChunkRun& run, Rational fps) {
    const auto open = [&run, fps](std::size_t index) { return ChunkInput(run.chunks[index], fps); };
    return {run.chunks.size(), open, run.frames};
}

/// Calls `work` with each chunk, open, and the number of its first frame in the video. `first`: the first
/// one. Returns the colours of their first and last frames.
template <class Work>
std::vector<FrameColors> for_each_chunk(const Chunks& chunks, const ChunkInput& first, const Work& work) {
    std::vector<FrameColors> colors;
    std::int64_t frames = 0;
    for (std::size_t i = 0; i < chunks.count; ++i) {
        ChunkInput chunk = chunks.open(i);
        if (!are_of_one_video(first.parameters(), chunk.parameters()) ||
            first.has_alpha() != chunk.has_alpha())
            fail_differing(chunk.file().path, first.file().path,
                           "it is of another video, or its encoder settings (--preset, --crf) differ");
        for (FrameColors& frame : chunk.colors(frames))
            if (colors.empty() || frame.frame > colors.back().frame) colors.push_back(std::move(frame));
        work(chunk, frames);
        frames += chunk.file().frames;
    }
    return colors;
}

/// Copies the packets. Returns colours as for_each_chunk().
std::vector<FrameColors> copy(const Chunks& chunks, const Manifest& manifest, const Ending& ending,
                              const ChunkInput& first, OutputFile& output) {
    TrackOutput track(
        output, ending.muxer, first.parameters(),
        {.fps = manifest.fps,
         .title = manifest.title,
         .comment = finished_comment(manifest.comment, chunks.frames, first.colors(0).front().patches),
         .has_alpha = first.has_alpha()});
    auto colors = for_each_chunk(chunks, first, [&track](ChunkInput& chunk, std::int64_t begin) {
        chunk.read(begin, [&track](AVPacket& packet) { track.write(packet); });
    });
    track.finish();
    return colors;
}

/// The number of threads that make an animation: those that are asked for, as far as memory suffices.
int animation_threads(int jobs, const Ending& ending, const AVCodecParameters& parameters) {
    const std::uint64_t bytes = static_cast<std::uint64_t>(find_codec(ending.codecs.front())->job_bytes) *
                                static_cast<std::uint64_t>(parameters.width) *
                                static_cast<std::uint64_t>(parameters.height);
    return std::max(1, jobs_that_fit(jobs_of(jobs), bytes));
}

/// Refuses a video that cannot be made of chunks of this codec.
void check_ending(const Ending& ending, AVCodecID codec, const std::string& path) {
    const bool is_file = ending.kind == FileKind::kVideo || ending.kind == FileKind::kAnimation;
    const std::string_view stream = avcodec_get_name(codec);
    for (const char* const name : ending.codecs)
        if (is_file && name != nullptr && find_codec(name)->stream == stream) return;
    throw_usage("'{}' cannot be made of {}; give the ending that the render was for", path, stream);
}

/// Verifies the parts, and refuses those that differ from the first in what the report says. Returns the
/// rate.
Rational check_parts(const std::vector<std::string>& parts, ChunkRun& run) {
    using Traits = std::array<std::pair<const char*, std::string>, 4>;
    std::optional<Traits> first;
    Rational fps;
    for (const std::string& part : parts) {
        const VerifyReport report = verify_in_child(part);
        if (!report.ok())
            throw_error(ExitCode::kMismatch, "'{}' fails its check: {}", part, report.problems.front());
        fps = report.fps;
        const Traits traits{
            {{"size (--size)", fmt::format("{}x{}", report.width_px, report.height_px)},
             {"rate (--fps)", fps.text()},
             {"codec (--codec, --pix)", fmt::format("{} {}", report.coding(), report.pixel_format)},
             {"colour", fmt::format("{} {} {} {} {}", report.range, report.matrix, report.primaries,
                                    report.transfer, report.chroma_location)}}};
        if (!first) first = traits;
        for (std::size_t i = 0; i < traits.size(); ++i)
            if (const auto& [name, value] = traits[i]; value != (*first)[i].second)
                fail_differing(part, parts.front(),
                               fmt::format("its {} is {} and not {}", name, value, (*first)[i].second));
        run.chunks.push_back({std::ssize(run.chunks), report.frames, 0, part});
        run.frames += report.frames;
    }
    return fps;
}

/// Checks of an animation, which has no comment that tells count and rate.
void check_animation(const ChunkRun& run, Rational fps, VerifyReport& report) {
    if (!report.ok()) return;
    if (report.frames != run.frames)
        report.problems.push_back(
            fmt::format("{} frames were rendered but {} decode", run.frames, report.frames));
    if (report.fps != fps)
        report.problems.push_back(
            fmt::format("it was rendered for {} fps but plays at {} fps", fps.text(), report.fps.text()));
}

}  // namespace

void join_chunks(const ChunkRun& run, const Manifest& manifest, const std::string& path,
                 const OutputOptions& options, const JoinDef& def) {
    const LogCapture log;
    const Ending& ending = find_ending(path);
    const bool is_animation = ending.kind == FileKind::kAnimation;
    const std::int64_t total = passes(ending) * run.frames;
    std::int64_t done = run.frames;
    const CancelScope progress([&] { report_progress(def.on_progress, done, total); });
    const ChunkInput first(run.chunks.front(), manifest.fps);
    check_ending(ending, first.parameters().codec_id, path);
    remove_leftovers(path);
    OutputFile output(path, options);
    std::vector<FrameColors> colors;
    if (is_animation) {
        colors = for_each_chunk(chunks_of(run, manifest.fps), first, [](ChunkInput&, std::int64_t) {});
        const OnProgress encoded = [&](std::int64_t frame, std::int64_t) {
            done = run.frames + frame;
            return true;
        };
        const int threads = animation_threads(def.jobs, ending, first.parameters());
        write_gif(ending, {run.chunks, run.frames, manifest.fps, manifest.loop, threads}, encoded, output);
    } else {
        colors = copy(chunks_of(run, manifest.fps), manifest, ending, first, output);
    }
    done = total;
    VerifyReport report = verify(output.temporary_path(), def.depth, colors, manifest.fps);
    if (is_animation) check_animation(run, manifest.fps, report);
    if (!report.ok()) {
        std::string problems;
        for (const std::string& line : report.problems) problems += "\n  - " + line;
        throw_error(ExitCode::kMismatch,
                    "the video for '{}' failed its check, and its chunks stay in '{}':{}", path,
                    std::filesystem::path(run.chunks.front().path).parent_path().string(), problems);
    }
    output.commit();
}

std::string join_in_memory(const std::vector<Chunk>& chunks, const Manifest& manifest, const Format& format) {
    const LogCapture log;
    std::optional<OutputFile> file;
    const auto open = [&](std::size_t index) {
        const Chunk& chunk = chunks[index];
        // The first one is opened twice, but its packets can be written only once.
        if (index > 0 || !file)
            write_chunk(chunk, format, manifest.fps, file.emplace(OutputFile::InMemory()));
        return ChunkInput({chunk.first / manifest.per_chunk, chunk.frames, 0, file->temporary_path()},
                          manifest.fps);
    };
    std::int64_t frames = 0;
    for (const Chunk& chunk : chunks) frames += chunk.frames;
    OutputFile output{OutputFile::InMemory()};
    copy({chunks.size(), open, frames}, manifest, *format.ending, open(0), output);
    return output.bytes();
}

void check_chunks_in_child(const std::string& folder, const Manifest& manifest) {
    const std::vector<ChunkFile> files = chunk_files(folder);
    if (files.empty()) return;
    work_in_child(folder, bytes_of(files), [&] {
        for (const ChunkFile& file : files)
            if (is_sound(file, manifest)) ChunkInput(file, manifest.fps).read(0, [](AVPacket&) {});
    });
}

std::string gap_text(const ChunkRun& run, const Manifest& manifest) {
    const std::int64_t gap = run.gap.value();
    const bool is_short = !run.chunks.empty() && run.chunks.back().number == gap;
    return fmt::format("chunk {} (frames {}..{}) is {}", gap, manifest.first_of(gap),
                       manifest.end_of(gap) - 1,
                       run.is_damaged ? "damaged"
                       : is_short     ? "not whole"
                                      : "missing");
}

Recovered recover(const std::string& folder, const std::string& path, const OutputOptions& options,
                  bool keeps_folder) {
    check_path(folder);
    const auto manifest = read_manifest(folder);
    if (!manifest)
        throw_error(ExitCode::kMismatch, "'{}' has no manifest, so it is not of an interrupted render",
                    folder);
    ChunkFolder parts(folder, ChunkFolder::Use::kContinue, *manifest);
    const ChunkRun run = parts.run();
    if (run.chunks.empty())
        throw_error(ExitCode::kMismatch,
                    "'{}' holds no chunk to begin with: {}; render it again (--resume or --force)", folder,
                    gap_text(run, *manifest));
    work_in_child(folder, bytes_of(run.chunks), [&] { join_chunks(run, *manifest, path, options, {}); });
    const bool removes = run.left_out == 0 && !keeps_folder;
    if (removes) parts.remove();
    return {run.frames, run.gap ? gap_text(run, *manifest) : "", run.is_damaged, run.left_out, removes};
}

ChunkRun join_videos(const std::vector<std::string>& parts, const std::string& path, const std::string& title,
                     const std::string& comment, const OutputOptions& options) {
    if (find_ending(path).kind != FileKind::kVideo)
        throw_usage(
            "'{}' is no video that can be joined; give a name that ends as the parts do (.mp4, .mov, .mkv, "
            ".webm)",
            path);
    ChunkRun run;
    const Rational fps = check_parts(parts, run);
    nlohmann::json completed = nlohmann::json::parse(comment);
    completed["fps"] = fps.text();
    std::optional<std::int64_t> crf;  // the worst, by which verify() judges colours
    for (const std::string& part : parts) crf = std::max(crf, comment_number(comment_in_child(part), "crf"));
    if (crf) completed["crf"] = *crf;
    const Manifest manifest{.fps = fps, .title = title, .comment = completed.dump()};
    work_in_child(fmt::format("{}", fmt::join(parts, "', '")), bytes_of(run.chunks),
                  [&] { join_chunks(run, manifest, path, options, {.depth = VerifyDepth::kKeyFrames}); });
    return run;
}

}  // namespace corda::media
