#include <gtest/gtest.h>

#include "corda/film/film_renderer.hpp"
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

TEST(FilmLook, EqualsASceneOfThatLookWithoutAnotherRun) {
    Scene scene = parse_scene(std::string(kSceneOfLooks) + "[solver]\nmethod = \"exact\"\n", "a");
    Film film(scene);
    Scene look = scene;
    look.video.width_px = 96;
    look.video.height_px = 96;
    look.style.theme = Theme::kPaper;
    Film shown = FilmRenderer::another_look(film, look);
    EXPECT_TRUE(test::equal_images(shown.still(0.75), Film(look).still(0.75)));
    EXPECT_EQ(film.still(0.75).width(), 192);
    EXPECT_EQ(film.simulation_passes(), 1);
    EXPECT_EQ(shown.simulation_passes(), 1);
}

TEST(FilmLook, HasThePlanOfItsFilm) {
    const Scene scene = parse_scene(kSceneOfLooks, "a");
    Film film(scene);
    Scene look = scene;
    look.video.width_px *= 2;
    look.video.height_px *= 2;
    Film shown = FilmRenderer::another_look(film, look);
    EXPECT_EQ(shown.plan().error_estimate_m, film.plan().error_estimate_m);
    EXPECT_NEAR(*shown.error_estimate_px(), 2.0 * *film.error_estimate_px(), 0.1 * *film.error_estimate_px());
}

TEST(FilmLook, RefusesQuantitiesThatTheMotionLacks) {
    Film film(parse_scene(kSceneOfLooks, "a"));
    Scene look = film.scene();
    look.style.color_by = ColorBy::kTension;
    EXPECT_EQ(test::code_of([&] { std::ignore = FilmRenderer::another_look(film, look); }),
              ExitCode::kInternal);
}

TEST(FilmLook, DrawsKeptStatesBeyondTheBudgetWithoutAnotherRun) {
    FilmDef def;
    def.motion_budget_bytes = 0;
    const Scene scene = parse_scene(kSceneOfLooks, "a", {"solver.method=\"exact\"", "style.trail_s=0"});
    Film film(scene, def);
    static_cast<void>(film.camera());
    FilmRenderer::keep(film, std::vector<double>{0.2, 0.5, 0.8});
    const int passes = film.simulation_passes();
    for (const double time_s : {0.8, 0.2, 0.5})
        EXPECT_TRUE(test::equal_images(film.still(time_s), Film(scene).still(time_s)));
    EXPECT_EQ(film.simulation_passes(), passes);
}

}  // namespace
}  // namespace corda
