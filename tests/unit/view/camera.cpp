#include "corda/view/camera.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace corda::view {
namespace {

MotionBounds box(double x0, double y0, double x1, double y1) {
    MotionBounds bounds;
    bounds.include({0.0, {x0, x1}, {y0, y1}});
    return bounds;
}

/// An item with this extent around points within `bounds`.
Drawn drawn(const MotionBounds& bounds, double extent_px) {
    return {bounds, extent_px, extent_px, extent_px, extent_px};
}

Camera fitted_camera(const CameraDef& def, Vec2 origin_m, const std::vector<Drawn>& all, int width_px,
                     int height_px) {
    return {fit_camera(def, origin_m, all, width_px, height_px), origin_m, width_px, height_px};
}

TEST(Camera, FitsTheMotionAndCentresIt) {
    CameraDef def;
    def.margin = 0.1;
    const Camera camera = fitted_camera(def, {}, {drawn(box(-1.0, -4.0, 3.0, 0.0), 10.0)}, 800, 400);
    // 4 m in 400 px less 2 * (40 + 10) px
    EXPECT_DOUBLE_EQ(camera.pixels_per_metre(), 75.0);
    EXPECT_DOUBLE_EQ(camera.x_px(1.0), 400.0);
    EXPECT_DOUBLE_EQ(camera.y_px(-2.0), 200.0);
    EXPECT_DOUBLE_EQ(camera.y_px(0.0), 50.0);  // y up in metres, down in pixels
}

TEST(Camera, LeavesTheInsetsFree) {
    CameraDef def;
    def.margin = 0.05;
    const std::vector<Drawn> all{drawn(box(-1.0, -2.0, 1.0, 0.0), 5.0)};
    const Camera camera{fit_camera(def, {}, all, 800, 400, {90.0, 10.0}), {}, 800, 400};
    EXPECT_DOUBLE_EQ(camera.y_px(0.0) - 5.0, 90.0);
    EXPECT_DOUBLE_EQ(camera.y_px(-2.0) + 5.0, 380.0);  // the margin is more than the inset
    EXPECT_DOUBLE_EQ(camera.x_px(0.0), 400.0);
    def.center_m = Vec2{0.0, -1.0};
    const Camera centred{fit_camera(def, {}, all, 800, 400, {90.0, 10.0}), {}, 800, 400};
    EXPECT_DOUBLE_EQ(centred.y_px(-1.0), 200.0);
    EXPECT_DOUBLE_EQ(centred.y_px(0.0) - 5.0, 90.0);
    // An inset of half a tiny frame leaves some room all the same.
    EXPECT_LT(fit_camera(def, {}, all, 64, 48, {24.0, 0.0}).height_m.value(), 100.0);
}

TEST(Camera, CentresWhatIsDrawnNotTheMotion) {
    // A line of 2 m from a plate of 20 px above it to a ball of 50 px radius, which swings out by 1 m.
    CameraDef def;
    def.margin = 0.05;
    const std::vector<Drawn> all{drawn(box(-1.0, -2.0, 1.0, 0.0), 2.0),
                                 {box(0.0, 0.0, 0.0, 0.0), 9.0, 9.0, 20.0},
                                 drawn(box(-1.0, -2.0, 1.0, -1.5), 50.0)};
    const Camera camera = fitted_camera(def, {}, all, 1000, 400);
    EXPECT_DOUBLE_EQ(camera.y_px(0.0) - 20.0, 20.0);
    EXPECT_DOUBLE_EQ(camera.y_px(-2.0) + 50.0, 380.0);
    EXPECT_DOUBLE_EQ(camera.pixels_per_metre(), 145.0);
    EXPECT_DOUBLE_EQ(camera.x_px(0.0), 500.0);
    // Upright, the width decides, and the border is a share of it too.
    const Camera upright = fitted_camera(def, {}, all, 400, 1000);
    EXPECT_DOUBLE_EQ(upright.x_px(1.0) + 50.0, 380.0);
    EXPECT_DOUBLE_EQ(upright.y_px(0.0) - 20.0, 1000.0 - (upright.y_px(-2.0) + 50.0));
}

TEST(Camera, FitsTheItemThatExtendsFarthest) {
    // At a small scale the ball decides, at a large one the line.
    CameraDef def;
    def.margin = 0.0;
    const std::vector<Drawn> all{drawn(box(-2.0, 0.0, 2.0, 0.0), 0.0), drawn(box(0.0, 0.0, 1.0, 0.0), 100.0)};
    EXPECT_DOUBLE_EQ(fitted_camera(def, {}, all, 1000, 1000).pixels_per_metre(), 250.0);
    EXPECT_DOUBLE_EQ(fitted_camera(def, {}, all, 300, 300).pixels_per_metre(), 200.0 / 3.0);
}

TEST(Camera, AFixedOneIgnoresTheMotionAndCountsFromTheWorldsOrigin) {
    CameraDef def;
    def.center_m = Vec2{105.0, 50.0};
    def.height_m = 10.0;
    const Camera camera = fitted_camera(def, {100.0, 50.0}, {}, 640, 480);
    EXPECT_DOUBLE_EQ(camera.pixels_per_metre(), 48.0);
    EXPECT_DOUBLE_EQ(camera.x_px(5.0), 320.0);
    EXPECT_DOUBLE_EQ(camera.y_px(0.0), 240.0);
}

TEST(Camera, AFixedCentreStillFitsTheMotion) {
    CameraDef def;
    def.center_m = Vec2{0.0, 0.0};
    def.margin = 0.0;
    const MotionBounds bounds = box(-1.0, -1.0, 4.0, 1.0);
    EXPECT_DOUBLE_EQ(fitted_camera(def, {}, {drawn(bounds, 0.0)}, 400, 400).pixels_per_metre(), 50.0);
    EXPECT_DOUBLE_EQ(fitted_camera(def, {}, {drawn(bounds, 20.0)}, 400, 400).pixels_per_metre(), 45.0);
}

TEST(Camera, APointWithoutExtentAndATinyPictureAreFinite) {
    const Camera point = fitted_camera({}, {}, {drawn(box(2.0, 2.0, 2.0, 2.0), 3.0)}, 100, 100);
    EXPECT_DOUBLE_EQ(point.x_px(2.0), 50.0);
    EXPECT_GT(point.pixels_per_metre(), 0.0);
    const Camera tiny = fitted_camera({}, {}, {drawn(box(0.0, 0.0, 1.0, 1.0), 30.0)}, 1, 1);
    EXPECT_GT(tiny.pixels_per_metre(), 0.0);
    const Camera corner =
        fitted_camera({Vec2{0.0, 0.0}, std::nullopt}, {}, {drawn(box(0.0, 0.0, 1.0, 1.0), 30.0)}, 1, 1);
    EXPECT_GT(corner.pixels_per_metre(), 0.0);
}

TEST(Camera, AFittedOneGivenAgainIsTheSame) {
    const Vec2 origin_m{0.1, 1e6};
    const CameraDef fitted =
        fit_camera({}, origin_m, std::vector{drawn(box(-0.3, -1.7, 2.9, 0.1), 3.0)}, 1280, 720);
    const CameraDef again =
        fit_camera(fitted, origin_m, std::vector{drawn(box(0.0, 0.0, 9.0, 9.0), 3.0)}, 1280, 720);
    EXPECT_EQ(again.center_m, fitted.center_m);
    EXPECT_EQ(again.height_m, fitted.height_m);
}

TEST(CameraTrack, PassesItsKeysWithoutOvershootAndRestsAtItsEnds) {
    const CameraTrack track(
        {{1.0, {0.0, 5.0}, 4.0}, {2.0, {1.0, 5.0}, 1.0}, {4.0, {1.5, 7.0}, 2.0}, {5.0, {3.0, 6.0}, 2.0}});
    const auto at = [&](double time_s) { return track.at({}, time_s); };
    EXPECT_EQ(*at(0.0).center_m, (Vec2{0.0, 5.0}));
    EXPECT_EQ(*at(2.0).center_m, (Vec2{1.0, 5.0}));
    EXPECT_EQ(*at(9.0).center_m, (Vec2{3.0, 6.0}));
    EXPECT_EQ(*at(2.0).height_m, 1.0);
    double x = 0.0;
    for (double t = 1.0; t <= 5.0; t += 0.01) {
        EXPECT_GE(at(t).center_m->x, x) << t;
        EXPECT_GE(at(t).center_m->y, 5.0) << t;
        EXPECT_LE(at(t).center_m->y, 7.0) << t;
        EXPECT_GE(*at(t).height_m, 1.0) << t;
        x = at(t).center_m->x;
    }
    EXPECT_NEAR(*CameraTrack({{0.0, {}, 4.0}, {1.0, {}, 1.0}}).at({}, 0.5).height_m, 2.0,
                1e-15);  // in its logarithm
    const CameraTrack even({{0.0, {}, 1.0}, {1.0, {}, 2.0}, {2.0, {}, 4.0}, {3.0, {}, 8.0}});
    EXPECT_NEAR(*even.at({}, 1.25).height_m, 2.0 * std::pow(2.0, 0.25),
                1e-14);  // at a constant rate between keys
    EXPECT_EQ(*CameraTrack({{0.0, {}, 0.7}, {1.0, {}, 0.7}}).at({}, 0.3).height_m, 0.7);
    EXPECT_LT(at(1.01).center_m->x, 0.001);  // it starts at rest; measured 3.5e-4
    EXPECT_GT(at(2.01).center_m->x, 1.004);  // and passes inner keys; measured 1.0048
}

}  // namespace
}  // namespace corda::view
