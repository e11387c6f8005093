#pragma once

#include <chrono>
#include <cstdint>

namespace corda {

/// Bytes of address space that this process has; 0 if Linux does not report them.
[[nodiscard]] std::uint64_t address_space_bytes();

/// How many cores the calling thread may run on (taskset, a container's set of cores), at least 1.
[[nodiscard]] int usable_cores();

/// The number of jobs: as asked for; for 0, one per usable core.
[[nodiscard]] int jobs_of(int asked);

/// Seconds on a clock that only goes forward.
[[nodiscard]] inline double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace corda
