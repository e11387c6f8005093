#include "corda/core/machine.hpp"

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

}  // namespace corda
