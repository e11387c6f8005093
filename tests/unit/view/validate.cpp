#include "corda/view/validate.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "support/failure.hpp"

namespace corda::view {
namespace {

const double kNone = std::nan("");
const double kInfinity = std::numeric_limits<double>::infinity();
const StyleDef kPlain;

void expect_refused(const std::function<void()>& check, const char* field) {
    const test::Failure failure = test::failure_of(check);
    EXPECT_EQ(failure.code, ExitCode::kInvalidScene) << field;
    EXPECT_THAT(failure.message, testing::HasSubstr(field));
}

/// The styles of two bodies, the second of that width.
std::vector<BodyStyleDef> second_of(double width_px) {
    std::vector<BodyStyleDef> styles;
    styles.emplace_back();
    styles.emplace_back().width_px = width_px;
    return styles;
}

CameraDef camera_at(Vec2 center_m) {
    CameraDef camera;
    camera.center_m = center_m;
    return camera;
}

TEST(ValidStyles, HaveWidthsWithinTheirRange) {
    for (const double width_px : {0.1, 3.0, 1000.0}) {
        StyleDef style = kPlain;
        style.rope_width_px = style.net_width_px = style.marker_radius_px = style.bar_width_px = width_px;
        validate(style, second_of(width_px));
    }
    for (const double width_px : {0.0, 0.09, -1.0, 1001.0, kNone, kInfinity}) {
        StyleDef style = kPlain;
        expect_refused([&] { validate(style, second_of(width_px)); }, "body_styles 1: width_px");
        style.bar_width_px = width_px;
        expect_refused([&] { validate(style, {}); }, "bar_width_px");
        style.net_width_px = width_px;
        expect_refused([&] { validate(style, {}); }, "net_width_px");
        style.net_width_px = std::nullopt;
        style.marker_radius_px = width_px;
        expect_refused([&] { validate(style, {}); }, "marker_radius_px");
        style.rope_width_px = width_px;
        expect_refused([&] { validate(style, {}); }, "rope_width_px");
    }
}

TEST(ValidStyles, HaveATrailOfAtMostAnHour) {
    for (const double trail_s : {-0.1, 3601.0, kNone}) {
        StyleDef style;
        style.trail_s = trail_s;
        expect_refused([&] { validate(style, {}); }, "trail_s");
    }
}

TEST(ValidCameras, HaveSidesMarginsAndAPlace) {
    validate(CameraDef{});
    validate(CameraDef{Vec2{-1e300, 1e300}, 1e-300, 0.45});
    for (const double height_m : {0.0, -1.0, kNone, kInfinity})
        expect_refused([&] { validate(CameraDef{std::nullopt, height_m, 0.1}); }, "height_m");
    for (const double margin : {-0.01, 0.46, 2.0, kNone})
        expect_refused([&] { validate(CameraDef{std::nullopt, std::nullopt, margin}); }, "margin");
    for (const Vec2 center_m : {Vec2{kNone, 0.0}, Vec2{0.0, kInfinity}})
        expect_refused([&] { validate(camera_at(center_m)); }, "center_m");
}

}  // namespace
}  // namespace corda::view
