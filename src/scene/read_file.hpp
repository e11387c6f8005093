#pragma once

#include <cstddef>
#include <string>

namespace corda::scene {

/// The bytes of a scene file or a pipe; "-" is standard input. Throws corda::Error: kIo with the system's
/// reason, kInvalidScene if they are over Limits::kFileBytes.
[[nodiscard]] std::string read_file(const std::string& path);

/// What messages call a file that is read from `path`.
[[nodiscard]] std::string source_name(const std::string& path);

/// Throws corda::Error (kInvalidScene) if a scene of so many bytes is over Limits::kFileBytes.
void check_file_bytes(const std::string& source_name, std::size_t bytes);

}  // namespace corda::scene
