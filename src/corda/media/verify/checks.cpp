#include "corda/media/verify/checks.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "corda/media/bytes.hpp"
#include "corda/media/format/format.hpp"

namespace corda::media {

bool check_boxes(const Mp4Boxes& boxes, VerifyReport& report) {
    report.container = boxes.is_quicktime ? "mov" : "mp4";
    if (boxes.fragmented) report.container += " (fragmented)";
    if (!boxes.has_index) {
        problem(
            report,
            "the index (moov box) is missing: writing was interrupted, or the file was cut; render it again, "
            "or join the chunks in its folder .parts (corda recover)");
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
            ? "the file is in fragments: it plays, but a browser "
              "cannot seek in it"
            : "the index stands behind the pictures, so a browser must load the whole file before it starts",
        copy_command(report, boxes.is_quicktime ? "mov" : "mp4"));
}

void check_clocks(const DecodedVideo& video, const Mp4Boxes& boxes, VerifyReport& report) {
    if (boxes.fragmented || report.frames == 0 || report.fps.num <= 0 || video.uneven_at >= 0) return;
    const auto num = static_cast<std::uint64_t>(report.fps.num);
    const auto exact = checked_multiply(static_cast<std::uint64_t>(report.frames),
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
                report.frames, report.fps.text(), exact.value_or(0), num);
    }
}

namespace {

bool holds_word(std::string_view words, std::string_view word) {
    for (std::size_t at = words.find(word); at != std::string_view::npos; at = words.find(word, at + 1)) {
        const bool begins = at == 0 || words[at - 1] == ' ';
        const bool ends = at + word.size() == words.size() || words[at + word.size()] == ' ';
        if (begins && ends) return true;
    }
    return false;
}

/// "mp4" of "mp4 (fragmented)".
std::string_view plain(std::string_view container) {
    return container.substr(0, container.find(' '));
}

/// The highest level that hardware and the programs of Codec::players decode.
constexpr int kMaxPlayedLevel = 52;

/// The least level for the size and the rate of a video, times 10; 0 if none allows them.
int least_level(const Codec& codec, const VerifyReport& report) {
    const auto blocks = [&](int side_px) {
        return std::int64_t{side_px + codec.level_block_px - 1} / codec.level_block_px;
    };
    const std::int64_t width = blocks(report.width_px);
    const std::int64_t height = blocks(report.height_px);
    const auto allows_side = [](std::int64_t side, int most, const Level& level) {
        return most > 0 ? side <= most : side * side <= 8 * level.picture;
    };
    const auto least = std::ranges::find_if(codec.levels, [&](const Level& level) {
        return width * height <= level.picture && allows_side(width, level.max_width, level) &&
               allows_side(height, level.max_height, level) &&
               static_cast<double>(width * height) * report.fps.value() <= static_cast<double>(level.per_s);
    });
    return least == codec.levels.end() ? 0 : least->times_10;
}

/// Why few programs play a video that has the right profile; empty if its level does not matter.
std::string level_problem(const VerifyReport& report) {
    const Codec* const codec = find_stream_codec(report.codec);
    if (codec == nullptr || codec->levels.empty()) return "";
    const int least = least_level(*codec, report);
    const std::string what =
        fmt::format("{}x{} at {} frames per second", report.width_px, report.height_px, report.fps.text());
    if (least == 0) return fmt::format("{} is beyond every level of {}", what, codec->standard);
    const int level = std::max(least, report.h264_level);
    return level <= kMaxPlayedLevel ? "" : fmt::format("{} takes level {:.1f}", what, level / 10.0);
}

/// A level that is stated too low.
void check_level(VerifyReport& report) {
    constexpr int kLevel1b = 9;  // or 11, and nothing needs it that does not need 1.1
    if (report.h264_level <= 0 || report.h264_level == kLevel1b) return;
    const int least = least_level(*find_stream_codec("h264"), report);
    if (least <= report.h264_level) return;
    problem(report,
            "the stated H.264 level is {:.1f}, and {}x{} at {} frames per second takes {:.1f}: decoders may "
            "refuse it; remedy: {}",
            report.h264_level / 10.0, report.width_px, report.height_px, report.fps.text(), least / 10.0,
            copy_command(report, report.container == "matroska" ? "mkv" : plain(report.container),
                         fmt::format("-bsf:v h264_metadata=level={} ", least / 10.0)));
}

/// True for an H.264 profile that browsers and QuickTime refuse; that of 4:4:4 has a row of its own.
bool has_odd_profile(const VerifyReport& report) {
    constexpr std::array<std::string_view, 4> kPlayable{"Constrained Baseline", "Baseline", "Main", "High"};
    const bool is_playable = std::ranges::find(kPlayable, report.profile) != kPlayable.end();
    const bool is_444 = report.profile == "High 4:4:4 Predictive" && report.pixel_format == "yuv444p";
    return report.codec == "h264" && !is_playable && !is_444;
}

std::span<const Players> players_of(std::string_view stream) {
    const Codec* const codec = find_stream_codec(stream);
    return codec == nullptr ? std::span<const Players>() : codec->players;
}

bool is_in(const VerifyReport& report, const Players& row) {
    return holds_word(row.containers, plain(report.container));
}

bool has_pixels(const VerifyReport& report, const Players& row) {
    return row.pixel_format.empty() || row.pixel_format == report.pixel_format;
}

void check_tag(VerifyReport& report, const char* name, const std::string& value, std::string_view wanted,
               std::string_view effect) {
    if (value == wanted) return;
    problem(report, "the {} tag is '{}' instead of '{}': {}; render it again, or set the tag", name, value,
            wanted, effect);
}

/// Whether colours need tags: kinds of pictures are sRGB by definition, raw video has none.
bool has_tags(const VerifyReport& report) {
    return !holds_word("gif yuv4mpegpipe", report.container);
}

}  // namespace

