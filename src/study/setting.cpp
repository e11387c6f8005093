#include "corda/study/setting.hpp"

#include <fstream>

#include <fmt/format.h>

#include "corda/core/machine.hpp"
#include "corda/core/version.hpp"

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

}  // namespace

std::string processor_name(std::istream& cpuinfo) {
    for (std::string line; std::getline(cpuinfo, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

std::vector<std::pair<std::string, std::string>> setting(const Timing& timing) {
    std::ifstream cpuinfo("/proc/cpuinfo");
    return {{"Processor", processor_name(cpuinfo)},
            {"Usable cores", fmt::format("{}", usable_cores())},
            {"Compiler", compiler()},
            {"Build", CORDA_BUILD_TYPE ": " CORDA_BUILD_FLAGS},
            {"Corda", std::string(version())},
            {"Times",
             fmt::format("on one thread, by CLOCK_MONOTONIC: the median of {} repeats of at least {:g} ms",
                         timing.repeats, 1e3 * timing.shortest_s)}};
}

}  // namespace corda::study
