#include "corda/core/machine.hpp"

#include <sched.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
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

}  // namespace

std::uint64_t address_space_bytes() {
    return 1024 * number_after("/proc/self/status", "VmSize:").value_or(0);
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
