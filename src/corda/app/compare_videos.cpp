#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compare.hpp"
#include "corda/core/child_process.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/golden/suite.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/read/stored_video.hpp"

namespace corda::app {
namespace {

using Json = nlohmann::json;

/// Matroska counts milliseconds, GIF hundredths; each time is the nearest one.
constexpr double kSameTimeS = 5.001e-3;
constexpr double kSameRate = 1e-4;

/// Result of the comparison of two videos so far.
struct VideoDifference {
    std::array<std::int64_t, 2> frames{};
    std::array<Rational, 2> rates{};
    std::array<std::array<int, 2>, 2> sizes{};
    double time_s = 0.0;  ///< largest difference of the times of two frames
    std::int64_t differing = 0;
    std::int64_t failed = 0;  ///< frames beyond the limits
    Difference largest;       ///< its max, mean and share are the largest of any frame
    Difference worst;         ///< of the worst frame, one beyond the limits if there is any
    bool is_worst_failed = false;
    std::int64_t worst_frame = 0;
    double worst_time_s = 0.0;
    std::array<Image, 2> worst_pictures;
};

/// True as well if a file has no rate, such as a GIF: the times of its frames are compared.
bool are_same_rate(const std::array<Rational, 2>& rates) {
    return rates[0] == rates[1] || rates[0].num == 0 || rates[1].num == 0 ||
           std::abs(rates[0].value() - rates[1].value()) <= kSameRate * rates[0].value();
}

/// Takes the frames that both have.
void take_frames(const CompareOptions& options, const std::array<media::StoredPicture, 2>& pictures,
                 const std::optional<Image>& mask, VideoDifference& result) {
    const std::int64_t frame = result.frames[0] - 1;
    result.time_s = std::max(result.time_s, std::abs(pictures[0].time_s - pictures[1].time_s));
    const bool is_stored_alike = pictures[0].format == pictures[1].format &&
                                 pictures[0].width_px == pictures[1].width_px &&
                                 pictures[0].height_px == pictures[1].height_px &&
                                 pictures[0].is_full_range == pictures[1].is_full_range;
    if (is_stored_alike && pictures[0].samples == pictures[1].samples) return;
    std::array<Image, 2> images{pictures[0].rgba(), pictures[1].rgba()};
    const Image* const mask_image = mask ? &*mask : nullptr;
    Difference difference = compare(images[0], images[1], mask_image);
    // In one format, different samples can give the same colours; with a mask, only colours are compared.
    if (is_stored_alike && !mask) difference.equal = false;
    if (difference.equal) return;
    const bool has_failed = !difference.within(options.limits);
    result.failed += has_failed ? 1 : 0;
    result.largest.max = std::max(result.largest.max, difference.max);
    result.largest.mean = std::max(result.largest.mean, difference.mean);
    result.largest.share = std::max(result.largest.share, difference.share);
    const bool is_worse = !difference.same_size || result.differing == 0 ||
                          (has_failed && !result.is_worst_failed) ||
                          (has_failed == result.is_worst_failed && difference.mean > result.worst.mean);
    ++result.differing;
    if (!is_worse || !result.worst.same_size) return;
    result.worst = difference;
    result.is_worst_failed = has_failed;
    result.worst_frame = frame;
    result.worst_time_s = pictures[0].time_s;
    result.worst_pictures = std::move(images);
}

VideoDifference compare_all_frames(const CompareOptions& options, const std::optional<Image>& mask) {
    media::StoredVideo a(options.a);
    media::StoredVideo b(options.b);
    VideoDifference result;
    result.rates = {a.rate(), b.rate()};
    std::array<media::StoredPicture, 2> pictures;
    for (;;) {
        const bool has_a = a.read(pictures[0]);
        const bool has_b = b.read(pictures[1]);
        if (!has_a && !has_b) break;
        result.frames[0] += has_a ? 1 : 0;
        result.frames[1] += has_b ? 1 : 0;
        // Sizes may change within a video; the first that differ are reported.
        for (std::size_t i = 0; i < 2 && result.worst.same_size; ++i)
            result.sizes[i] = {pictures[i].width_px, pictures[i].height_px};
        if (has_a && has_b) take_frames(options, pictures, mask, result);
    }
    return result;
}

Json json_of(const VideoDifference& found) {
    const bool same_size = found.sizes[0] == found.sizes[1];
    const bool same_frames = found.frames[0] == found.frames[1];
    const bool same_times = are_same_rate(found.rates) && found.time_s <= kSameTimeS;
    Json json = figures_json(found.worst);
    if (found.worst.same_size) {
        json["max"] = golden::max_json(found.largest);
        json["mean"] = found.largest.mean;
        json["share"] = found.largest.share;
    }
    json["equal"] = found.differing == 0 && same_size && same_frames && same_times;
    json["same_size"] = same_size;
    json["passed"] = found.failed == 0 && same_size && same_frames && same_times;
    json["frames"] = found.frames;
    json["sizes"] = found.sizes;
    for (const Rational& rate : found.rates) json["fps"].push_back(rate.num > 0 ? Json(rate.text()) : Json());
    json["time_difference_s"] = found.time_s;
    json["differing_frames"] = found.differing;
    json["failed_frames"] = found.failed;
    json["worst_frame"] = found.differing > 0 ? Json(found.worst_frame) : Json();
    json["worst_time_s"] = found.differing > 0 ? Json(found.worst_time_s) : Json();
    std::vector<std::string> words;
    if (!same_size)
        words.push_back(fmt::format("different sizes: {}x{} and {}x{}", found.sizes[0][0], found.sizes[0][1],
                                    found.sizes[1][0], found.sizes[1][1]));
    if (!same_frames)
        words.push_back(
            fmt::format("different numbers of frames: {} and {}", found.frames[0], found.frames[1]));
    if (!are_same_rate(found.rates))
        words.push_back(fmt::format("different rates: {} and {} frames per second", found.rates[0].text(),
                                    found.rates[1].text()));
    if (same_frames && found.time_s > kSameTimeS)
        words.push_back(fmt::format("the times of frames differ by up to {:.6g} s", found.time_s));
    if (found.differing > 0 && found.worst.same_size) {
        words.push_back(fmt::format("{} of {} frames differ{}; worst is frame {} at {:.6g} s: {}",
                                    found.differing, std::min(found.frames[0], found.frames[1]),
                                    found.failed == 0 ? " within the limits" : "", found.worst_frame,
                                    found.worst_time_s, figures_text(found.worst)));
        if (found.differing > 1) words.push_back("the largest of any frame: " + figures_text(found.largest));
    }
    if (words.empty()) words.push_back(fmt::format("equal: {} frames", found.frames[0]));
    json["words"] = words;
    return json;
}

/// The report as a line of JSON, and after it the picture of the differences.
std::string compared(const CompareOptions& options, const std::optional<Image>& mask) {
    const VideoDifference found = compare_all_frames(options, mask);
    Json json = json_of(found);
    std::string pixels;
    if (!options.diff.empty() && found.differing > 0) {
        const Image picture = difference_image(found.worst_pictures[0], found.worst_pictures[1],
                                               mask && found.worst.same_size ? &*mask : nullptr);
        json["picture"] = {picture.width(), picture.height()};
        pixels.assign(reinterpret_cast<const char*>(picture.data()), picture.size_bytes());
    }
    return json.dump(-1, ' ', true, Json::error_handler_t::replace) + '\n' + pixels;
}

ChildLimits limits_of_videos(const std::string& a, const std::string& b) {
    constexpr std::int64_t kMinS = 60;
    constexpr std::int64_t kBytesPerS = 500;  // a still scene has small frames, each of which takes its time
    std::uintmax_t bytes = 0;
    for (const std::string& path : {a, b}) {
        std::error_code none;
        const std::uintmax_t size = std::filesystem::file_size(path, none);
        if (!none) bytes += size;
    }
    const std::int64_t cpu_s = kMinS + static_cast<std::int64_t>(bytes) / kBytesPerS;
    return {std::uint64_t{8} << 30, cpu_s, 3.0 * static_cast<double>(cpu_s)};
}

/// The report of the child; writes the picture of the differences.
Json compare_two(const CompareOptions& options, const std::optional<Image>& mask, std::string& pixels) {
    media::StoredVideo::load_libraries();
    const auto end =
        run_in_child([&] { return compared(options, mask); }, limits_of_videos(options.a, options.b));
    if (end && end->outcome == ChildEnd::Outcome::kOutOfMemory)
        throw Error(ExitCode::kIo, "a video asks for more memory than it may have");
    if (end && !end->finished()) {
        throw_error(ExitCode::kIo,
                    "cannot compare '{}' with '{}': decoding {}; `corda verify` says which is damaged",
                    options.a, options.b, end->text);
    }
    const std::string report = end ? end->text : compared(options, mask);
    const std::size_t line = report.find('\n');
    pixels = report.substr(line + 1);
    return Json::parse(report.substr(0, line));
}

void write_difference(const CompareOptions& options, const Json& json, const std::string& pixels) {
    Image picture(json["picture"][0].get<int>(), json["picture"][1].get<int>());
    std::memcpy(picture.data(), pixels.data(), std::min(picture.size_bytes(), pixels.size()));
    write_png(options.diff, picture, {}, {.force = options.force});
}

}  // namespace

bool is_video_name(const std::string& path) {
    const std::string ending = std::filesystem::path(path).extension().string();
    constexpr std::array<std::string_view, 8> kEndings{".mp4", ".mov", ".mkv", ".webm",
                                                       ".gif", ".m4v", ".avi", ".y4m"};
    return std::ranges::find(kEndings, ending) != kEndings.end();
}

ExitCode compare_videos(const Console& console, const CompareOptions& options,
                        const std::optional<Image>& mask) {
    std::string pixels;
    Json json = compare_two(options, mask, pixels);
    for (const Json& words : json["words"]) console.result(words.get<std::string>());
    if (json.contains("picture")) {
        write_difference(options, json, pixels);
        console.info(fmt::format("difference picture: {}", options.diff));
    }
    json.erase("words");
    json.erase("picture");
    json["schema"] = 1;
    console.report(json);
    return json["passed"].get<bool>() ? ExitCode::kOk : ExitCode::kMismatch;
}

}  // namespace corda::app
