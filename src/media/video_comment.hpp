#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/rational.hpp"
#include "corda/media/verify.hpp"

namespace corda::media {

// What the comment of a video tells, a JSON object of any origin.

/// The rate; std::nullopt if there is none that libav can count with.
[[nodiscard]] std::optional<Rational> told_rate(const std::string& comment);
/// A whole number; std::nullopt if it is something else.
[[nodiscard]] std::optional<std::int64_t> told_number(const std::string& comment, const char* key);
/// The colour patches of the first frame.
[[nodiscard]] std::vector<ColorPatch> told_patches(const std::string& comment);
/// The comment with the number of its frames; unchanged if it is no JSON object.
[[nodiscard]] std::string comment_with_frames(const std::string& comment, std::size_t frames);

}  // namespace corda::media
