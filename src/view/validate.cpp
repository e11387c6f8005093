#include "corda/view/validate.hpp"

#include <cmath>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/view/font.hpp"

namespace corda::view {
namespace {

constexpr double kThinnestPx = 0.1;
constexpr double kThickestPx = 1000.0;
constexpr double kMinTextPx = 4.0;
constexpr double kMaxTextPx = 400.0;
constexpr double kMaxTrail = 3600.0;
constexpr double kWidestMargin = 0.45;

void require_range(bool holds, const std::string& field, const char* range) {
    if (!holds) throw Error(ExitCode::kInvalidScene, field + " is not " + range);
}

void validate_width(const std::optional<double>& width_px, const std::string& field) {
    require_range(!width_px || (*width_px >= kThinnestPx && *width_px <= kThickestPx), field,
                  "within 0.1 .. 1000");
}

}  // namespace

void validate(const StyleDef& style, const std::vector<BodyStyleDef>& body_styles) {
    require_range(style.trail_s >= 0.0 && style.trail_s <= kMaxTrail, "style: trail_s", "within 0 .. 3600");
    validate_width(style.rope_width_px, "style: rope_width_px");
    validate_width(style.net_width_px, "style: net_width_px");
    validate_width(style.marker_radius_px, "style: marker_radius_px");
    validate_width(style.bar_width_px, "style: bar_width_px");
    for (std::size_t i = 0; i < body_styles.size(); ++i)
        validate_width(body_styles[i].width_px, "body_styles " + std::to_string(i) + ": width_px");
}

void validate(const OverlayDef& overlay) {
    const auto& text_px = overlay.text_px;
    require_range(!text_px || (*text_px >= kMinTextPx && *text_px <= kMaxTextPx), "overlay: text_px",
                  "within 4 .. 400");
    if (const std::string missing = missing_glyph(overlay.title); !missing.empty())
        throw Error(ExitCode::kInvalidScene, "overlay: title: " + missing);
}

std::string missing_glyph(const std::string& text) {
    const std::string missing = text.empty() ? "" : Font().missing(text);
    const bool is_one = missing.find(',') == std::string::npos;
    return missing.empty() ? ""
                           : "the font, DejaVu Sans, has no " + missing + "; leave " +
                                 (is_one ? "that character" : "these characters") + " out";
}

void validate(const CameraDef& camera) {
    const auto& center_m = camera.center_m;
    const auto& height_m = camera.height_m;
    require_range(!center_m || (std::isfinite(center_m->x) && std::isfinite(center_m->y)), "camera: center_m",
                  "finite");
    require_range(!height_m || (*height_m > 0.0 && std::isfinite(*height_m)), "camera: height_m",
                  "> 0 and finite");
    require_range(camera.margin >= 0.0 && camera.margin <= kWidestMargin, "camera: margin",
                  "within 0 .. 0.45");
}

}  // namespace corda::view
