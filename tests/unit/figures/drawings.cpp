#include "corda/figures/drawings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "corda/media/defs.hpp"
#include "support.hpp"
#include "support/command.hpp"

namespace corda::figures {
namespace {

using testing::ElementsAre;

TEST(Drawings, HaveTheShapeOfTheSceneAtThreeHundredPixelsPerInch) {
    Scene scene = parse_scene("schema = 1\n" + pendulum_toml(), "a");
    scene.style.rope_width_px = 4.0;
    scene.overlay.plots = {LivePlot::kEnergy};
    const Scene look = look_in_print(scene, 85.0);
    EXPECT_EQ(look.video.width_px, 1004);
    EXPECT_EQ(look.video.height_px, 565);
    EXPECT_NEAR(*look.style.rope_width_px, 4.0 * 1004 / 320, 0.01);
    EXPECT_NEAR(*look.overlay.text_px, 8.0 / 72.0 * 300.0, 1e-9);  // 8 points
    EXPECT_TRUE(look.overlay.plots.empty());
    scene.video.width_px = 100;
    scene.video.height_px = 10000;
    EXPECT_EQ(look_in_print(scene, 85.0).video.height_px, 1406);  // fits a page
}

TEST(Drawings, ReuseTheMotion) {
    ReadScene scene(pendulum_toml());
    const test::ScratchFolder folder;
    Drawings drawings(scene.film);
    for (const char* name : {"a.svg", "a.pdf", "a.png"}) {
        drawings.write(folder.file(name), 85.0, {0.0, 0.5}, {});
        drawings.write(folder.file(std::string("wide_") + name), 170.0, {0.0, 0.5}, {});
    }
    EXPECT_EQ(scene.film.simulation_passes(), 1);
    EXPECT_EQ(read_png(folder.file("a.png")).width(), 1004);
    EXPECT_EQ(read_png(folder.file("wide_a.png")).width(), 2008);
    EXPECT_NEAR(read_png_info(folder.file("wide_a.png")).pixels_per_inch, 300.0, 0.1);
    EXPECT_NE(test::read_file(folder.file("a.svg")).find("width=\"85mm\""), std::string::npos);
}

TEST(FigureTimes, AreThoseOfTheFirstSwing) {
    ReadScene scene(pendulum_toml("duration = 3.0", "100"));
    const FigureTimes times = find_figure_times(scene.film, scene.motion, {});
    EXPECT_TRUE(times.is_swing);
    ASSERT_EQ(times.strobe_s.size(), 6U);
    EXPECT_EQ(times.strobe_s.front(), 0.0);
    // Half the period at 60 degrees: 1.0765 s (R2).
    EXPECT_NEAR(times.strobe_s.back(), 1.0765, 0.01);
    EXPECT_THAT(times.stills_s, ElementsAre(0.0, 0.75, 1.5, 2.25, 3.0));
    for (const double time_s : times.strobe_s) EXPECT_EQ(scene.film.state_at(time_s).time_s, time_s);
    EXPECT_EQ(scene.film.simulation_passes(), 1);  // all of them are recorded
}

TEST(FigureTimes, AreThoseOfTheWholeMotionIfNothingSwings) {
    ReadScene scene(
        "[world]\nduration = 1.0\n[[rope]]\npoints = [[0.0, 0.0], [1.0, 0.0]]\npinned = []\n[video]\nfps = "
        "10\n");
    const FigureTimes times = find_figure_times(scene.film, scene.motion, {});
    EXPECT_FALSE(times.is_swing);
    EXPECT_THAT(times.strobe_s, ElementsAre(0.0, 0.2, 0.4, 0.6, 0.8, 1.0));
}

TEST(FigureTimes, AreTheRequestedOnes) {
    ReadScene scene(pendulum_toml(), {0.123, 0.456});
    const FigureTimes times = find_figure_times(scene.film, scene.motion, {0.456, 0.123});
    EXPECT_THAT(times.strobe_s, ElementsAre(0.123, 0.456));
    EXPECT_THAT(times.stills_s, ElementsAre(0.123, 0.456));
    EXPECT_EQ(scene.film.state_at(0.456).time_s, 0.456);
    EXPECT_EQ(scene.film.simulation_passes(), 1);
}

}  // namespace
}  // namespace corda::figures
