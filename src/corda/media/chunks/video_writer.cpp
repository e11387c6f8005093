#include "corda/media/chunks/video_writer.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/media/animation/animation.hpp"
#include "corda/media/chunks/join.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

/// Destination of the chunks of a video. All functions throw corda::Error (kIo).
class VideoSink : NonCopyable {
  public:
    virtual ~VideoSink() = default;

    /// Whether a chunk is to be added: another is there, or is another shard's.
    [[nodiscard]] virtual bool lacks(std::int64_t /*chunk*/) const { return true; }
    /// Chunks that had changed since they were written.
    [[nodiscard]] virtual std::vector<std::int64_t> damaged() const { return {}; }
    /// Number of frames that are there.
    [[nodiscard]] virtual std::int64_t frames() const = 0;
    virtual void add(std::int64_t number, Chunk chunk) = 0;
    /// Gives the video its name once all chunks are there. Throws as join_chunks().
    virtual void finish(const JoinDef& /*def*/) {}
    /// Where the frames are that are there.
    [[nodiscard]] virtual std::string place() const = 0;
};

namespace {

std::string_view bytes_of(const AVPacket& packet) {
    return {reinterpret_cast<const char*>(packet.data), static_cast<std::size_t>(packet.size)};
}

/// A folder of chunks, of which it makes the finished file.
class FolderSink : public VideoSink {
  public:
    FolderSink(const CheckedVideo& output, Manifest manifest)
        : output_(output), folder_(parts_path(output.path), output.use(), std::move(manifest)) {
        std::vector<ChunkFile> unusable;
        for (ChunkFile& file : chunk_files(folder_.path())) {
            const bool is_whole = file.frames == folder_.manifest().frames_of(file.number);
            if (!is_of_shard(file.number) || has_chunk(file.number)) continue;
            const bool has_checksum = is_sound(file, folder_.manifest());
            if (has_checksum && is_whole)
                take(std::move(file));
            else
                unusable.push_back(std::move(file));
            if (!has_checksum) damaged_.insert(unusable.back().number);
        }
        // Such a chunk may have a sound copy of another checksum.
        std::erase_if(damaged_, [this](std::int64_t chunk) { return has_chunk(chunk); });
        std::error_code ignored;
        for (const ChunkFile& file : unusable) std::filesystem::remove(file.path, ignored);
    }
    /// Removes a folder without a chunk, which is of no use.
    ~FolderSink() override {
        if (frames_ == 0 && !output_.shard) folder_.remove();
    }

    [[nodiscard]] bool lacks(std::int64_t chunk) const override {
        return is_of_shard(chunk) && !has_chunk(chunk);
    }
    [[nodiscard]] std::vector<std::int64_t> damaged() const override {
        return {damaged_.begin(), damaged_.end()};
    }
    [[nodiscard]] std::int64_t frames() const override { return frames_; }
    void add(std::int64_t number, Chunk chunk) override {
        telling_what_is_kept([&] {
            take(folder_.add(number, chunk.frames, chunk_ending(), [&](OutputFile& file) {
                write_chunk(chunk, output_.format, folder_.manifest().fps, file);
            }));
        });
    }
    void finish(const JoinDef& def) override {
        if (output_.shard) return;
        telling_what_is_kept([&] {
            join_chunks(all_chunks(), folder_.manifest(), output_.path, {.force = output_.force}, def);
        });
        folder_.remove();
    }
    [[nodiscard]] std::string place() const override { return folder_.path(); }

