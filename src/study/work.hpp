#pragma once

#include <functional>
#include <string>
#include <vector>

#include "corda/report/report.hpp"

namespace corda::study {

/// A run of a chapter, or several that belong together.
struct Job {
    std::string what;  ///< for whoever waits
    std::function<void()> run;
};

/// A chapter that is yet to be measured: its jobs in order, and `finish`, which makes the chapter of their
/// figures. They share their data.
struct ChapterWork {
    std::vector<Job> jobs;
    std::function<report::Chapter()> finish;
};

}  // namespace corda::study
