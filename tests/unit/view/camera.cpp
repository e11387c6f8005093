#include "corda/view/camera.hpp"

#include <gtest/gtest.h>

namespace corda::view {
namespace {

MotionBounds box(double x0, double y0, double x1, double y1) {
    MotionBounds bounds;
    bounds.include({0.0, {x0, x1}, {y0, y1}});
    return bounds;
}

Camera fitted_camera(const CameraDef& def, Vec2 origin_m, const MotionBounds& bounds,
                     const PictureSize& size) {
    return {fit_camera(def, origin_m, bounds, size), origin_m, size.width_px, size.height_px};
}

TEST(Camera, FitsTheMotionAndCentresIt) {
    CameraDef def;
    def.margin = 0.1;
    const Camera camera = fitted_camera(def, {}, box(-1.0, -4.0, 3.0, 0.0), {800, 400, 10.0});
    // 4 m in 400 px less 2 * (40 + 10) px
    EXPECT_DOUBLE_EQ(camera.pixels_per_metre(), 75.0);
    EXPECT_DOUBLE_EQ(camera.x_px(1.0), 400.0);
    EXPECT_DOUBLE_EQ(camera.y_px(-2.0), 200.0);
    EXPECT_DOUBLE_EQ(camera.y_px(0.0), 50.0);  // y up in metres, down in pixels
}

TEST(Camera, AFixedOneIgnoresTheMotionAndCountsFromTheWorldsOrigin) {
    CameraDef def;
    def.center_m = Vec2{105.0, 50.0};
    def.height_m = 10.0;
    EXPECT_FALSE(needs_motion(def));
    const Camera camera = fitted_camera(def, {100.0, 50.0}, MotionBounds{}, {640, 480, 0.0});
    EXPECT_DOUBLE_EQ(camera.pixels_per_metre(), 48.0);
    EXPECT_DOUBLE_EQ(camera.x_px(5.0), 320.0);
    EXPECT_DOUBLE_EQ(camera.y_px(0.0), 240.0);
}

TEST(Camera, AFixedCentreStillFitsTheMotion) {
    CameraDef def;
    def.center_m = Vec2{0.0, 0.0};
    def.margin = 0.0;
    EXPECT_TRUE(needs_motion(def));
    const Camera camera = fitted_camera(def, {}, box(-1.0, -1.0, 4.0, 1.0), {400, 400, 0.0});
    EXPECT_DOUBLE_EQ(camera.pixels_per_metre(), 50.0);
}

TEST(Camera, APointWithoutExtentAndATinyPictureAreFinite) {
    const Camera point = fitted_camera({}, {}, box(2.0, 2.0, 2.0, 2.0), {100, 100, 3.0});
    EXPECT_DOUBLE_EQ(point.x_px(2.0), 50.0);
    EXPECT_GT(point.pixels_per_metre(), 0.0);
    const Camera tiny = fitted_camera({}, {}, box(0.0, 0.0, 1.0, 1.0), {1, 1, 30.0});
    EXPECT_GT(tiny.pixels_per_metre(), 0.0);
}

TEST(Camera, AFittedOneGivenAgainIsTheSame) {
    const Vec2 origin_m{0.1, 1e6};
    const CameraDef fitted = fit_camera({}, origin_m, box(-0.3, -1.7, 2.9, 0.1), {1280, 720, 3.0});
    EXPECT_FALSE(needs_motion(fitted));
    const CameraDef again = fit_camera(fitted, origin_m, box(0.0, 0.0, 9.0, 9.0), {1280, 720, 3.0});
    EXPECT_EQ(again.center_m, fitted.center_m);
    EXPECT_EQ(again.height_m, fitted.height_m);
}

}  // namespace
}  // namespace corda::view