std::string VerifyReport::coding() const {
    std::string words = codec;
    if (!profile.empty()) words += ' ' + profile;
    if (h264_level > 0) words += fmt::format(" {:.1f}", h264_level / 10.0);
    return words;
}

void check_picture_format(const DecodedVideo& video, VerifyReport& report) {
    if (report.frames == 0) return;
    const std::span<const Players> players = players_of(report.codec);
    const bool is_in_usual_container =
        std::ranges::any_of(players, [&](const Players& row) { return is_in(report, row); });
    if (players.empty()) {
        problem(report, "the codec is {}; browsers and QuickTime play H.264 everywhere: render with libx264",
                report.codec);
    } else if (!is_in_usual_container) {
        const std::string_view all = players.front().containers;
        const std::string_view container = all.substr(0, all.find(' '));
        // A copy keeps milliseconds, which such clocks cannot count.
        const bool is_uneven = video.is_rounded && report.fps.den != 1 && container != "webm";
        problem(report, "few programs play {} in {}; remedy: {}", report.codec, plain(report.container),
                is_uneven ? fmt::format("encode it again, as .{}", container)
                          : copy_command(report, container == "matroska" ? "mkv" : container));
    }
    if (has_odd_profile(report)) {
        problem(report,
                "the H.264 profile is {}, which browsers and QuickTime refuse; encode High with yuv420p",
                report.profile.empty() ? "unknown" : report.profile);
    }
    check_level(report);
    if (video.codec_tag == "hev1") {
        problem(report, "H.265 is tagged hev1, which Safari and QuickTime refuse; remedy: {}",
                copy_command(report, plain(report.container)));
    }
    const bool is_playable = std::ranges::any_of(players, [&](const Players& row) {
        return (is_in(report, row) || !is_in_usual_container) && has_pixels(report, row);
    });
    if (players.empty() ? report.pixel_format != "yuv420p" : !is_playable) {
        problem(report,
                "the pixel format is {}; only 8-bit yuv420p plays everywhere: encode with -pix_fmt yuv420p",
                report.pixel_format);
    }
}

