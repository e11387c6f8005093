#include "time_options.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/timeline.hpp"

namespace corda::app {
namespace {

/// So many pictures are a video.
constexpr std::int64_t kMaxTimes = 100'000;

/// Reads a whole number into `frame`; false for any other text.
template <typename Frame>
bool parse_frame(std::string_view text, Frame& frame) {
    std::int64_t value = 0;
    const auto [stop, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    frame = value;
    return status == std::errc{} && stop == text.data() + text.size();
}

/// The frames that a word of `--frame` names.
FrameRange frames_of(const std::string& word, const Scene& scene) {
    const std::int64_t count = scene.video.fps.frame_count(scene.world.duration_s);
    FrameRange range;
    if (parse_frame(word, range.first)) {
        range.end = range.first + (range.first < count ? 1 : 0);
    } else if (const auto parsed = parse_frame_range(word)) {
        range = *parsed;
    } else {
        throw Error(ExitCode::kUsage,
                    fmt::format("--frame {}: is neither a frame number nor a range FIRST:END of them", word));
    }
    const std::int64_t end = range.end.value_or(count);
    if (range.first < 0 || range.first >= end || end > count) {
        throw Error(ExitCode::kUsage,
                    fmt::format("--frame {}: the frames are 0 to {}, all of them the range 0:{}; "
                                "world.duration sets the end",
                                word, count - 1, count));
    }
    return {range.first, end};
}

}  // namespace

std::optional<FrameRange> parse_frame_range(std::string_view text) {
    FrameRange range;
    const auto colon = text.find(':');
    const bool is_range = colon != std::string_view::npos &&
                          (colon == 0 || parse_frame(text.substr(0, colon), range.first)) &&
                          (colon + 1 == text.size() || parse_frame(text.substr(colon + 1), range.end));
    return is_range ? std::optional(range) : std::nullopt;
}

void TimeOptions::add_to(CLI::App& command) {
    auto* at = command.add_option("--at", times_s, "times in seconds, e.g. 0,0.5,1.25")
                   ->delimiter(',')
                   ->type_name("T[,T...]");
    auto* frame =
        command.add_option("--frame", frames, "frames of the video from 0, or ranges FIRST <= k < END")
            ->delimiter(',')
            ->type_name("K|FIRST:END[,...]");
    at->excludes(frame);
}

void TimeOptions::require() const {
    if (times_s.empty() && frames.empty()) throw CLI::RequiredError("--at or --frame");
}

std::vector<RequestedTime> TimeOptions::list(const Scene& scene) const {
    std::vector<RequestedTime> shots;
    for (const double time_s : times_s) {
        const auto within_s = time_within(time_s, scene.world.duration_s);
        if (!within_s) {
            throw Error(ExitCode::kUsage,
                        fmt::format("--at {}: is not within 0 .. {} s; world.duration sets the end", time_s,
                                    scene.world.duration_s));
        }
        shots.push_back({*within_s, std::nullopt});
    }
    for (const std::string& word : frames) {
        const FrameRange range = frames_of(word, scene);
        const auto count = static_cast<std::int64_t>(shots.size()) + *range.end - range.first;
        if (count > kMaxTimes) {
            throw Error(ExitCode::kUsage, fmt::format("--frame {}: are {} pictures or more, over the limit "
                                                      "of {}; `corda render` makes a video of them",
                                                      word, count, kMaxTimes));
        }
        for (std::int64_t k = range.first; k < *range.end; ++k)
            shots.push_back({scene.video.fps.time_s(k), k});
    }
    std::stable_sort(shots.begin(), shots.end(),
                     [](const RequestedTime& a, const RequestedTime& b) { return a.time_s < b.time_s; });
    return shots;
}

}  // namespace corda::app
