#pragma once

#include <string>
#include <utility>
#include <vector>

#include "corda/study/measure.hpp"

namespace corda::study {

/// What a study runs on and how it takes its times, for Report::setting: processor, cores, compiler, build,
/// version of Corda, and `timing` in words. Nothing of it names a date, a user or a folder.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> setting(const Timing& timing);

/// The processor's name out of the text of /proc/cpuinfo; "unknown" where it has none.
[[nodiscard]] std::string processor_name(const std::string& cpuinfo);

}  // namespace corda::study
