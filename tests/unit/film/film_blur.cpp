#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/film/film.hpp"
#include "support/cancel.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using test::code_of;
using test::equal_images;

Film blurred_film(const std::string& toml) {
    return Film(parse_scene(toml, "film.toml"));
}

const std::string kBlur = R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 12, length = 1.0, angle_deg = 50.0 }
[style]
trail_s = 0.2
[video]
size = [96, 64]
fps = 30
shutter = 0.75
subframes = 6
)";

TEST(FilmBlur, DoesNotChangePlansStatesAndStills) {
    Film sharp(parse_scene(kBlur, "a", {"video.shutter=0"}));
    Film film = blurred_film(kBlur);
    const Image blurred = film.frame(9);
    EXPECT_FALSE(blurred == sharp.frame(9));
    EXPECT_TRUE(equal_images(film.still(film.time_s(9)), sharp.frame(9)));
    EXPECT_TRUE(equal_images(sharp.still(film.time_s(9), 0.75), film.frame(9)));
    EXPECT_EQ(film.plan().error_estimate_m, sharp.plan().error_estimate_m);
    for (const std::int64_t k : {0, 9, 10, 30}) {
        EXPECT_EQ(film.state(k).x_m, sharp.state(k).x_m);
        EXPECT_EQ(film.state(k).y_m, sharp.state(k).y_m);
    }
    EXPECT_EQ(code_of([&] { static_cast<void>(film.still(0.1, 1.1)); }), ExitCode::kUsage);
}

TEST(FilmBlur, DiscardsACancelledExposure) {
    Film film = blurred_film(kBlur);
    const Image expected = film.frame(20);
    {
        const CancelScope stop = test::cancel_after(2);
        EXPECT_EQ(code_of([&] { static_cast<void>(film.frame(9)); }), ExitCode::kInterrupted);
    }
    EXPECT_TRUE(equal_images(film.frame(20), expected));
}

TEST(FilmBlur, IsTheSameInAnyOrderAndAtUnrecordedTimes) {
    const Film film = blurred_film(kBlur);
    const Film sharp(parse_scene(kBlur, "a", {"video.shutter=0"}));  // records no exposures
    for (const std::int64_t k : {7, 0, 3, 2, 30})                    // half of the last one is after the end
        EXPECT_TRUE(equal_images(film.frame(k), sharp.still(sharp.time_s(k), 0.75))) << k;
}

/// For what share of the time a line of 16 px covers a place, `x_px` from the middle of its way.
double covered_share(double x_px, double way_px) {
    const double from = std::max(-0.5 * way_px, x_px - 8.0);
    const double until = std::min(0.5 * way_px, x_px + 8.0);
    return std::max(0.0, until - from) / way_px;
}

TEST(FilmBlur, IsTheIntegralAtConstantSpeed) {
    // 100 px/m; a white line that moves by 64 px per frame on black, and is in the middle in frame 1.
    Film film = blurred_film(R"(schema = 1
[world]
gravity = 0
duration = 0.3
[[rope]]
points = [[-0.64, -1.0], [-0.64, 1.0]]
velocity = [6.4, 0.0]
pinned = []
color = "#ffffff"
[style]
background = "#000000"
rope_width_px = 16
payload = false
[overlay]
time = false
scale_bar = false
[camera]
center = [0.0, 0.0]
height = 0.6
[video]
size = [200, 60]
fps = 10
shutter = 1.0
subframes = 64
)");
    const auto worst_of = [&](std::int64_t k, double middle_px, double way_px) {
        const Image frame = film.frame(k);
        double worst = 0.0;
        for (int x = 0; x < 200; ++x) {
            const double v = frame.pixel(x, 30)[0] / 255.0;
            const double light = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
            worst = std::max(worst, std::abs(light - covered_share(x + 0.5 - middle_px, way_px)));
        }
        return worst;
    };
    // Measured 0.0078, a half of one of 64 sub-frames, and 0.0149: edges move by half pixels there, and are
    // not painted in linear light.
    EXPECT_LT(worst_of(1, 100.0, 64.0), 0.009);
    EXPECT_LT(worst_of(0, 52.0, 32.0), 0.016);  // the shutter opens at the start
}

}  // namespace
}  // namespace corda
