#include "corda/core/machine.hpp"

#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

#include "corda/core/text.hpp"

namespace corda {
namespace {

constexpr int kMaxCores = 1 << 16;

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

/// Bytes that the limit of one group leaves. Its page cache can be reclaimed.
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

/// Calls `visit` with the folder of every group that holds this process. In a container its own is the root.
template <class Visit>
void for_each_group(const std::filesystem::path& root, const Visit& visit) {
    std::filesystem::path group = root / "sys/fs/cgroup";
    visit(group);
    for (const std::filesystem::path& name : std::filesystem::path(group_of(root))) visit(group /= name);
}

/// How many cores the processor time of one group is, rounded up: "quota period" or "max period".
std::optional<int> cores_of(const std::filesystem::path& group) {
    std::ifstream text(group / "cpu.max");
    std::int64_t quota = 0;
    std::int64_t period = 0;
    if (!(text >> quota >> period) || quota <= 0 || period <= 0) return std::nullopt;
    return static_cast<int>(std::min<std::int64_t>((quota - 1) / period + 1, kMaxCores));
}

/// How many cores this process may run on.
int allowed_cores() {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (::sched_getaffinity(0, sizeof set, &set) == 0) return CPU_COUNT(&set);
    // On a machine of more cores than the set holds it is not known on which ones.
    return static_cast<int>(std::thread::hardware_concurrency());
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

std::optional<std::uint64_t> available_memory_bytes(const std::filesystem::path& root) {
    std::optional<std::uint64_t> least = number_after(root / "proc/meminfo", "MemAvailable:");
    if (least) *least *= 1024;
    const auto heed = [&least](std::optional<std::uint64_t> left) {
        if (left) least = least ? std::min(*least, *left) : *left;
    };
    heed(address_space_left(root));
    heed(data_left(root));
    for_each_group(root, [&heed](const std::filesystem::path& group) { heed(left_in(group)); });
    return least;
}

void require_address_space(std::uint64_t bytes, const std::string& what, std::uint64_t data_bytes) {
    const auto require = [&what](std::uint64_t needed, std::optional<std::uint64_t> left, const char* of,
                                 const char* limit) {
        if (!left || *left >= needed) return;
        throw_error(
            ExitCode::kTemporary,
            "{} needs {} MiB of {}, and the limit of this process leaves {} MiB; raise the limit ({})", what,
            (needed + (1U << 20U) - 1) >> 20U, of, *left >> 20U, limit);
    };
    require(bytes, address_space_left(), "address space", "ulimit -v");
    require(data_bytes != 0 ? data_bytes : bytes, data_left(), "data", "ulimit -d");
}

int usable_cores(const std::filesystem::path& root) {
    int least = std::clamp(allowed_cores(), 1, kMaxCores);
    for_each_group(root, [&least](const std::filesystem::path& group) {
        least = std::min(least, cores_of(group).value_or(least));
    });
    return least;
}

}  // namespace corda
