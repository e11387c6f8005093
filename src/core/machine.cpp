#include "corda/core/memory.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

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

/// A file that is one number; empty for "max".
std::optional<std::uint64_t> number_in(const std::filesystem::path& file) {
    std::ifstream text(file);
    std::uint64_t number = 0;
    return text >> number ? std::optional(number) : std::nullopt;
}

/// What the limit of one group leaves. Its page cache gives way.
std::optional<std::uint64_t> left_in(const std::filesystem::path& group) {
    const auto most = number_in(group / "memory.max");
    const auto used = number_in(group / "memory.current");
    if (!most || !used) return std::nullopt;
    const std::uint64_t cache = number_after(group / "memory.stat", "inactive_file").value_or(0);
    const std::uint64_t held = *used - std::min(*used, cache);
    return *most - std::min(*most, held);
}

/// The path of this process's group below the mount, as in "0::/user.slice"; empty without version 2.
std::string group_of(const std::filesystem::path& root) {
    std::ifstream lines(root / "proc/self/cgroup");
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with("0::/")) return line.substr(4);
    return {};
}

/// What the limit on the address space of this process leaves (ulimit -v); empty without one.
std::optional<std::uint64_t> left_of_address_space(const std::filesystem::path& root) {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
    const auto used_kib = number_after(root / "proc/self/status", "VmSize:");
    if (!used_kib) return std::nullopt;
    return limit.rlim_cur - std::min<std::uint64_t>(limit.rlim_cur, *used_kib * 1024);
}

}  // namespace

std::optional<std::uint64_t> available_memory_bytes(const std::filesystem::path& root) {
    std::optional<std::uint64_t> least = number_after(root / "proc/meminfo", "MemAvailable:");
    if (least) *least *= 1024;
    const std::filesystem::path mount = root / "sys/fs/cgroup";
    const auto heed = [&least](const std::filesystem::path& group) {
        if (const auto left = left_in(group)) least = least ? std::min(*least, *left) : *left;
    };
    if (const auto left = left_of_address_space(root)) least = least ? std::min(*least, *left) : *left;
    heed(mount);
    std::filesystem::path group = mount;
    for (const std::filesystem::path& name : std::filesystem::path(group_of(root))) heed(group /= name);
    return least;
}

}  // namespace corda
