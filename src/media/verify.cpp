#include "corda/media/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>

#include "corda/core/file.hpp"
#include "corda/media/checked.hpp"
#include "corda/media/color_patch.hpp"
#include "corda/media/libav_handles.hpp"
#include "corda/media/mp4_boxes.hpp"
#include "corda/media/verify_decode.hpp"

namespace corda::media {
namespace {

using Json = nlohmann::json;

template <typename... Args>
void problem(VerifyReport& report, fmt::format_string<Args...> text, Args&&... args) {
    report.problems.push_back(fmt::format(text, std::forward<Args>(args)...));
}

/// A whole number from JSON of any origin; std::nullopt if it is something else.
std::optional<std::int64_t> whole_number(const Json& json) {
    if (!json.is_number_integer()) return std::nullopt;
    return json.get<std::int64_t>();
}

/// The comment as a JSON object; an empty one for any other text.
Json parse_comment(const std::string& comment) {
    Json json = Json::parse(comment, nullptr, false);
    return json.is_object() ? json : Json::object();
}

std::optional<ColorPatch> parse_patch(const Json& json) {
    if (!json.is_array() || json.size() != 5) return std::nullopt;
    std::array<int, 5> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto value = whole_number(json[i]);
        if (!value || *value < 0 || *value > (i < 2 ? 65535 : 255)) return std::nullopt;
        values[i] = static_cast<int>(*value);
    }
    return ColorPatch{values[0],
                      values[1],
                      {static_cast<std::uint8_t>(values[2]), static_cast<std::uint8_t>(values[3]),
                       static_cast<std::uint8_t>(values[4])}};
}

std::vector<ColorPatch> patches_of(const std::string& comment) {
    const Json json = parse_comment(comment);
    std::vector<ColorPatch> patches;
    if (!json.contains("patches") || !json["patches"].is_array()) return patches;
    for (const Json& entry : json["patches"]) {
        if (const auto patch = parse_patch(entry)) patches.push_back(*patch);
    }
    return patches;
}

/// libav's name for the kind of a file, judged by its beginning: "matroska,webm", "png_pipe"; empty if it
/// knows none.
std::string probed_container(const std::string& path) {
    const FileHandle file = open_for_reading(path);
    std::vector<unsigned char> head(4096 + AVPROBE_PADDING_SIZE);
    const std::size_t count = std::fread(head.data(), 1, head.size() - AVPROBE_PADDING_SIZE, file.get());
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

/// Checks the container; false if it holds no stream to decode.
bool check_container(const std::string& path, const Mp4Boxes& boxes, VerifyReport& report) {
    if (!boxes.is_mp4) {
        report.container = probed_container(path);
        problem(
            report,
            "this is not an MP4 file (libav takes it for {}); render it again, or give the name of an MP4",
            report.container.empty() ? "an unknown kind" : report.container);
        return false;
    }
    report.container = boxes.fragmented ? "mp4 (fragmented)" : "mp4";
    if (!boxes.has_index) {
        problem(
            report,
            "the index (moov box) is missing: writing was interrupted, or the file was cut; render it again, "
            "or make its .part file a video by corda recover");
        return false;
    }
    report.faststart = boxes.index_first && !boxes.fragmented;
    if (!boxes.whole) problem(report, "the file breaks off in the middle of a box; copy or render it again");
    return true;
}

/// Checks that a browser can seek at once.
void check_index(const Mp4Boxes& boxes, VerifyReport& report) {
    if (report.faststart) return;
    problem(
        report,
        "{}; remedy: ffmpeg -i FILE -c copy -video_track_timescale {} -movie_timescale {} "
        "-movflags +faststart NEW.mp4",
        boxes.fragmented
            ? "the file is still in fragments, as a .part file is: it plays, but a browser cannot seek in it"
            : "the index stands behind the pictures, so a browser must load the whole file before it starts",
        report.fps.num, report.fps.num);
}

void fill_report(const DecodedVideo& video, VerifyReport& report) {
    report.codec = video.codec;
    report.profile = video.profile;
    report.pixel_format = video.pixel_format;
    report.width_px = video.width_px;
    report.height_px = video.height_px;
    report.frames = video.frames;
    report.range = video.range;
    report.matrix = video.matrix;
    report.primaries = video.primaries;
    report.transfer = video.transfer;
    report.chroma_location = video.chroma_location;
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
    if (video.frames == 0) {
        problem(report, "no frame can be decoded; render it again");
    }
}

void check_stamps(const DecodedVideo& video, VerifyReport& report) {
    if (video.frames == 0) return;
    if (video.first_pts != 0) {
        problem(
            report,
            "the first frame is shown at tick {} instead of 0, so players start with a gap; render it again",
            video.first_pts);
    }
    if (video.uneven_at >= 0) {
        problem(
            report,
            "the frame rate is not constant: frame {} is not {} ticks after the one before; render it again",
            video.uneven_at, video.step);
    } else if (report.fps.num <= 0) {
        problem(report, "the frames have no duration, so there is no frame rate; render it again");
    }
}

/// Checks the stored clocks and durations, which are whole numbers and must agree exactly.
void check_clocks(const DecodedVideo& video, const Mp4Boxes& boxes, VerifyReport& report) {
    if (boxes.fragmented || video.frames == 0 || report.fps.num <= 0 || video.uneven_at >= 0) return;
    const auto num = static_cast<std::uint64_t>(report.fps.num);
    const auto exact = checked_multiply(static_cast<std::uint64_t>(video.frames),
                                        static_cast<std::uint64_t>(report.fps.den));  // ticks of 1/num s
    // A multiple of the numerator is exact as well.
    const auto fits = [num](std::uint32_t scale) { return scale > 0 && scale % num == 0; };
    if (!fits(boxes.track_timescale) || !fits(boxes.movie_timescale)) {
        problem(
            report,
            "the clocks (track 1/{} s, movie 1/{} s) cannot count frames of {} fps without rounding; "
            "write it again with both time scales = {} (ffmpeg: -video_track_timescale, -movie_timescale)",
            boxes.track_timescale, boxes.movie_timescale, report.fps.text(), num);
        return;
    }
    const auto movie_ticks = exact ? checked_multiply(*exact, boxes.movie_timescale / num) : std::nullopt;
    const auto track_ticks = exact ? checked_multiply(*exact, boxes.track_timescale / num) : std::nullopt;
    std::optional<std::uint64_t> edit_ticks = 0;
    for (const Mp4Edit& edit : boxes.edits)
        if (edit_ticks) edit_ticks = checked_add(*edit_ticks, edit.duration);
    const bool edits_agree = boxes.edits.empty() || edit_ticks == movie_ticks;
    if (!movie_ticks || boxes.movie_duration != movie_ticks || boxes.track_presentation != movie_ticks ||
        boxes.track_duration != track_ticks || !edits_agree) {
        problem(report,
                "the stored durations (movie {}/{} s, track {}/{} s) are not exactly {} frames at {} fps = "
                "{}/{} s; joining such files drifts: render it again",
                boxes.movie_duration, boxes.movie_timescale, boxes.track_duration, boxes.track_timescale,
                video.frames, report.fps.text(), exact.value_or(0), num);
    }
}

void check_picture_format(const DecodedVideo& video, VerifyReport& report) {
    if (video.frames == 0) return;
    static const std::vector<std::string> playable{"Constrained Baseline", "Baseline", "Main", "High"};
    if (report.codec != "h264") {
        problem(report, "the codec is {}; browsers and QuickTime play H.264 everywhere: render with libx264",
                report.codec);
    } else if (std::find(playable.begin(), playable.end(), report.profile) == playable.end()) {
        problem(report,
                "the H.264 profile is {}, which browsers and QuickTime refuse; encode High with yuv420p",
                report.profile);
    }
    if (report.pixel_format != "yuv420p") {
        problem(report,
                "the pixel format is {}; only 8-bit yuv420p plays everywhere: encode with -pix_fmt yuv420p",
                report.pixel_format);
    }
}

void check_tag(VerifyReport& report, const char* name, const std::string& value, std::string_view wanted,
               std::string_view effect) {
    if (value == wanted) return;
    problem(report, "the {} tag is '{}' instead of '{}': {}; render it again, or set the tag", name, value,
            wanted, effect);
}

void check_tags(const DecodedVideo& video, VerifyReport& report) {
    if (report.frames == 0) return;
    if (video.container_tags != "tv bt709 bt709 iec61966-2-1") {
        problem(report,
                "the container's colour tags (colr box: {}) are not 'tv bt709 bt709 iec61966-2-1', and "
                "QuickTime trusts them more than the stream's own; render it again",
                video.container_tags);
    }
    check_tag(report, "range", report.range, "tv", "players may crush or wash out black and white");
    check_tag(report, "matrix", report.matrix, "bt709", "players may guess BT.601 and shift the colours");
    check_tag(report, "primaries", report.primaries, "bt709", "wide-gamut screens may over-saturate");
    check_tag(report, "transfer", report.transfer, "iec61966-2-1",
              "Safari and QuickTime change the brightness");
    check_tag(report, "chroma location", report.chroma_location, "left",
              "coloured edges shift by half a pixel");
}

void check_patches(const std::vector<ColorPatch>& patches, const DecodedVideo& video, int crf,
                   VerifyReport& report) {
    if (patches.empty() || video.frames == 0) return;
    if (patches.size() != video.patch_means.size()) {
        problem(report,
                "the comment names colour patches outside the picture; the picture was cropped or scaled");
        return;
    }
    const double limit = patch_tolerance(crf);
    for (std::size_t i = 0; i < patches.size(); ++i) {
        const auto& mean = video.patch_means[i];
        const auto rgb = rgb_from_ycbcr(mean[0], mean[1], mean[2]);
        double worst = 0.0;
        for (int c = 0; c < 3; ++c)
            worst = std::max(worst, std::abs(std::clamp(rgb[c], 0.0, 255.0) - patches[i].rgb[c]));
        if (worst <= limit) continue;
        problem(report,
                "at ({}, {}) the first frame shows R'G'B' {:.1f} {:.1f} {:.1f} but {} {} {} was rendered "
                "({:.1f} off, limit {:.1f}): the colours were converted wrongly, or the video was encoded "
                "again",
                patches[i].x, patches[i].y, rgb[0], rgb[1], rgb[2], patches[i].rgb[0], patches[i].rgb[1],
                patches[i].rgb[2], worst, limit);
    }
}

/// Compares what the file says about itself with what was found; whether that was colours too.
bool check_comment(const DecodedVideo& video, VerifyReport& report) {
    const Json json = parse_comment(video.comment);
    if (!json.contains("fps") && !json.contains("frames")) {
        report.notes.emplace_back(
            "not written by corda: frame count and colours cannot be compared with what was rendered");
        return false;
    }
    const auto frames = json.contains("frames") ? whole_number(json["frames"]) : std::nullopt;
    if (frames && *frames != report.frames) {
        problem(report, "{} frames were rendered but {} decode; render it again", *frames, report.frames);
    }
    const auto fps = json.contains("fps") && json["fps"].is_string()
                         ? Rational::parse(json["fps"].get<std::string>())
                         : std::nullopt;
    if (fps && report.frames > 0 && *fps != report.fps) {
        problem(report, "it was rendered for {} fps but plays at {} fps; render it again", fps->text(),
                report.fps.text());
    }
    const auto crf = json.contains("crf") ? whole_number(json["crf"]) : std::nullopt;
    const std::vector<ColorPatch> patches = patches_of(video.comment);
    check_patches(patches, video, crf ? static_cast<int>(std::clamp<std::int64_t>(*crf, 0, 51)) : 0, report);
    return !patches.empty();
}

void add_notes(bool saw_colors, VerifyDepth depth, VerifyReport& report) {
    if (!report.ok()) return;
    report.notes.push_back(
        fmt::format("checked: structure, time stamps, tags, that {} decodes, and {}; a picture that was "
                    "changed and still decodes is not found",
                    depth == VerifyDepth::kAllFrames ? "every frame" : "every key frame",
                    saw_colors ? "colours at a few places of the first frame alone" : "no colours"));
    report.notes.push_back(fmt::format(
        "H.264 {}, 8-bit 4:2:0: plays in Chrome, Edge, Firefox, Safari and QuickTime", report.profile));
    report.notes.emplace_back("the index comes first: a browser starts to play while it loads, and can seek");
    report.notes.push_back(fmt::format(
        "colours are tagged BT.709 with the sRGB transfer: browsers and QuickTime show the rendered sRGB "
        "values; a player that ignores tags {}",
        report.height_px >= 720 ? "guesses right"
                                : "may shift them, as it does in any video below 720 lines"));
    if (report.width_px > 4096 || report.height_px > 2304) {
        report.notes.emplace_back(
            "larger than 4096x2304: many phones and hardware decoders refuse this size");
    }
    if (report.fps.value() > 60.0) {
        report.notes.emplace_back("more than 60 frames per second: most screens drop frames");
    }
}

}  // namespace

VerifyReport verify(const std::string& path, const OnProgress& on_progress, VerifyDepth depth) {
    const LogCapture log;
    VerifyReport report;
    const Mp4Boxes boxes = read_mp4_boxes(path);
    if (!check_container(path, boxes, report)) return report;
    const DecodedVideo video = decode(path, depth, patches_of, on_progress);
    if (!video.opened) {
        problem(report, "{}; the file is damaged: copy or render it again", video.open_reason);
        return report;
    }
    fill_report(video, report);
    check_index(boxes, report);
    check_decoding(video, report);
    check_stamps(video, report);
    check_clocks(video, boxes, report);
    check_picture_format(video, report);
    check_tags(video, report);
    add_notes(check_comment(video, report), depth, report);
    return report;
}

}  // namespace corda::media
