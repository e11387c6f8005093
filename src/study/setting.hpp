#pragma once

#include <istream>
#include <string>
#include <utility>
#include <vector>

#include "corda/study/measure.hpp"

namespace corda::study {

/// What a study runs on and how it times, for Report::setting: processor, cores, compiler, build, version of
/// Corda, and `timing` in words. No dates, users or folders.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> setting(const Timing& timing);

/// The processor's name in the text of /proc/cpuinfo; "unknown" if it has none.
[[nodiscard]] std::string processor_name(std::istream& cpuinfo);

}  // namespace corda::study
