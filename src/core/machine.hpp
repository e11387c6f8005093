#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace corda {

/// How many bytes of memory this process may still take without harm to others: what Linux tells as
/// available, and what the limits of its control groups (version 2) and of its address space leave. Empty if
/// none of these is told. `root` is the folder with proc/ and sys/.
[[nodiscard]] std::optional<std::uint64_t> available_memory_bytes(const std::filesystem::path& root = "/");

/// How many cores this process may keep busy, at least 1: those that the calling thread may run on (taskset,
/// a container's set of cores), or fewer if the processor time of its control groups (version 2) is that of
/// fewer.
[[nodiscard]] int usable_cores(const std::filesystem::path& root = "/");

}  // namespace corda
