#include <gtest/gtest.h>

#include "corda/film/film.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

const char* const kSceneOfLooks = R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 8, length = 1.0, angle_deg = 60.0 }
[style]
trail_s = 0.5
[video]
size = [192, 108]
fps = 20
)";

TEST(FilmLook, EqualsASceneOfThatLookAndSharesItsMotion) {
    Scene scene = parse_scene(std::string(kSceneOfLooks) + "[solver]\nmethod = \"exact\"\n", "a");
    Film film(scene);
    Scene look = scene;
    look.video.width_px = 96;
    look.video.height_px = 96;
    look.style.theme = Theme::kPaper;
    Film shown = film.with_look(look);
    EXPECT_TRUE(test::equal_images(shown.still(0.75), Film(look).still(0.75)));
    EXPECT_EQ(film.still(0.75).width(), 192);
    EXPECT_EQ(&film.motion(), &shown.motion());
}

TEST(FilmLook, HasThePlanOfItsFilm) {
    const Scene scene = parse_scene(kSceneOfLooks, "a");
    Film film(scene);
    Scene look = scene;
    look.video.width_px *= 2;
    look.video.height_px *= 2;
    Film shown = film.with_look(look);
    EXPECT_EQ(shown.plan().error_estimate_m, film.plan().error_estimate_m);
    EXPECT_NEAR(*shown.error_estimate_px(), 2.0 * *film.error_estimate_px(), 0.1 * *film.error_estimate_px());
}

TEST(FilmLook, HasThePlotsOfItsFilm) {
    const Scene scene = parse_scene(std::string(kSceneOfLooks) + "[overlay]\nplots = [\"angle\"]\n", "a");
    Film film(scene);
    Scene look = scene;
    look.video.width_px *= 2;
    look.video.height_px *= 2;
    EXPECT_TRUE(test::equal_images(film.with_look(look).still(0.75), Film(look).still(0.75)));
    look.overlay.plots = {LivePlot::kEnergy};
    EXPECT_EQ(test::code_of([&] { std::ignore = film.with_look(look); }), ExitCode::kInternal);
}

TEST(FilmLook, RefusesQuantitiesThatTheMotionLacks) {
    Film film(parse_scene(kSceneOfLooks, "a"));
    Scene look = film.scene();
    look.style.color_by = ColorBy::kTension;
    EXPECT_EQ(test::code_of([&] { std::ignore = film.with_look(look); }), ExitCode::kInternal);
}

}  // namespace
}  // namespace corda
