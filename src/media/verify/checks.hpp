#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "corda/media/read/mp4_boxes.hpp"
#include "corda/media/verify/decode.hpp"
#include "corda/media/verify/verify.hpp"

namespace corda::media {

/// Adds a problem, in words.
template <typename... Args>
void problem(VerifyReport& report, fmt::format_string<Args...> text, Args&&... args) {
    report.problems.push_back(fmt::format(text, std::forward<Args>(args)...));
}

/// Checks the boxes of an MP4 or QuickTime file; false if it holds no stream to decode.
bool check_boxes(const Mp4Boxes& boxes, VerifyReport& report);
/// How to copy the pictures of a video into another file, with clocks that count its frames exactly. `before`
/// are further options, each with a space behind it.
[[nodiscard]] std::string copy_command(const VerifyReport& report, std::string_view ending,
                                       std::string_view before = {});
/// Checks that a browser can seek at once. `report` has the rate.
void check_index(const Mp4Boxes& boxes, VerifyReport& report);
/// Checks the stored clocks and durations, which are whole numbers and must agree exactly.
void check_clocks(const DecodedVideo& video, const Mp4Boxes& boxes, VerifyReport& report);

/// Checks that codec, pixel format and colour tags are what players show rightly.
void check_picture_format(const DecodedVideo& video, VerifyReport& report);
void check_tags(const DecodedVideo& video, VerifyReport& report);
/// Adds notes on the checks of a sound video, and on its players.
void add_notes(const DecodedVideo& video, VerifyDepth depth, VerifyReport& report);

}  // namespace corda::media
