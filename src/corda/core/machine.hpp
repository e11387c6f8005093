#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace corda {

/// Bytes of address space that this process has; 0 if Linux does not report them.
[[nodiscard]] std::uint64_t address_space_bytes();

/// Bytes that the limit on the address space of this process leaves (ulimit -v); empty without one.
[[nodiscard]] std::optional<std::uint64_t> address_space_left(const std::filesystem::path& root = "/");

/// Bytes that the limit on the data of this process leaves (ulimit -d); empty without one. Data is private
/// memory that can be written to.
[[nodiscard]] std::optional<std::uint64_t> data_left(const std::filesystem::path& root = "/");

/// How many cores the calling thread may run on (taskset, a container's set of cores), at least 1.
[[nodiscard]] int usable_cores();

/// The number of jobs: as asked for; for 0, one per usable core.
[[nodiscard]] int jobs_of(int asked);

/// Seconds on a clock that only goes forward.
[[nodiscard]] inline double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace corda
