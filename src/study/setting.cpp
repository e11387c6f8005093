#include "corda/study/setting.hpp"

#include <fstream>
#include <iterator>
#include <thread>

#include <fmt/format.h>

namespace corda::study {
namespace {

std::string compiler() {
#if defined(__clang__)
    return "Clang " __clang_version__;
#elif defined(__GNUC__)
    return "GCC " __VERSION__;
#else
    return "unknown";
#endif
}

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == std::string::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

std::string processor_name(const std::string& cpuinfo) {
    // "model name" on x86, "Model" or "Hardware" on other processors.
    for (const std::string key : {"model name", "Model", "Hardware"}) {
        for (std::size_t at = cpuinfo.find(key); at != std::string::npos; at = cpuinfo.find(key, at + 1)) {
            if (at > 0 && cpuinfo[at - 1] != '\n') continue;
            const std::size_t end = std::min(cpuinfo.find('\n', at), cpuinfo.size());
            const std::size_t colon = cpuinfo.find(':', at);
            if (colon >= end || trimmed(cpuinfo.substr(at, colon - at)) != key) continue;
            std::string name = trimmed(cpuinfo.substr(colon + 1, end - colon - 1));
            if (!name.empty()) return name;
        }
    }
    return "unknown";
}

std::vector<std::pair<std::string, std::string>> setting(const Timing& timing) {
    std::ifstream cpuinfo("/proc/cpuinfo");
    const std::string text(std::istreambuf_iterator<char>(cpuinfo), {});
    return {
        {"Processor", processor_name(text)},
        {"Logical cores", fmt::format("{}", std::thread::hardware_concurrency())},
        {"Compiler", compiler()},
        {"Build", trimmed(CORDA_BUILD_TYPE ": " CORDA_BUILD_FLAGS)},
        {"Corda", CORDA_VERSION},
        {"Times", fmt::format("one thread, on a clock that only goes forward: the shortest of at least {} "
                              "repeats, each of at least {:g} ms",
                              timing.repeats, 1e3 * timing.shortest_s)}};
}

}  // namespace corda::study
