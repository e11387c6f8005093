#include <fmt/format.h>

#include <optional>
#include <string>

#include "corda/media/bytes.hpp"
#include "corda/media/verify/checks.hpp"

namespace corda::media {

bool check_boxes(const Mp4Boxes& boxes, VerifyReport& report) {
    report.container = boxes.is_quicktime ? "mov" : "mp4";
    if (boxes.fragmented) report.container += " (fragmented)";
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

std::string copy_command(const VerifyReport& report, std::string_view ending, std::string_view before) {
    std::string options(before);
    if (ending == "mp4" || ending == "mov") {
        if (report.codec == "hevc") options += "-tag:v hvc1 ";
        if (report.fps.num > 0)
            options += fmt::format("-video_track_timescale {0} -movie_timescale {0} ", report.fps.num);
        options += "-movflags +faststart ";
    }
    return fmt::format("ffmpeg -i FILE -c copy {}NEW.{}", options, ending);
}

void check_index(const Mp4Boxes& boxes, VerifyReport& report) {
    if (report.faststart) return;
    problem(
        report, "{}; remedy: {}",
        boxes.fragmented
            ? "the file is still in fragments, as a .part file is: it plays, but a browser cannot seek in it"
            : "the index stands behind the pictures, so a browser must load the whole file before it starts",
        copy_command(report, boxes.is_quicktime ? "mov" : "mp4"));
}

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

}  // namespace corda::media
