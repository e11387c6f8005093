#include "corda/film/print.hpp"

#include <algorithm>
#include <cmath>

#include "corda/core/image.hpp"
#include "corda/core/text.hpp"
#include "corda/scene/schema.hpp"

namespace corda::film {

double letter_px(double letter_pt, double pixels_per_inch) {
    constexpr double kPointsPerInch = 72.0;
    return letter_pt / kPointsPerInch * pixels_per_inch;
}

Print print_of(const Scene& scene, const PrintDef& def, const PrintWords& words) {
    constexpr double kPrintPt = 8.0;
    const double ppi = def.pixels_per_inch.value_or(def.width_mm ? kPrintPpi : kScreenPpi);
    Print print{scene.video.width_px, scene.video.height_px, ppi, def.letter_pt, scene.overlay.text_px};
    if (def.width_mm) {
        const double width_px = std::round(*def.width_mm / kMmPerInch * ppi);
        const double height_px = std::round(width_px * print.height_px / print.width_px);
        const bool is_sane = std::max(width_px, height_px) <= kMaxSidePx;
        if (!is_sane || !is_picture_size(std::lround(width_px), std::lround(height_px)))
            throw_usage(
                "{} {} at {} pixels per inch is {}x{} pixels, not 1 .. {} per side and {} in all; choose "
                "another width or {}",
                words.width_mm, *def.width_mm, ppi, width_px, height_px, kMaxSidePx, kMaxPicturePx,
                words.pixels_per_inch);
        print.width_px = static_cast<int>(width_px);
        print.height_px = static_cast<int>(height_px);
        print.pixels_per_inch = width_px * kMmPerInch / *def.width_mm;
    }
    const scene::Range& range = scene::find_key("overlay", "text_px")->type.range;
    const auto is_within = [&range](double px) { return px >= range.low && px <= range.high; };
    if (def.width_mm && !def.letter_pt && !print.text_px &&
        is_within(letter_px(kPrintPt, print.pixels_per_inch)))
        print.letter_pt = kPrintPt;
    if (!print.letter_pt) return print;
    const double px = letter_px(*print.letter_pt, print.pixels_per_inch);
    if (print.text_px != px && !is_within(px))
        throw_usage("{} {}: is {:.4g} pixels at {:.4g} per inch, not {} .. {}; choose another {}",
                    words.letter_pt, *print.letter_pt, px, print.pixels_per_inch, range.low, range.high,
                    words.pixels_per_inch);
    print.text_px = px;
    return print;
}

}  // namespace corda::film
