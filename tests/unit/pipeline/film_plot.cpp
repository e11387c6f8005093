#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/pipeline/film_renderer.hpp"
#include "corda/pipeline/live_plot_data.hpp"
#include "support/draw_list_of.hpp"
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

view::PlotData plot_of(Film& film) {
    return test::plotted_of(film).value();
}

TEST(FilmPlot, ShowsTheEnergyOfAPendulum) {
    Film film(plotted_scene("energy"));
    const view::PlotData data = plot_of(film);
    ASSERT_EQ(data.curves.size(), 3U);
    // 3 kg that fall by up to 2 m: 58.86 J. One of the 4000 times is within 0.125 ms of the lowest point,
    // where the speed is 6.3 m/s: 0.8 mm aside, 5e-6 J.
    EXPECT_GT(data.curves[0].points.size(), 4000U);
    for (std::size_t i = 0; i < data.curves[0].points.size(); i += 7) {
        const double kinetic_j = data.curves[0].points[i].y;
        const double potential_j = data.curves[1].points[i].y;
        const State& state = film.state_at(data.curves[0].points[i].time_s);
        EXPECT_NEAR(kinetic_j, 3.0 * 9.81 * -state.y_m[1], 1e-5 * 58.86);
        EXPECT_NEAR(kinetic_j + potential_j, 58.86, 1e-3);
        EXPECT_DOUBLE_EQ(data.curves[2].points[i].y, kinetic_j + potential_j);
    }
    const auto is_zero = [](const view::CurvePoint& point) { return point.y == 0.0; };
    EXPECT_EQ(std::count_if(data.curves[1].points.begin(), data.curves[1].points.end(), is_zero), 1);
}

TEST(FilmPlot, HasNoTotalEnergyWithRelaxation) {
    Film film(plotted_scene("energy", {"solver.method=relaxation", "solver.step=0.01"}));
    EXPECT_EQ(plot_of(film).curves.size(), 2U);
}

TEST(FilmPlot, DoesNotDependOnTheFrameRate) {
    Film often(plotted_scene("tip", {"video.fps=50"}));
    Film seldom(plotted_scene("tip", {"video.fps=2"}));
    // The times between frames are the same, and those of few frames are among those of many.
    const auto points = plot_of(seldom).curves[0].points;
    const auto others = plot_of(often).curves[0].points;
    ASSERT_GT(points.size(), 4000U);
    for (std::size_t i = 0, k = 0; i < points.size(); i += 100) {
        while (others[k].time_s < points[i].time_s) ++k;
        EXPECT_EQ(others[k].time_s, points[i].time_s);
        EXPECT_NEAR(others[k].y, points[i].y, 1e-4);
    }
}

TEST(FilmPlot, IsSharpInABlurredFrame) {
    const Scene scene = plotted_scene("tip", {"video.shutter=1"});
    Film film(scene);
    const Image blurred = film.frame(12);
    const Image sharp = film.still(film.time_s(12));
    const view::Room room = view::room_beside(LivePlot::kTip, 256, 144);
    ASSERT_LT(room.width_px, 256);
    EXPECT_FALSE(blurred == sharp);
    const auto row_bytes = static_cast<std::size_t>(4 * (256 - room.width_px));
    for (int y = 0; y < 144; ++y) {
        const std::uint8_t* const row = blurred.pixel(room.width_px, y);
        EXPECT_TRUE(std::equal(row, row + row_bytes, sharp.pixel(room.width_px, y))) << y;
    }
}

TEST(FilmPlot, ShowsTheTipInWorldCoordinates) {
    Film film(plotted_scene("tip"));
    const view::PlotData data = plot_of(film);
    EXPECT_EQ(data.curves[0].points.front().y, 7.0);
    EXPECT_EQ(data.curves[1].points.front().y, 7.0);
    Film phase(plotted_scene("phase"));
    const view::PlotData portrait = plot_of(phase);
    EXPECT_EQ(portrait.curves[0].points.front().x, 7.0);
    EXPECT_EQ(portrait.curves[0].points.front().y, 0.0);
    EXPECT_LT(portrait.curves[0].points.back().y, 0.0);
}

TEST(FilmPlot, DoesNotChangeTheMotionAndSimulatesItOnce) {
    Scene scene = plotted_scene("energy");
    Film film(scene);
    static_cast<void>(film.frame(3));
    scene.overlay.plot = LivePlot::kNone;
    Film plain(scene);
    static_cast<void>(plain.frame(3));
    for (const std::int64_t k : {0, 7, 30}) EXPECT_EQ(film.state(k).x_m, plain.state(k).x_m);
    EXPECT_EQ(film.simulation_passes(), plain.simulation_passes());
}

TEST(FilmPlot, IsTheSameInAnyOrderWithAnyMemory) {
    for (const char* const shutter : {"video.shutter=0", "video.shutter=0.5"}) {
        for (const char* const plot : {"energy", "tip", "phase"}) {
            const Scene scene = plotted_scene(plot, {shutter});
            FilmDef forgetful;
            forgetful.motion_budget_bytes = 0;
            Film film(scene);
            Film other(scene, forgetful);
            FilmRenderer renderer(film);
            for (std::int64_t k = 0; k < 6; ++k) {
                renderer.draw(film.time_s(k));
                EXPECT_TRUE(test::equal_images(renderer.image(), other.frame(k))) << plot << " " << k;
            }
            const Image second = renderer.image();
            EXPECT_TRUE(test::equal_images(film.frame(5), second));
            EXPECT_FALSE(film.frame(2) == second);
        }
    }
}

TEST(FilmPlot, DoesNotMakeAnEmptyFrameNonEmpty) {
    Film film(plotted_scene("tip", {"camera.center=[100,100]", "camera.height=1"}));
    static_cast<void>(film.still(0.5));
    EXPECT_TRUE(film.shows_nothing());
    const double time_s = 0.5;
    EXPECT_TRUE(FilmRenderer::list_poses(film, {&time_s, 1}).shows_nothing());
}

TEST(FilmPlot, NeedsAMotion) {
    EXPECT_EQ(test::code_of([] { const Renderer renderer(plotted_scene("tip")); }), ExitCode::kInvalidScene);
}

}  // namespace
}  // namespace corda
