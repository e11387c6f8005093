#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/pipeline/curves.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/pipeline/painter.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

Scene plotted_scene(const std::string& plot, const std::vector<Setting>& settings = {}) {
    std::vector<Setting> all{"overlay.plot=\"" + plot + "\""};
    all.insert(all.end(), settings.begin(), settings.end());
    return parse_scene(R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 1, length = 2.0, angle_deg = 90.0, from = [5.0, 7.0] }
mass = 3.0
[video]
size = [256, 144]
fps = 30
)",
                       "plot.toml", all);
}

view::PlotData plot_of(const Film& film) {
    pipeline::Curves curves(film.scene(), film.system());
    const MethodDef method = film.plan().bodies.front().method;
    return curves.read({&method, 1}, film.last_frame() + 1,
                       [&](std::int64_t k) -> const State& { return film.state(k); });
}

TEST(FilmPlot, TellsTheEnergyOfAPendulum) {
    const Film film(plotted_scene("energy"));
    const view::PlotData data = plot_of(film);
    ASSERT_EQ(data.curves.size(), 3U);
    // 3 kg that fall by up to 2 m: 58.86 J. No frame is at the lowest point, but one is within half a frame
    // of it, where the speed is 6.3 m/s: 0.1 m aside, 3 mm high, 0.08 J.
    double least_potential_j = 1e9;
    for (std::size_t i = 0; i < data.curves[0].points.size(); ++i) {
        const double kinetic_j = data.curves[0].points[i].y;
        const double potential_j = data.curves[1].points[i].y;
        const State& state = film.state(static_cast<std::int64_t>(i));
        EXPECT_NEAR(kinetic_j, 3.0 * 9.81 * -state.y_m[1], 1e-5 * 58.86);
        EXPECT_NEAR(kinetic_j + potential_j, 58.86, 0.1);
        EXPECT_DOUBLE_EQ(data.curves[2].points[i].y, kinetic_j + potential_j);
        least_potential_j = std::min(least_potential_j, potential_j);
    }
    EXPECT_EQ(least_potential_j, 0.0);
}

TEST(FilmPlot, TellsThePlaceOfTheTipInTheWorld) {
    const Film film(plotted_scene("tip"));
    const view::PlotData data = plot_of(film);
    EXPECT_EQ(data.curves[0].points.front().y, 7.0);
    EXPECT_EQ(data.curves[1].points.front().y, 7.0);
    const Film phase(plotted_scene("phase"));
    const view::PlotData portrait = plot_of(phase);
    EXPECT_EQ(portrait.curves[0].points.front().x, 7.0);
    EXPECT_EQ(portrait.curves[0].points.front().y, 0.0);
    EXPECT_LT(portrait.curves[0].points.back().y, 0.0);
}

TEST(FilmPlot, LeavesTheMotionAloneAndSimulatesItOnce) {
    Scene scene = plotted_scene("energy");
    const Film film(scene);
    static_cast<void>(film.frame(3));
    scene.overlay.plot = LivePlot::kNone;
    const Film plain(scene);
    static_cast<void>(plain.frame(3));
    for (const std::int64_t k : {0, 7, 30}) EXPECT_EQ(film.state(k).x_m, plain.state(k).x_m);
    EXPECT_EQ(film.simulation_passes(), plain.simulation_passes());
}

TEST(FilmPlot, IsTheSameInAnyOrderAndMemory) {
    for (const char* const shutter : {"video.shutter=0", "video.shutter=0.5"}) {
        for (const char* const plot : {"energy", "tip", "phase"}) {
            const Scene scene = plotted_scene(plot, {shutter});
            FilmDef forgetful;
            forgetful.motion_budget_bytes = 0;
            const Film film(scene);
            const Film other(scene, forgetful);
            FilmPainter painter(film);
            for (std::int64_t k = 0; k < 6; ++k) {
                painter.draw(film.time_s(k));
                EXPECT_TRUE(test::equal_images(painter.image(), other.frame(k))) << plot << " " << k;
            }
            const Image second = painter.image();
            EXPECT_TRUE(test::equal_images(film.frame(5), second));
            EXPECT_FALSE(film.frame(2) == second);
        }
    }
}

TEST(FilmPlot, IsNothingOfTheSceneInView) {
    const Film film(plotted_scene("tip", {"camera.center=[100,100]", "camera.height=1"}));
    static_cast<void>(film.still(0.5));
    EXPECT_TRUE(film.shows_nothing());
    const double time_s = 0.5;
    EXPECT_TRUE(FilmPainter::poses(film, {&time_s, 1}).shows_nothing());
}

TEST(FilmPlot, IsNotForPositionsAlone) {
    EXPECT_EQ(test::code_of([] { const Renderer renderer(plotted_scene("tip")); }), ExitCode::kInvalidScene);
}

}  // namespace
}  // namespace corda
