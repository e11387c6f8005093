#include "corda/media/verify/verify.hpp"

#include <algorithm>
#include <optional>

#include "corda/core/file.hpp"
#include "corda/media/bytes.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/format/format.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/read/color_patch.hpp"
#include "corda/media/read/containers.hpp"
#include "corda/media/read/video_comment.hpp"
#include "corda/media/verify/checks.hpp"

namespace corda::media {
namespace {

/// libav's name for the kind of a file, judged by its beginning: "matroska,webm", "png_pipe"; empty if it
/// knows none.
std::string probed_container(const std::string& path) {
    const FileHandle file = open_for_reading(path);
    std::vector<unsigned char> head(4096 + AVPROBE_PADDING_SIZE);
    const std::size_t count =
        read_bytes(file, path, reinterpret_cast<char*>(head.data()), head.size() - AVPROBE_PADDING_SIZE);
    if (count == 0) return {};
    std::fill(head.begin() + static_cast<std::ptrdiff_t>(count), head.end(), static_cast<unsigned char>(0));
    AVProbeData data{};
    data.filename = "";
    data.buf = head.data();
    data.buf_size = static_cast<int>(count);
    int score = 0;
    const AVInputFormat* format = av_probe_input_format3(&data, 1, &score);
    return format != nullptr && score >= AVPROBE_SCORE_EXTENSION ? format->name : "";
}

/// Computes rate and duration.
void fill_times(const DecodedVideo& video, VerifyReport& report) {
    if (video.tick.den <= 0 || video.tick.num <= 0) return;
    const auto step = checked_multiply(video.step, video.tick.num);
    if (step && *step > 0) report.fps = Rational::reduced(video.tick.den, *step);
    const auto duration = checked_multiply(video.end - video.first_pts, video.tick.num);
    if (duration) report.duration_s = Rational::reduced(*duration, video.tick.den);
}

void check_decoding(const DecodedVideo& video, VerifyReport& report) {
    if (video.bad_frames > 0) {
        problem(report,
                "{} packets or frames do not decode cleanly (first: {}); the file is damaged: copy or render "
                "it again",
                video.bad_frames, video.bad_reason);
    }
    if (report.frames == 0) {
        problem(report, "no frame can be decoded; render it again");
    }
}

void check_stamps(const DecodedVideo& video, VerifyReport& report) {
    if (report.frames == 0) return;
    if (video.first_pts != 0) {
        problem(
            report,
            "the first frame is shown at tick {} instead of 0, so players start with a gap; render it again",
            video.first_pts);
    }
    if (video.uneven_at >= 0) {
        problem(report,
                "the frame rate is not constant: frame {} is not {} ticks after the previous frame; render "
                "it again",
                video.uneven_at, video.step);
    } else if (report.fps.num <= 0) {
        problem(report, "the frames have no duration, so there is no frame rate; render it again");
    }
}

/// The largest error that a patch of a correct video may have.
double tolerance_of(const DecodedVideo& video, const VerifyReport& report) {
    const Codec* const codec = find_stream_codec(report.codec);
    if (codec != nullptr && codec->tolerance > 0.0) return codec->tolerance;
    // Rate factors go up to 51 for H.264 and H.265, and to 63 for others.
    const std::int64_t most = codec != nullptr && codec->crf ? codec->crf->second : 63;
    const auto crf = std::clamp<std::int64_t>(comment_number(video.comment, "crf").value_or(0), 0, most);
    const bool is_coarse = codec != nullptr && codec->has_coarse_444 && report.pixel_format == "yuv444p";
    return patch_tolerance(static_cast<int>(crf * 51 / most), is_coarse);
}

void check_patches(const DecodedVideo& video, VerifyReport& report) {
    const double limit = tolerance_of(video, report);
    for (const ShownPatch& patch : video.patches) {
        if (!patch.rgb) {
            problem(
                report,
                "the comment names colour patches outside the picture; the picture was cropped or scaled");
            return;
        }
        const auto& rgb = *patch.rgb;
        const auto& rendered = patch.rendered.rgb;
        const double worst = patch_error(patch.rendered, rgb);
        if (worst <= limit) continue;
        problem(
            report,
            "at ({}, {}) frame {} shows R'G'B' {:.1f} {:.1f} {:.1f} but {} {} {} was rendered ({:.1f} off, "
            "limit {:.1f}): the colours were converted wrongly, or the video was encoded again",
            patch.rendered.x, patch.rendered.y, patch.frame, rgb[0], rgb[1], rgb[2], rendered[0], rendered[1],
            rendered[2], worst, limit);
    }
}

/// Compares the metadata of the file with its content.
void check_comment(const DecodedVideo& video, VerifyReport& report) {
    if (const std::string found = comment_problem(video.comment); !found.empty()) {
        problem(report, "the comment {}; corda writes none like it: remove it by {}", found,
                copy_command(report, report.container == "matroska" ? "mkv" : report.container,
                             "-metadata comment= "));
        return;
    }
    const auto fps = comment_rate(video.comment);
    const auto frames = comment_number(video.comment, "frames");
    if (!fps && !frames) {
        report.notes.emplace_back(
            "the file does not say what corda rendered: frame count and colours cannot be compared with it");
        return;
    }
    if (frames && *frames != report.frames) {
        problem(report, "{} frames were rendered but {} decode; render it again", *frames, report.frames);
    }
    if (fps && report.frames > 0 && *fps != report.fps) {
        problem(report, "it was rendered for {} fps but plays at {} fps; render it again", fps->text(),
                report.fps.text());
    }
}

/// The container of a kind of file, in words.
std::string container_of(const std::string& kind, const std::string& path) {
    if (kind != "matroska") return kind;
    return first_bytes(path, 64).find("webm") != std::string::npos ? "webm" : "matroska";
}

/// The problem of a file of no known kind.
void refuse(const std::string& path, VerifyReport& report) {
    if (const ForeignKind* const foreign = foreign_kind_of(path); foreign != nullptr) {
        problem(report, "this is no video: it is {}; {}", foreign->words,
                foreign->remedy == kConvertToPng ? "give a video" : foreign->remedy);
        return;
    }
    report.container = probed_container(path);
    problem(
        report,
        "this is not an MP4 file, nor of another kind that corda writes (libav takes it for {}); render it "
        "again, or give the name of a video",
        report.container.empty() ? "an unknown kind" : report.container);
}

}  // namespace

VerifyReport verify(const std::string& path, VerifyDepth depth, const std::vector<FrameColors>& rendered,
                    std::optional<Rational> fps) {
    const LogCapture log;
    VerifyReport report;
    const std::string kind = file_kind(path);
    const Mp4Boxes boxes = kind == "mov" ? read_mp4_boxes(path) : Mp4Boxes{};
    report.container = container_of(kind, path);
    if (kind.empty()) refuse(path, report);
    if (kind == "mov") check_boxes(boxes, report);
    if (is_truncated(path, kind))
        problem(report, "the file breaks off before its end; copy or render it again");
    if (kind.empty() || (kind == "mov" && !boxes.has_index)) return report;
    const DecodedVideo video = decode(path, depth, fps, rendered, report);
    if (!video.opened) {
        problem(report, "{}; the file is damaged: copy or render it again", video.open_reason);
        return report;
    }
    fill_times(video, report);
    check_decoding(video, report);
    check_stamps(video, report);
    if (kind == "mov") {
        check_index(boxes, report);
        check_clocks(video, boxes, report);
    }
    check_picture_format(video, report);
    check_tags(video, report);
    check_comment(video, report);
    check_patches(video, report);
    add_notes(video, depth, report);
    return report;
}

}  // namespace corda::media
