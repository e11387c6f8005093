#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace corda {

/// How many bytes of memory this process may still take without harm to others: what Linux tells as
/// available, and what the limits of its control groups (version 2) and of its address space leave. Empty if
/// none of these is known. `root` is the folder with proc/ and sys/.
[[nodiscard]] std::optional<std::uint64_t> available_memory_bytes(const std::filesystem::path& root = "/");

/// Bytes of address space that this process has; 0 if Linux does not report them.
[[nodiscard]] std::uint64_t address_space_bytes();

/// Bytes that the limit on the address space of this process leaves (ulimit -v); empty without one.
[[nodiscard]] std::optional<std::uint64_t> address_space_left(const std::filesystem::path& root = "/");

/// Bytes that the limit on the data of this process leaves (ulimit -d); empty without one. Data is private
/// memory that can be written to.
[[nodiscard]] std::optional<std::uint64_t> data_left(const std::filesystem::path& root = "/");

/// Throws corda::Error (kTemporary) if the limits on this process's address space or data leave less than
/// `bytes`, which `what` needs, or `data_bytes` of data, if those are given. Libraries that cannot allocate
/// memory may crash or hang, so call this before they try.
void require_address_space(std::uint64_t bytes, const std::string& what, std::uint64_t data_bytes = 0);

/// How many cores this process may keep busy, at least 1: those that the calling thread may run on (taskset,
/// a container's set of cores), or fewer if the processor time of its control groups (version 2) is that of
/// fewer.
[[nodiscard]] int usable_cores(const std::filesystem::path& root = "/");

/// Seconds on a clock that only goes forward.
[[nodiscard]] inline double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace corda
