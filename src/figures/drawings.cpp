#include "corda/figures/drawings.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "corda/core/text.hpp"
#include "corda/pipeline/film_renderer.hpp"
#include "corda/report/report.hpp"

namespace corda::figures {
namespace {

constexpr double kLetterPt = 8.0;
constexpr double kPointsPerInch = 72.0;
constexpr double kThinnestPx = 0.1;  // that a width may have, and kThickestPx
constexpr double kThickestPx = 1000.0;
// Of the height over the width: what is beyond fits no page.
constexpr double kFlattest = 0.2;
constexpr double kTallest = 1.4;

void scale(std::optional<double>& width_px, double factor) {
    if (width_px) width_px = std::clamp(*width_px * factor, kThinnestPx, kThickestPx);
}

}  // namespace

Scene look_in_print(const Scene& scene, double width_mm) {
    Scene look = scene;
    VideoDef& video = look.video;
    const double shape = std::clamp(1.0 * video.height_px / video.width_px, kFlattest, kTallest);
    const double factor = report::kPrintPpi * width_mm / kMmPerInch / video.width_px;
    video.width_px = static_cast<int>(std::lround(video.width_px * factor));
    video.height_px = static_cast<int>(std::lround(shape * video.width_px));
    StyleDef& style = look.style;
    for (std::optional<double>* width_px :
         {&style.rope_width_px, &style.net_width_px, &style.marker_radius_px, &style.bar_width_px})
        scale(*width_px, factor);
    for (BodyStyleDef& body : look.body_styles) scale(body.width_px, factor);
    look.overlay.plot = LivePlot::kNone;
    look.overlay.text_px = kLetterPt / kPointsPerInch * report::kPrintPpi;
    return look;
}

Film& Drawings::look(double width_mm) {
    const auto known = looks_.find(width_mm);
    if (known != looks_.end()) return known->second;
    return looks_
        .emplace(width_mm, FilmRenderer::another_look(*film_, look_in_print(film_->scene(), width_mm)))
        .first->second;
}

void Drawings::write(const std::string& path, double width_mm, const std::vector<double>& times_s,
                     const OutputOptions& options) {
    Film& film = look(width_mm);
    PngInfo info;
    info.pixels_per_inch = film.scene().video.width_px * kMmPerInch / width_mm;
    info.text = {{"Title", printable(film.scene().name)},
                 {"Time", fmt::format("{} s", fmt::join(times_s, ", "))}};
    static_cast<void>(write_figure(path, film, {.times_s = times_s}, info, options));
}

}  // namespace corda::figures