  private:
    /// Shards take turns, so that each has as much to do, also if only a part of the film moves.
    [[nodiscard]] bool is_of_shard(std::int64_t chunk) const {
        const Shard shard = output_.shard.value_or(Shard{});
        return (chunk - folder_.manifest().first_chunk()) % shard.count == shard.index;
    }
    [[nodiscard]] bool has_chunk(std::int64_t chunk) const { return there_.contains(chunk); }
    void take(ChunkFile file) {
        frames_ += file.frames;
        there_.emplace(file.number, std::move(file));
    }
    /// All chunks, whose checksums this process has computed. Throws corda::Error (kMismatch) if one is gone.
    [[nodiscard]] ChunkRun all_chunks() const {
        ChunkRun run;
        run.frames = frames_;
        for (const auto& [number, file] : there_) {
            const std::int64_t next = folder_.manifest().first_chunk() + std::ssize(run.chunks);
            if (number != next || !is_there(file.path)) {
                run.gap = next;
                throw_error(ExitCode::kMismatch, "{} in '{}': --resume makes it again",
                            gap_text(run, folder_.manifest()), place());
            }
            run.chunks.push_back(file);
        }
        return run;
    }
    /// That of the video, or of the lossless frames of an animation.
    [[nodiscard]] std::string chunk_ending() const {
        return output_.format.ending->kind == FileKind::kAnimation ? ".mov" : output_.format.ending->text;
    }

    /// Adds to a failure to write where the chunks are that were written before it.
    template <class Work>
    void telling_what_is_kept(const Work& work) {
        try {
            work();
        } catch (const Error& error) {
            if (error.code() != ExitCode::kIo || (folder_.is_named() && frames_ == 0)) throw;
            const bool is_taken = !output_.force && is_there(output_.path);
            const std::string kept =
                folder_.is_named()
                    ? fmt::format("finished chunks are in '{}'; --resume{} continues it", folder_.path(),
                                  is_taken ? " --force" : "")
                    : fmt::format("'{}' was removed meanwhile, and its frames with it", folder_.path());
            throw_error(error.code(), "{}; {}", error.what(), kept);
        }
    }

    CheckedVideo output_;
    ChunkFolder folder_;
    std::map<std::int64_t, ChunkFile> there_;  ///< by number
    std::set<std::int64_t> damaged_;
    std::int64_t frames_ = 0;
};

/// A file for each frame, complete as soon as it has its name.
class PictureSink : public VideoSink {
  public:
    explicit PictureSink(const CheckedVideo& output)
        : pattern_(output.path), force_(output.force), first_(output.first) {
        const std::filesystem::path path(pattern_);
        const std::string folder = path.parent_path().string();
        if (!folder.empty()) make_folder(folder);
        const std::filesystem::path lock_file =
            path.parent_path() / ("." + path.filename().string() + ".lock");
        lock_.emplace(lock_file.string(), output.first, output.end, fmt::format("frames of '{}'", pattern_));
        remove_leftovers(folder.empty() ? "." : folder,
                         [this](const std::string& name) { return is_picture_name(pattern_, name); });
    }

    [[nodiscard]] std::int64_t frames() const override { return frames_; }
    void add(std::int64_t /*number*/, Chunk chunk) override {
        for (const Packet& packet : chunk.packets) {
            save_file(picture_name(pattern_, first_ + frames_), bytes_of(*packet), {.force = force_});
            ++frames_;
        }
    }
    [[nodiscard]] std::string place() const override { return pattern_; }

  private:
    std::string pattern_;
    bool force_;
    std::int64_t first_;
    std::int64_t frames_ = 0;
    std::optional<RangeLock> lock_;
};

/// Standard output: YUV4MPEG2, or pixels without a header.
class StreamSink : public VideoSink {
  public:
    explicit StreamSink(const CheckedVideo& output)
        : def_(output.def), pixel_format_(output.format.pixel_format) {}

    [[nodiscard]] std::int64_t frames() const override { return frames_; }
    void add(std::int64_t /*number*/, Chunk chunk) override {
        const bool has_headers = pixel_format_ != "rgba";
        for (const Packet& packet : chunk.packets) {
            is_cut_ = true;
            if (has_headers) put(frames_ == 0 ? header() + "FRAME\n" : "FRAME\n");
            put(bytes_of(*packet));
            is_cut_ = false;
            ++frames_;
        }
    }
    [[nodiscard]] std::string place() const override {
        return is_cut_ ? "standard output, perhaps with a part of the next one" : "standard output";
    }

  private:
    void put(std::string_view bytes) const {
        const int status = write_all(STDOUT_FILENO, bytes);
        if (status == EPIPE) throw ReaderLeft();
        if (status != 0) fail_file("write to", "standard output", status);
    }

