#pragma once

#include <chrono>

namespace corda {

/// How many cores the calling thread may run on (taskset, a container's set of cores), at least 1.
[[nodiscard]] int usable_cores();

/// The number of jobs: as asked for; for 0, one per usable core.
[[nodiscard]] int jobs_of(int asked);

/// Keeps up to 1 GiB of freed memory in this process for later pictures instead of giving it back to the
/// system: zeroing fresh pages took 14 % of a render and 20 % of a sweep. For Corda's own programs: a library
/// does not decide this for a process.
void keep_memory();

/// Seconds on a clock that only goes forward.
[[nodiscard]] inline double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace corda
