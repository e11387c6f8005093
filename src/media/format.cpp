#include "corda/media/format.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/core/image.hpp"
#include "corda/media/encoder.hpp"
#include "corda/media/h264_encoder.hpp"

namespace corda::media {
namespace {

constexpr std::array<Format, 1> kFormats{{
    {".mp4", "mp4", "libx264", "yuv420p", false, &check_h264, &make_h264_encoder},
}};

template <typename... Args>
[[noreturn]] void fail_usage(fmt::format_string<Args...> text, Args&&... args) {
    throw Error(ExitCode::kUsage, fmt::format(text, std::forward<Args>(args)...));
}

/// The different values of a column in the rows that `is_wanted` takes.
template <typename Wanted>
std::vector<std::string_view> values_of(const char* Format::*column, Wanted is_wanted) {
    std::vector<std::string_view> values;
    for (const Format& row : kFormats) {
        if (!is_wanted(row) || std::find(values.begin(), values.end(), row.*column) != values.end()) continue;
        values.emplace_back(row.*column);
    }
    return values;
}

bool is_any(const Format& /*row*/) {
    return true;
}

void check_size(int width, int height) {
    if (is_picture_size(width, height)) return;
    fail_usage("video size {}x{} is out of range: each side is 1 to {}, and a frame has at most {} pixels",
               width, height, kLargestSidePx, kMostPicturePx);
}

void check_rate(Rational fps) {
    if (fps.is_rate()) return;
    fail_usage("frame rate {} is out of range; use a positive rate such as 60 or 30000/1001", fps.text());
}

}  // namespace

std::span<const Format> formats() {
    return kFormats;
}

std::vector<std::string_view> codec_names() {
    return values_of(&Format::codec, is_any);
}

const Format& find_format(std::string_view path, std::string_view codec) {
    const std::string ending = std::filesystem::path(path).extension().string();
    const auto has_ending = [&ending](const Format& row) { return row.ending == ending; };
    const auto row = std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& candidate) {
        return has_ending(candidate) && (codec.empty() || codec == candidate.codec);
    });
    if (row != kFormats.end()) return *row;
    if (std::none_of(kFormats.begin(), kFormats.end(), has_ending)) {
        fail_usage("'{}': the ending of the name tells the format, and this one is not known; use {}", path,
                   fmt::join(values_of(&Format::ending, is_any), ", "));
    }
    fail_usage("'{}' cannot hold the codec '{}'; use {}", path, codec,
               fmt::join(values_of(&Format::codec, has_ending), ", "));
}

void check_video_def(const VideoDef& def) {
    check_size(def.width_px, def.height_px);
    check_rate(def.fps.rational());
    if (def.encoder.threads < 1 || def.encoder.threads > EncoderDef::kMostThreads) {
        fail_usage("{} encoder threads are out of range; use 1 to {}", def.encoder.threads,
                   EncoderDef::kMostThreads);
    }
    if (def.encoder.jobs < 0 || def.encoder.jobs > EncoderDef::kMostThreads) {
        fail_usage("{} encoder jobs are out of range; use 0 (one per core) to {}", def.encoder.jobs,
                   EncoderDef::kMostThreads);
    }
    const auto row = std::find_if(kFormats.begin(), kFormats.end(), [&def](const Format& candidate) {
        return candidate.codec == def.encoder.codec;
    });
    if (row == kFormats.end()) {
        fail_usage("unknown codec '{}'; use {}", def.encoder.codec, fmt::join(codec_names(), ", "));
    }
    row->check(def);
}

}  // namespace corda::media
