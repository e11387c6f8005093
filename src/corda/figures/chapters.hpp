#pragma once

#include <functional>
#include <string>
#include <vector>

#include "corda/figures/drawings.hpp"
#include "corda/figures/motion_summary.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/report/report.hpp"

namespace corda::figures {

/// Writes the poses at some times: see Drawings::write().
using WritePoses =
    std::function<void(const std::string& path, double width_mm, const std::vector<double>& times_s)>;

/// Model, method and its error, and pictures: a strobe, stills and the largest
/// figures.
[[nodiscard]] report::Chapter motion_chapter(Film& film, const MotionSummary& motion,
                                             const FigureTimes& times, const WritePoses& write);
/// The paths of the followed particles.
[[nodiscard]] report::Chapter path_chapter(const Film& film, const MotionSummary& motion);
/// Their angles about their pins over time, and the period of the first, compared with theory; empty if one
/// has no pin or comes close to it.
[[nodiscard]] report::Chapter angle_chapter(const Film& film, const MotionSummary& motion);
/// Their phase portraits: angle and angular velocity about the pin if each has one and keeps away from it,
/// else x and vx.
[[nodiscard]] report::Chapter phase_chapter(const Film& film, const MotionSummary& motion);
[[nodiscard]] report::Chapter energy_chapter(const Film& film, const MotionSummary& motion);
/// The largest tension over time, and that along the rope when it is largest of all; or why it is not known.
[[nodiscard]] report::Chapter tension_chapter(const Film& film, const MotionSummary& motion);
[[nodiscard]] report::Chapter strain_chapter(const Film& film, const MotionSummary& motion);

}  // namespace corda::figures
