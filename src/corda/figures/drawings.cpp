#include "corda/figures/drawings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

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
// Limits of height over width, so that a picture fits a page.
constexpr double kFlattest = 0.2;
constexpr double kTallest = 1.4;

void scale(std::optional<double>& width_px, double factor) {
    if (width_px) width_px = std::clamp(*width_px * factor, kThinnestPx, kThickestPx);
}

constexpr int kPoses = 6;
constexpr int kStills = 5;

/// When a path first turns back in x; std::nullopt if it never does.
std::optional<double> first_turn_s(const CurvePoints& path) {
    constexpr double kFarEnough = 0.25;
    if (path.size() < 3) return std::nullopt;
    const auto [left, right] = std::ranges::minmax_element(path, {}, &view::CurvePoint::x);
    const double enough_m = kFarEnough * (right->x - left->x);
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
        const double before = path[i].x - path[i - 1].x;
        const double after = path[i + 1].x - path[i].x;
        const bool turns = before * after < 0.0 || (before != 0.0 && after == 0.0);
        if (turns && std::abs(path[i].x - path.front().x) >= enough_m && enough_m > 0.0)
            return path[i].time_s;
    }
    return std::nullopt;
}

/// So many frame times from 0 to a frame, evenly spread, each once.
std::vector<double> spread(const Film& film, std::int64_t last, int count) {
    std::vector<double> times_s;
    for (int i = 0; i < count; ++i) {
        const double time_s = film.time_s(std::llround(static_cast<double>(last) * i / (count - 1)));
        if (times_s.empty() || time_s > times_s.back()) times_s.push_back(time_s);
    }
    return times_s;
}

}  // namespace

FigureTimes find_figure_times(const Film& film, const MotionSummary& motion,
                              const std::vector<double>& asked_s) {
    FigureTimes times;
    if (!asked_s.empty()) {
        const double end_s = motion.failure ? motion.end_s : film.scene().world.duration_s;
        for (const double time_s : asked_s)
            if (time_s <= end_s) times.stills_s.push_back(time_s);
        std::ranges::sort(times.stills_s);
        times.strobe_s = times.stills_s;
        return times;
    }
    const std::int64_t last = motion.rows - 1;
    std::int64_t end = last;
    if (!motion.bodies.empty()) {
        if (const auto turn_s = first_turn_s(motion.bodies.front().path)) {
            times.is_swing = true;
            end = std::min(last, film.scene().video.scene_rate().last_frame_within(*turn_s));
        }
    }
    times.strobe_s = spread(film, end, kPoses);
    times.stills_s = spread(film, last, kStills);
    return times;
}

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
    for (BodyStyleDef& body : look.body_styles) {
        scale(body.width_px, factor);
        scale(body.end_width_px, factor);
    }
    look.overlay.plots.clear();
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
