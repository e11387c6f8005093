#pragma once

#include <optional>

#include "corda/scene/scene.hpp"

namespace corda::film {

inline constexpr double kScreenPpi = 96.0;
inline constexpr double kPrintPpi = 300.0;

/// A picture in print.
struct PrintDef {
    std::optional<double> width_mm = {};
    std::optional<double> pixels_per_inch = {};  ///< default: kPrintPpi with a width, otherwise kScreenPpi
    /// Of letters; default: with a width 8, unless the scene says their size in pixels.
    std::optional<double> letter_pt = {};
};

/// Names of the fields of a PrintDef in errors.
struct PrintWords {
    const char *width_mm, *pixels_per_inch, *letter_pt;
};

/// The picture of a scene in print.
struct Print {
    int width_px = 0;
    int height_px = 0;
    double pixels_per_inch = kScreenPpi;  ///< of whole pixels
    std::optional<double> letter_pt = {};
    std::optional<double> text_px = {};  ///< OverlayDef::text_px
};

/// Throws corda::Error (kUsage) if the picture or its letters are too small or too large.
[[nodiscard]] Print print_of(const Scene& scene, const PrintDef& def, const PrintWords& words);

/// The height of letters in pixels.
[[nodiscard]] double letter_px(double letter_pt, double pixels_per_inch);

}  // namespace corda::film
