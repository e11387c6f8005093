#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "corda/film/film.hpp"
#include "corda/render/frame_renderer.hpp"
#include "support/draw_list_of.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

Scene pendulum(const std::string& style, const std::string& more = "") {
    return parse_scene(R"(schema = 1
[world]
duration = 0.8
[[rope]]
hang = { links = 2, length = 1.0, angle_deg = 110.0 }
[solver]
method = "exact"
[video]
size = [320, 240]
fps = 20
[style]
)" + style + more,
                       "arrows.toml");
}

TEST(FilmArrows, StayInThePictureOfAFittedCamera) {
    for (const char* const camera : {"", "[camera]\nfollow = \"tip\"\nmargin = 0.0\n"}) {
        for (const char* const kind : {"velocity", "tension", "weight"}) {
            Film film(pendulum("arrows = \"" + std::string(kind) + "\"\n", camera));
            for (std::int64_t k = 0; k < film.frame_count(); ++k) {
                const double time_s = film.time_s(k);
                const view::DrawList list = test::poses_of(film, {time_s});
                std::size_t notes = 0;
                for (const view::Layer& layer : list.layers) {
                    if (!layer.is_note) continue;
                    ++notes;
                    for (std::size_t i = 0; i < layer.capsule_count; ++i) {
                        const view::Capsule& line = list.capsules[layer.first_capsule + i];
                        const view::Surroundings box = surroundings(line, line.radius);
                        EXPECT_TRUE(box.x0 > -0.1F && box.y0 > -0.1F && box.x1 < 320.1F && box.y1 < 240.1F)
                            << kind << ' ' << k << ' ' << camera;
                    }
                }
                EXPECT_EQ(notes, 2U);  // with that of the legend
            }
        }
    }
}

TEST(FilmArrows, HaveALegendOfARoundValueInBlurredFramesToo) {
    Film film(pendulum("arrows = \"velocity\"\n", "[overlay]\nscale_bar = false\n"));
    const double time_s = 0.5;
    const view::DrawList list = test::poses_of(film, {time_s});
    ASSERT_EQ(list.texts.size(), 2U);
    EXPECT_THAT(list.texts[0].utf8, testing::MatchesRegex("[125] m/s"));
    // The arrow of the legend is where it is in a sharp frame: nothing else moves there.
    const Image sharp = film.still(0.5);
    const Image blurred = film.still(0.5, 0.5);
    const view::Layer& legend = list.layers.back();
    const PixelRect box = capsule_bounds(list.capsules[legend.first_capsule], 320, 240);
    EXPECT_GT(box.width(), 10);
    for (int x = box.x0; x < box.x1; ++x)
        EXPECT_EQ(blurred.pixel(x, box.y0 + 2)[1], sharp.pixel(x, box.y0 + 2)[1]) << x;
}

/// A string that falls and snaps, in a picture of a given camera.
Scene snap(int fps) {
    return parse_scene(R"(schema = 1
[world]
duration = 2
[[rope]]
string = true
hang = { length = 1, links = 6, angle_deg = 170 }
[solver]
method = "exact"
[style]
arrows = "tension"
[overlay]
scale_bar = false
[camera]
center = [0.0, 0.0]
height = 3.0
[video]
size = [320, 240]
fps = )" + std::to_string(fps),
                       "snap.toml");
}

TEST(FilmArrows, OfASnapAreCutAndExplained) {
    Film film(snap(30));
    const double time_s = 0.0;
    const view::DrawList list = test::poses_of(film, {time_s});
    ASSERT_EQ(list.texts.size(), 2U);
    EXPECT_THAT(list.texts[0].utf8, testing::MatchesRegex("≥ [1-9]0* N"));
    Film calm(pendulum("arrows = \"tension\"\n"));
    EXPECT_THAT(test::poses_of(calm, {time_s}).texts[0].utf8, testing::MatchesRegex("[125]0* N"));
}

TEST(FilmArrows, HaveOneScaleAtAnyFrameRate) {
    Film fast(snap(60));
    Film slow(snap(20));
    for (const double time_s : {0.0, 0.5, 1.0, 1.5})
        EXPECT_TRUE(test::equal_images(fast.still(time_s), slow.still(time_s))) << time_s;
}

TEST(FilmArrows, EqualTheReferenceByteForByte) {
    for (const char* const style :
         {"arrows = \"tension\"\n", "arrows = \"velocity\"\ntrail_s = 0.4\ntrail_of = [1, -1]\n"}) {
        Film film(pendulum(style));
        EXPECT_TRUE(
            test::equal_images(film.still(0.5), render::render_reference(test::draw_list_of(film, 0.5))));
    }
}

TEST(FilmArrows, OfTensionsNeedAMethodThatKnowsThem) {
    Scene scene = pendulum("arrows = \"tension\"\n");
    scene.solver = RelaxationDef{};
    EXPECT_THAT(test::failure_of([&] { static_cast<void>(Film(scene).frame(0)); }).message,
                testing::HasSubstr("style.arrows = \"velocity\""));
}

TEST(Strobe, NamesTheTimesOfItsPosesSideBySide) {
    Film film(pendulum(""));
    const std::vector<double> times_s{0.0, 0.01, 0.25, 0.5, 0.75};
    const view::DrawList list = test::poses_of(film, times_s);
    std::vector<std::string> words;
    view::Font font;
    std::vector<PixelRect> inks;
    for (const view::Text& text : list.texts) {
        if (text.utf8.find(" s") == std::string::npos) continue;
        words.push_back(text.utf8);
        inks.push_back(font.ink(text));
        for (std::size_t i = 0; i + 1 < inks.size(); ++i)
            EXPECT_TRUE(inks[i].intersected(inks.back()).empty()) << text.utf8;
    }
    // The balls of the first two cover each other.
    EXPECT_EQ(words, (std::vector<std::string>{"0.75 s", "0.50 s", "0.25 s"}));
    EXPECT_EQ(test::poses_of(film, {times_s[0]}).texts[0].utf8, "t = 0.00 s");
    Film without(pendulum("", "[overlay]\ntime = false\nscale_bar = false\n"));
    EXPECT_TRUE(test::poses_of(without, times_s).texts.empty());
}

}  // namespace
}  // namespace corda
