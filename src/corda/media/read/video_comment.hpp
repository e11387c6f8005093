#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "corda/core/basics.hpp"

namespace corda::media {

/// The largest JSON text that is read from a file, in bytes, and how deeply it may be nested. Corda writes
/// less: QuickTime's comments end at this size, and the deepest value in one is at level 5.
inline constexpr std::size_t kMaxJsonBytes = std::size_t{64} << 10;
inline constexpr int kDeepestJsonLevel = 16;

/// Parses JSON text from a file of unknown origin. Throws corda::Error (kMismatch) with the reason alone if
/// the text is too large or too deeply nested, or is no JSON: the value can be copied and written without
/// deep recursion.
[[nodiscard]] nlohmann::json parse_untrusted_json(std::string_view text);

/// Why a comment is not one that Corda reads: its size or its nesting. Empty for a sound one, and for text
/// that is no JSON.
[[nodiscard]] std::string comment_problem(std::string_view comment);

/// The comment of a video of any origin; empty if it has none. Only the header of the file is read. `remedy`
/// ends the messages. Throws corda::Error: kIo if the file cannot be read or is no video, kUsage if its
/// comment has a comment_problem(), kInterrupted if cancelled.
[[nodiscard]] std::string video_comment(const std::string& path,
                                        std::string_view remedy = "give a video that corda has written");

}  // namespace corda::media
