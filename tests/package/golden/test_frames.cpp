#include <gtest/gtest.h>

#include <corda/corda.hpp>
#include <corda/testing.hpp>

TEST(Swing, LooksAsItDid) {
    corda::Scene scene = corda::load_scene(SCENE);
    scene.video.width_px = 320;
    scene.video.height_px = 180;
    corda::Film film(scene);
    EXPECT_THAT(film.frame(30), corda::testing::MatchesGolden("swing_0030.png", {.folder = REF}));
}
