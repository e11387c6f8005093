#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace corda::scene {

/// The bytes of a scene file, or of a file that messages call `what`, or of a pipe; "-" is standard input.
/// Throws corda::Error: kIo with the system's reason, kInvalidScene if they are over Limits::kFileBytes.
[[nodiscard]] std::string read_file(const std::string& path, std::string_view what = "scene");

/// Name of the file at `path` in messages.
[[nodiscard]] std::string source_name(const std::string& path);

/// Throws corda::Error (kInvalidScene) if `bytes` is more than Limits::kFileBytes.
void check_file_bytes(const std::string& source_name, std::size_t bytes);

}  // namespace corda::scene
