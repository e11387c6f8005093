#pragma once

#include <vector>

#include "corda/figures/motion_summary.hpp"

namespace corda::figures {

/// The times of a report's drawings.
struct FigureTimes {
    std::vector<double> strobe_s;
    std::vector<double> stills_s;
    bool are_chosen = false;  ///< asked for, not found
    bool is_swing = false;    ///< the strobe shows the first swing
};

/// The times that were asked for, increasing, as far as the motion goes. Without any, the strobe has six from
/// the start to where the first followed particle first turns back in x, having moved a quarter of the way
/// that it does in all, or else to the end; and the stills are five from the start to the end. All of these
/// are frame times.
[[nodiscard]] FigureTimes find_figure_times(const Film& film, const MotionSummary& reading,
                                            const std::vector<double>& asked_s);

}  // namespace corda::figures