void check_tags(const DecodedVideo& video, VerifyReport& report) {
    if (report.frames == 0 || !has_tags(report)) return;
    // The colr box of QuickTime has no range.
    const std::string_view wanted = plain(report.container) == "mov" ? "unknown bt709 bt709 iec61966-2-1"
                                    : video.is_yuv                   ? "tv bt709 bt709 iec61966-2-1"
                                                                     : "pc gbr bt709 iec61966-2-1";
    if (video.container_tags != wanted) {
        problem(report,
                "the container's colour tags ({}{}) are not '{}', and "
                "QuickTime trusts them more than the stream's own; render it again",
                holds_word("mp4 mov", plain(report.container)) ? "colr box: " : "", video.container_tags,
                wanted);
    }
    if (!video.is_yuv) return;  // the tags of the container are all
    check_tag(report, "range", report.range, "tv", "players may crush or wash out black and white");
    check_tag(report, "matrix", report.matrix, "bt709", "players may guess BT.601 and shift the colours");
    check_tag(report, "primaries", report.primaries, "bt709", "wide-gamut screens may over-saturate");
    check_tag(report, "transfer", report.transfer, "iec61966-2-1",
              "Safari and QuickTime change the brightness");
    // VP9 and AV1 state no siting, or another one.
    if ((report.codec == "h264" || report.codec == "hevc") && report.pixel_format == "yuv420p") {
        check_tag(report, "chroma location", report.chroma_location, "left",
                  "coloured edges shift by half a pixel");
    }
}

void add_notes(const DecodedVideo& video, VerifyDepth depth, VerifyReport& report) {
    const std::string trouble = level_problem(report);
    const std::span<const Players> players = players_of(report.codec);
    const auto row = std::ranges::find_if(
        players, [&](const Players& each) { return is_in(report, each) && has_pixels(report, each); });
    if (!trouble.empty() && !has_odd_profile(report)) {
        report.notes.push_back(fmt::format(
            "{}, {}: {}: VLC, mpv and ffmpeg play it, browsers only without the hardware's decoder; "
            "QuickTime, PowerPoint and phones refuse it; for those, render fewer pixels or frames{}",
            report.coding(), report.pixel_format, trouble,
            report.codec == "h264" && least_level(*find_stream_codec("av1"), report) > 0
                ? ", or take H.265 or AV1"
                : ""));
    } else if (row != players.end() && !has_odd_profile(report)) {
        report.notes.push_back(fmt::format("{}, {}: {}", report.coding(), report.pixel_format, row->words));
    }
    if (!report.ok()) return;
    report.notes.push_back(fmt::format(
        "checked: structure, time stamps, tags, that {} decodes, and {}; a picture that was "
        "changed and still decodes is not found",
        depth == VerifyDepth::kAllFrames ? "every frame" : "every key frame",
        !video.patches.empty() ? "colours at a few places of the first frame alone" : "no colours"));
    if (report.alpha)
        report.notes.emplace_back("the first frame is transparent in places; alpha is straight");
    if (video.is_rounded) {
        report.notes.push_back(
            fmt::format("the container counts {}: each frame's time is the nearest one to k/fps{}",
                        report.container == "gif" ? "hundredths of a second" : "milliseconds",
                        report.container == "gif" ? "" : ", the rate is the one stated in the file"));
    }
    if (report.faststart)
        report.notes.emplace_back(
            "the index comes first: a browser starts to play while it loads, and can seek");
    if (holds_word("mp4 webm mov", report.container))
        report.notes.push_back(
            fmt::format("to show frame k in a browser, seek to its middle, (k + 1/2)/fps = {:.6g} s for "
                        "frame 0: at k/fps browsers may show the frame before",
                        0.5 / report.fps.value()));
    if (has_tags(report) && video.is_yuv)
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

}  // namespace corda::media
