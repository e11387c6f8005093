#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace corda::media {

/// Checks a name of pictures: exactly one %d or %0Nd, N 1 .. 9, in the last part of the path, where %% is a
/// per cent sign. In folders each per cent sign is one. Throws corda::Error (kUsage).
void check_picture_names(std::string_view pattern);

/// The name of a frame: "frames/0007.png" for "frames/%04d.png". Requires a name that was checked.
[[nodiscard]] std::string picture_name(std::string_view pattern, std::int64_t frame);

/// Whether a name, without its folder, is that of a frame. Requires a pattern that was checked.
[[nodiscard]] bool is_picture_name(std::string_view pattern, std::string_view name);

}  // namespace corda::media
