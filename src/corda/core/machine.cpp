#include "corda/core/machine.hpp"

#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

namespace corda {
namespace {

/// The number after `key` in a file of lines "key number ..."; empty if there is none.
std::optional<std::uint64_t> number_after(const std::filesystem::path& file, const std::string& key) {
    std::ifstream lines(file);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string first;
        std::uint64_t number = 0;
        if (words >> first && first == key && words >> number) return number;
    }
    return std::nullopt;
}

/// Bytes that a limit of this process leaves; empty without a limit. `used` names the line of
/// /proc/self/status that counts them.
std::optional<std::uint64_t> left_of_limit(decltype(RLIMIT_AS) resource, const char* used,
                                           const std::filesystem::path& root) {
    rlimit limit{};
    if (::getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
    const auto used_kib = number_after(root / "proc/self/status", used);
    if (!used_kib) return std::nullopt;
    return limit.rlim_cur - std::min<std::uint64_t>(limit.rlim_cur, *used_kib * 1024);
}

}  // namespace

std::uint64_t address_space_bytes() {
    return 1024 * number_after("/proc/self/status", "VmSize:").value_or(0);
}

std::optional<std::uint64_t> address_space_left(const std::filesystem::path& root) {
    return left_of_limit(RLIMIT_AS, "VmSize:", root);
}

std::optional<std::uint64_t> data_left(const std::filesystem::path& root) {
    return left_of_limit(RLIMIT_DATA, "VmData:", root);
}

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
