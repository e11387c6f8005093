#pragma once

#include "corda/report/report.hpp"

namespace corda::benchmark {

/// How much is measured.
struct Options {
    int repeats = 9;        ///< of each timed run
    unsigned scenes = 200;  ///< random chaotic ones
};

/// XPBD with small steps beside method exact, on four pendulums.
[[nodiscard]] report::Chapter challenge_chapter(const Options& options);

/// The claimed horizons of random chaotic scenes, and when the true error passes the estimate.
[[nodiscard]] report::Chapter horizons_chapter(const Options& options);

}  // namespace corda::benchmark
