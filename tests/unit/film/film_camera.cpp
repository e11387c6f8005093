// Cameras that move.
#include <gmock/gmock.h>

#include <string>

#include "corda/film/film.hpp"
#include "corda/scene/write_scene.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using testing::HasSubstr;

Film film_with_camera(const std::string& camera, const std::string& video = "", const char* angle_deg = "40",
                      const std::vector<std::string>& settings = {}) {
    return Film(
        parse_scene("schema = 1\n[world]\nduration = 1.0\n"
                    "[[rope]]\nhang = { links = 4, length = 1.0, angle_deg = " +
                        std::string(angle_deg) + " }\n[video]\nsize = [96, 64]\nfps = 20\n" + video +
                        "[camera]\n" + camera,
                    "film.toml", settings));
}

TEST(FilmCamera, OfAPathIsAtItsKeys) {
    Film film = film_with_camera(
        "path = [{ t = 0.0, center = [0.0, 0.0], height = 3.0 }, { t = 0.5, height = 1.0 }]\n");
    Film still = film_with_camera("center = [0.0, 0.0]\nheight = 3.0\n");
    EXPECT_TRUE(test::equal_images(film.frame(0), still.frame(0)));
    const Vec2 base = *film.camera().center_m;
    EXPECT_EQ(film.to_pixels({{base}}, 0.7).at(0),
              (Vec2{48.0, 32.0}));  // a key without a centre has the fitted one
    EXPECT_NE(film.to_pixels({{base}}, 0.2).at(0), (Vec2{48.0, 32.0}));
}

TEST(FilmCamera, ThatFollowsKeepsItInTheMiddleOfAllThatIsInView) {
    Film film = film_with_camera("follow = \"tip\"\n");
    for (const std::int64_t k : {0, 5, 20}) {
        const State state = film.state(k);
        std::vector<Vec2> points;
        for (std::size_t i = 0; i < state.x_m.size(); ++i) points.push_back({state.x_m[i], state.y_m[i]});
        for (const Vec2 pixel : film.to_pixels(points, film.time_s(k))) {
            EXPECT_GE(pixel.x, 0.0);
            EXPECT_LE(pixel.x, 96.0);
            EXPECT_GE(pixel.y, 0.0);
            EXPECT_LE(pixel.y, 64.0);
        }
        const Vec2 tip = film.to_pixels({{points.back()}}, film.time_s(k)).at(0);
        // The place is averaged over 0.2 s.
        EXPECT_NEAR(tip.x, 48.0, 6.0) << k;
        EXPECT_NEAR(tip.y, 32.0, 6.0) << k;
    }
    Film resting = film_with_camera("follow = 0\n", "", "0");
    const Vec2 middle =
        resting.to_pixels({{Vec2{0.0, -0.5}}}, 0.5).at(0);  // of mass: 4 and the pin of 1 kg each
    EXPECT_NEAR(middle.x, 48.0, 1e-9);
    EXPECT_NEAR(middle.y, 32.0, 1e-9);
}

TEST(FilmCamera, ThatFollowsKeepsItInTheMiddleOfWhatPlotsLeave) {
    const std::string plot = "[overlay]\nplots = [\"angle\"]\n";
    const std::vector<std::string> large{"video.size=[640,360]"};
    Film plain = film_with_camera("follow = 0\n", "", "0", large);
    Film beside = film_with_camera("follow = 0\n" + plot, "", "0", large);
    Film wider = film_with_camera("follow = 0\nheight = 2.0\n" + plot, "", "0", large);
    const Vec2 mass{0.0, -0.5};
    const double middle_px = beside.to_pixels({{mass}}, 0.5).at(0).x;
    EXPECT_LT(middle_px, 240.0);
    EXPECT_NEAR(wider.to_pixels({{mass}}, 0.5).at(0).x, middle_px, 1e-9);
    // The height of the rope limits both pictures.
    EXPECT_NEAR(*beside.camera().height_m, *plain.camera().height_m, 1e-9);
}

TEST(FilmCamera, BlurFollowsTheMovingCamera) {
    const std::string path =
        "path = [{ t = 0.0, center = [-1.0, -0.5], height = 2.0 }, { t = 1.0, center = [1.0, -0.5], height = "
        "2.0 }]\n";
    Film blurred = film_with_camera(path, "shutter = 1.0\n", "0");
    Film sharp = film_with_camera(path, "", "0");
    // The rope rests, and the picture moves.
    EXPECT_FALSE(test::equal_images(blurred.frame(10), sharp.frame(10)));
    EXPECT_TRUE(test::equal_images(blurred.still(0.5), sharp.still(0.5)));
}

TEST(FilmCamera, IsWrittenAndFrozen) {
    for (const char* const camera :
         {"follow = \"tip\"\n", "follow = 0\nheight = 2.0\n",
          "path = [{ t = 0.0, height = 3.0 }, { t = 0.5, center = [1.0, 0.0] }]\n"}) {
        Film film = film_with_camera(camera);
        Film again(parse_scene(write_scene(frozen_scene(film)), "again.toml"));
        EXPECT_TRUE(test::equal_images(again.frame(7), film.frame(7))) << camera;
    }
}

TEST(FilmCamera, RefusesWhatItCannotDo) {
    const auto message_of = [](const std::string& camera) {
        return test::failure_of([&] { static_cast<void>(film_with_camera(camera)); }).message;
    };
    EXPECT_THAT(message_of("follow = 1\n"),
                HasSubstr("camera.follow: 1 is out of range; the ropes and nets are 0 .. 0"));
    EXPECT_THAT(message_of("follow = \"top\"\n"), HasSubstr("did you mean \"tip\"?"));
    EXPECT_THAT(message_of("follow = 0\npath = [{ t = 0 }]\n"),
                HasSubstr("remove camera.follow or camera.path"));
    EXPECT_THAT(message_of("path = [{ t = 1 }, { t = 1 }]\n"),
                HasSubstr("camera.path: 1 s after 1 s; give times that increase"));
}

}  // namespace
}  // namespace corda