    [[nodiscard]] std::string header() const {
        const Rational fps = def_.fps.rational();
        return fmt::format("YUV4MPEG2 W{} H{} F{}:{} Ip A1:1 {} XCOLORRANGE=LIMITED\n", def_.width_px,
                           def_.height_px, fps.num, fps.den,
                           pixel_format_ == "yuv420p" ? "C420mpeg2 XYSCSS=420MPEG2" : "C444 XYSCSS=444");
    }

    VideoDef def_;
    std::string_view pixel_format_;
    std::int64_t frames_ = 0;
    bool is_cut_ = false;  ///< the last frame, or that may be
};

std::unique_ptr<VideoSink> make_sink(const CheckedVideo& output, Manifest manifest) {
    switch (output.format.ending->kind) {
        case FileKind::kPictures:
            return std::make_unique<PictureSink>(output);
        case FileKind::kStream:
            return std::make_unique<StreamSink>(output);
        case FileKind::kVideo:
        case FileKind::kAnimation:
            break;
    }
    return std::make_unique<FolderSink>(output, std::move(manifest));
}

Manifest manifest_of(const CheckedVideo& output, const VideoMetadata& metadata) {
    auto comment = nlohmann::json::parse(metadata.comment_json, nullptr, false);
    if (!comment.is_object())
        throw_usage("the video comment is not a JSON object: {}", metadata.comment_json);
    comment["fps"] = output.def.fps.rational().text();
    if (output.format.codec->crf) comment["crf"] = output.format.crf_of(output.def.encoder);
    return {.made_from = metadata.made_from,
            .fps = output.def.fps.rational(),
            .loop = output.def.loop,
            .first = output.first,
            .end = output.end,
            .per_chunk = frames_per_chunk(output.format, output.def.fps),
            .title = metadata.title,
            .comment = comment.dump()};
}

void number_packets(const Chunk& chunk) {
    for (std::int64_t frame = 0; const Packet& packet : chunk.packets) {
        if (packet->pts != frame)
            throw Error(ExitCode::kInternal, "an encoder has given the frames of a chunk in another order");
        packet->dts = frame++;
        packet->duration = 1;
    }
}

/// Refuses to replace existing files. The folder is made if there is none.
void check_pictures(const std::string& pattern, const std::string& input, bool force, std::int64_t first,
                    std::int64_t end) {
    const std::string folder = std::filesystem::path(pattern).parent_path().string();
    check_folder(folder);
    if (!folder.empty() && !is_there(folder)) return;
    for (std::int64_t k = first; k < end; ++k) check_output(picture_name(pattern, k), input, force);
}

}  // namespace

ChunkFolder::Use CheckedVideo::use() const {
    if (shard) return ChunkFolder::Use::kShare;
    if (resume) return ChunkFolder::Use::kContinue;
    return force ? ChunkFolder::Use::kReplace : ChunkFolder::Use::kNew;
}

CheckedVideo check_video_output(CheckedVideo video, const std::string& input, bool is_transparent) {
    check_video_def(video.def);
    video.format = find_format(video.path, video.def, is_transparent);
    if (video.format.codec->is_hardware) static_cast<void>(make_encoder(video.format, video.def));
    const std::int64_t known_end = video.end == CheckedVideo::kNoEnd ? video.first : video.end;
    const FileKind kind = video.format.ending->kind;
    if (kind == FileKind::kVideo || kind == FileKind::kAnimation) {
        check_output(video.path, input, video.force);
        ChunkFolder::check(parts_path(video.path), video.use());
    } else if (video.resume || video.shard) {
        throw_usage(
            "{} has no chunk files, which {} needs; render the frames that are missing (--frames FIRST:END)",
            video.path, video.resume ? "--resume" : "--shard");
    } else if (kind == FileKind::kPictures) {
        check_pictures(video.path, input, video.force, video.first, known_end);
    }
    return video;
}

VideoWriter::VideoWriter(const CheckedVideo& output, VideoMetadata metadata)
    : output_(output),
      metadata_(std::move(metadata)),
      manifest_(manifest_of(output_, metadata_)),
      sink_(make_sink(output_, manifest_)),
      next_(output_.first) {
    skip_chunks_that_are_there();
}

