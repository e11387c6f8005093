#include "corda/core/machine.hpp"

#include <malloc.h>
#include <sched.h>

#include <algorithm>
#include <thread>

namespace corda {
int usable_cores() {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (::sched_getaffinity(0, sizeof set, &set) == 0) return CPU_COUNT(&set);
    // A machine of more cores than the set holds.
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

int jobs_of(int asked) {
    return asked > 0 ? asked : usable_cores();
}

void keep_memory() {
    constexpr int kMaxOfHeap = 32 << 20;  // glibc's limit
    constexpr int kMaxKept = 1 << 30;
    static_cast<void>(mallopt(M_MMAP_THRESHOLD, kMaxOfHeap));
    static_cast<void>(mallopt(M_TRIM_THRESHOLD, kMaxKept));
}

}  // namespace corda
