#pragma once

#include <functional>
#include <string>
#include <vector>

#include "corda/study/report.hpp"

namespace corda::study {

/// One run of a chapter, or what belongs together.
struct Job {
    std::string what;  ///< in words, for who waits
    std::function<void()> run;
};

/// A chapter to be: its jobs in order, then what they add up to. Jobs and `finish` share their data.
struct ChapterWork {
    std::vector<Job> jobs;
    std::function<Chapter()> finish;
};

}  // namespace corda::study