VideoWriter::VideoWriter(const std::string& path, const VideoDef& def, const VideoMetadata& metadata,
                         const OutputOptions& options)
    : VideoWriter(
          check_video_output({.path = path, .def = def, .force = options.force}, "", metadata.is_transparent),
          metadata) {}

VideoWriter::~VideoWriter() = default;

void VideoWriter::write(const Image& frame, const Damage& damage) {
    if (frame.width() != output_.def.width_px || frame.height() != output_.def.height_px) {
        throw_error(ExitCode::kInternal, "a frame of {}x{} was written to a video of {}x{}", frame.width(),
                    frame.height(), output_.def.width_px, output_.def.height_px);
    }
    if (!encoder_) encoder_ = std::make_unique<ChunkEncoder>(chunk_encoder(next_));
    const bool ends_chunk = next_ + encoder_->frames() + 1 == manifest_.end_of(next_ / manifest_.per_chunk);
    encoder_->encode(frame, damage, ends_chunk);
    if (ends_chunk) end_chunk();
}

void VideoWriter::append(Chunk chunk) {
    if (chunk.frames == 0) return;
    number_packets(chunk);
    next_ = chunk.first + chunk.frames;
    const std::int64_t number = chunk.first / manifest_.per_chunk;
    sink_->add(number, std::move(chunk));
    skip_chunks_that_are_there();
}

void VideoWriter::skip_chunks_that_are_there() {
    while (next_ < output_.end && !sink_->lacks(next_ / manifest_.per_chunk))
        next_ = manifest_.end_of(next_ / manifest_.per_chunk);
}

void VideoWriter::end_chunk() {
    const auto ended = std::exchange(encoder_, nullptr);
    if (ended) append(ended->finish());
}

std::vector<std::int64_t> VideoWriter::lacking_chunks() const {
    std::vector<std::int64_t> chunks;
    for (std::int64_t chunk = manifest_.first_chunk(); chunk < manifest_.end_chunk(); ++chunk)
        if (sink_->lacks(chunk)) chunks.push_back(chunk);
    return chunks;
}

std::vector<std::int64_t> VideoWriter::damaged_chunks() const {
    return sink_->damaged();
}

ChunkEncoder VideoWriter::chunk_encoder(std::int64_t frame) const {
    return {make_encoder(output_.format, output_.def, frame, metadata_.picture_info), frame};
}

std::int64_t VideoWriter::frames() const {
    return sink_->frames() + (encoder_ ? encoder_->frames() : 0);
}

void VideoWriter::finish(VerifyDepth depth, const OnProgress& on_progress) {
    end_chunk();
    if (frames() == 0 && !output_.shard)
        throw_usage("'{}' would have no frame; ask for a duration of at least one frame", output_.path);
    const bool takes_all = depth == VerifyDepth::kKeyFrames && output_.format.codec->verifies_all;
    sink_->finish({.depth = takes_all ? VerifyDepth::kAllFrames : depth,
                   .jobs = output_.def.encoder.jobs,
                   .on_progress = on_progress});
}

std::string VideoWriter::abandon() {
    constexpr double kMomentS = 0.4;  // for the frames that the encoder holds back
    try {
        const CancelScope moment([end_s = now_s() + kMomentS] { return now_s() < end_s; },
                                 CancelScope::Outer::kIgnored);
        end_chunk();
    } catch (const Error& error) {
        if (!is_interruption(error.code())) throw;
    }
    return frames() == 0 ? "" : sink_->place();
}

std::vector<std::string> video_files(const CheckedVideo& video, const VideoMetadata& metadata,
                                     const std::vector<Chunk>& chunks) {
    if (video.format.ending->kind != FileKind::kVideo) {
        std::vector<std::string> files;
        for (const Chunk& chunk : chunks)
            for (const Packet& packet : chunk.packets) files.emplace_back(bytes_of(*packet));
        return files;
    }
    for (const Chunk& chunk : chunks) number_packets(chunk);
    return {join_in_memory(chunks, manifest_of(video, metadata), video.format)};
}

}  // namespace corda::media
