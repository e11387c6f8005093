#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/film/draw.hpp"
#include "corda/film/film.hpp"
#include "corda/film/live_plots.hpp"
#include "corda/film/plan_text.hpp"
#include "support/draw_list_of.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

Scene plotted_scene(const std::string& plot, const std::vector<Setting>& settings = {}) {
    std::vector<Setting> all{"overlay.plots=[\"" + plot + "\"]"};
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
    return film::plots_of(film.scene(), film.motion()).at(0);
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
        EXPECT_NEAR(kinetic_j + potential_j, 0.0, 1e-3);
        EXPECT_DOUBLE_EQ(data.curves[2].points[i].y, kinetic_j + potential_j);
    }
    EXPECT_EQ(data.curves[1].points.front().y, 0.0);
}

TEST(FilmPlot, ShowsThePotentialEnergyFromItsLowestValueOn) {
    Film film(plotted_scene("energy", {"overlay.energy_zero=lowest"}));
    const view::PlotData data = plot_of(film);
    double lowest_j = HUGE_VAL;
    for (std::size_t i = 0; i < data.curves[0].points.size(); ++i) {
        lowest_j = std::min(lowest_j, data.curves[1].points[i].y);
        EXPECT_NEAR(data.curves[2].points[i].y, 58.86, 1e-3);
    }
    EXPECT_EQ(lowest_j, 0.0);
    EXPECT_NEAR(data.curves[1].points.front().y, 58.86, 1e-5);
    // The same without a plot, for the text, at any frame rate.
    for (const char* const fps : {"video.fps=3", "video.fps=30"}) {
        const Film shown(plotted_scene("tip", {"overlay.plots=[]", "overlay.energy=true", "world.drag=0.1",
                                               "overlay.energy_zero=lowest", fps}));
        EXPECT_NEAR(shown.look().energy_zero_j, -58.86, 1e-3) << fps;
    }
}

TEST(FilmPlot, HasTheRangesOfTheScene) {
    const Film film(plotted_scene("phase", {"overlay.plots=[\"phase\", \"angle\"]",
                                            "overlay.plot_range={ angle = [-180, 90], phase = [-4, 5] }"}));
    const auto data = film::plots_of(film.scene(), film.motion());
    EXPECT_EQ(data[0].x.range, (Interval{-std::numbers::pi, 0.5 * std::numbers::pi}));
    EXPECT_EQ(data[0].y.range, (Interval{-4.0, 5.0}));
    EXPECT_EQ(data[1].x.range, std::nullopt);
    EXPECT_EQ(data[1].y.range, (Interval{-180.0, 90.0}));
}

/// The rows of names above each plot, from its title down, in a film of two ropes.
TEST(FilmPlot, NamesCurvesOfSeveralPlotsInOneRow) {
    for (const char* const language : {"en", "de", "pt", "es", "fr"}) {
        for (const auto& [width, height] : {std::pair{1920, 1080}, {1280, 720}, {640, 360}}) {
            const Film film(parse_scene(
                fmt::format("schema = 1\n[world]\nduration = 0.5\n"
                            "[[rope]]\nlabel = \"A\"\nhang = {{ links = 2, length = 1.0, angle_deg = 30 }}\n"
                            "[[rope]]\nlabel = \"B\"\nhang = {{ links = 2, length = 1.0, angle_deg = 31 }}\n"
                            "[overlay]\nlanguage = \"{}\"\nplots = [\"energy\", \"angle\", \"phase\", "
                            "\"divergence\"]\n[video]\nsize = [{}, {}]\n",
                            language, width, height),
                "plots.toml"));
            const auto plots = film::plots_of(film.scene(), film.motion());
            const view::PlotLayout layout = view::lay_out_plots(plots.size(), width, height);
            ASSERT_EQ(layout.panels.size(), 4U);
            view::DrawList list;
            list.width = width;
            list.height = height;
            film::draw(film.look(), film.motion(), 0.0, list);
            for (std::size_t p = 0; p < plots.size(); ++p) {
                std::vector<int> rows;
                for (const view::Text& text : list.texts) {
                    const bool is_name = std::ranges::any_of(
                        plots[p].curves, [&](const auto& curve) { return curve.name == text.utf8; });
                    const PixelRect ink = view::Font().ink(text);
                    if (is_name && ink.intersected(layout.panels[p]) == ink) rows.push_back(text.y_px);
                }
                std::size_t names = 0;
                for (const auto& curve : plots[p].curves) names += curve.name.empty() ? 0 : 1;
                EXPECT_EQ(rows.size(), names) << language << " " << width << " " << p;
                EXPECT_EQ(std::ranges::count(rows, rows.empty() ? 0 : rows.front()), std::ssize(rows))
                    << language << " " << width << " " << p;
            }
        }
    }
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
    const view::PlotLayout room = view::lay_out_plots(1, 256, 144);
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
}

TEST(FilmPlot, ShowsTheAngleInDegreesAndItsRate) {
    Film film(plotted_scene("angle"));
    const view::PlotData angle = plot_of(film);
    Film other(plotted_scene("phase"));
    const view::PlotData phase = plot_of(other);
    ASSERT_EQ(angle.curves.size(), 1U);
    EXPECT_EQ(angle.curves[0].body, 0U);
    EXPECT_NEAR(angle.curves[0].points.front().y, 90.0, 1e-12);
    EXPECT_NEAR(phase.curves[0].points.front().x, std::numbers::pi / 2.0, 1e-14);
    for (std::size_t i = 0; i < angle.curves[0].points.size(); i += 7) {
        const double angle_rad = phase.curves[0].points[i].x;
        EXPECT_DOUBLE_EQ(angle.curves[0].points[i].y, angle_rad * 180.0 / std::numbers::pi);
        // What has fallen from the height of the pin is kinetic energy: l w^2 = 2 g cos(angle).
        const double rate_rad_s = phase.curves[0].points[i].y;
        EXPECT_NEAR(2.0 * rate_rad_s * rate_rad_s, 2.0 * 9.81 * std::cos(angle_rad), 1e-3);
    }
}

TEST(FilmPlot, HasNoAngleNextToThePin) {
    // A slack string, without gravity: its end passes the pin at 2 m/s.
    const Film film(parse_scene(
        "schema = 1\n[world]\ngravity = 0\nduration = 1\n[[rope]]\npoints = [[0, 0], [1, 0.001]]\n"
        "string = true\nlink_length = 2\nvelocity = [-2, 0]\n[overlay]\nplots = [\"angle\"]\n",
        "plot.toml"));
    const auto data = film::plots_of(film.scene(), film.motion());
    std::size_t gaps = 0;
    for (const view::CurvePoint& point : data.at(0).curves.at(0).points) {
        EXPECT_EQ(std::isnan(point.y), std::hypot(1.0 - 2.0 * point.time_s, 0.001) < 0.2) << point.time_s;
        gaps += std::isnan(point.y) ? 1 : 0;
    }
    EXPECT_GT(gaps, 700U);
    EXPECT_NEAR(data[0].curves[0].points.front().y, 90.0, 0.1);
    EXPECT_NEAR(data[0].curves[0].points.back().y, 270.0, 0.1);
}

TEST(FilmPlot, ShowsADistanceThatGrowsFromZero) {
    const Scene scene = parse_scene(R"(schema = 1
[world]
duration = 1.0
[[rope]]
label = "A"
hang = { links = 1, length = 2.0, angle_deg = 30.0 }
[[rope]]
hang = { links = 1, length = 2.0, angle_deg = 30.0 }
velocity = [0.1, 0.0]
[[rope]]
hang = { links = 1, length = 2.0, angle_deg = -30.0 }
[overlay]
plots = ["divergence", "angle", "tip"]
)",
                                    "plot.toml");
    Film film(scene);
    const std::vector<view::PlotData> plots = film::plots_of(film.scene(), film.motion());
    ASSERT_EQ(plots.size(), 3U);
    const std::vector<view::CurvePoint>& points = plots[0].curves.at(0).points;
    EXPECT_EQ(plots[0].curves[0].name, "A – rope 1");
    EXPECT_GT(points.front().y, 0.0);  // a logarithmic axis has no 0
    EXPECT_EQ(points.front().y,
              std::min_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.y < b.y; })->y);
    const State& state = film.state_at(1.0);
    EXPECT_DOUBLE_EQ(points.back().y, std::hypot(state.x_m[3] - state.x_m[1], state.y_m[3] - state.y_m[1]));
    ASSERT_EQ(plots[1].curves.size(), 3U);
    EXPECT_EQ(plots[1].curves[0].name, "A");
    EXPECT_EQ(plots[1].curves[2].name, "rope 2");
    EXPECT_EQ(plots[2].curves[0].name, "x of A");
}

TEST(FilmPlot, NamesManyRopesByTheirLabelsAlone) {
    Film film(plotted_scene(
        "angle", {"world.duration=0.1", "rope[0].copies={count=70,angle_deg=0.1}", "rope[0].label=first"}));
    const view::PlotData data = plot_of(film);
    ASSERT_EQ(data.curves.size(), 64U);
    EXPECT_EQ(data.curves[0].name, "first");
    for (std::size_t i = 1; i < data.curves.size(); ++i) EXPECT_EQ(data.curves[i].name, "") << i;
    EXPECT_NEAR(data.curves[63].points.front().y, 90.0 + 6.3, 1e-9);
}

TEST(FilmPlot, TellsWhatHasNoRoom) {
    EXPECT_TRUE(Film(plotted_scene("angle")).left_out().empty());
    EXPECT_THAT(
        Film(plotted_scene("energy", {"video.size=[128,128]"})).left_out(),
        testing::ElementsAre("overlay.plots: \"energy\" has little room in 128x128 pixels and is left "
                             "out; give a larger size"));
    const std::vector<std::string> many =
        Film(plotted_scene("energy", {"overlay.plots=[\"energy\",\"angle\",\"tip\"]"})).left_out();
    ASSERT_FALSE(many.empty());
    EXPECT_EQ(many.back(),
              "overlay.plots: \"tip\" has little room in 256x144 pixels and is left out; give a "
              "larger size, fewer plots");
}

TEST(FilmPlot, TellsWhichNamesHaveNoRoom) {
    std::string toml = "schema = 1\nworld = { duration = 0.1 }\n[overlay]\nplots = [\"angle\"]\n";
    for (int i = 0; i < 12; ++i)
        toml += fmt::format("[[rope]]\nlabel = \"pendulum {}\"\nhang = {{ links = 1, length = 1.0 }}\n", i);
    Scene scene = parse_scene(toml, "named.toml");
    scene.video.width_px = 256;
    scene.video.height_px = 144;
    EXPECT_THAT(Film(scene).left_out(),
                testing::ElementsAre(testing::MatchesRegex(
                    "overlay.plots: \"angle\" has little room in 256x144 pixels and names no curve from "
                    "\"pendulum [0-9]+\" on; give a larger size or shorter labels")));
    scene.video.width_px = 1920;
    scene.video.height_px = 1080;
    EXPECT_TRUE(Film(scene).left_out().empty());
}

TEST(FilmPlot, SpeaksTheLanguageOfTheSceneButKeepsLabels) {
    const Scene scene = parse_scene(R"(schema = 1
[world]
duration = 0.1
[[rope]]
label = "rope 7"
hang = { links = 1, length = 2.0, angle_deg = 30.0 }
[[rope]]
hang = { links = 1, length = 2.0, angle_deg = 31.0 }
[overlay]
language = "fr"
plots = ["phase", "tip"]
)",
                                    "plot.toml");
    Film film(scene);
    const std::vector<view::PlotData> plots = film::plots_of(film.scene(), film.motion());
    EXPECT_EQ(plots[0].y.text, "vitesse angulaire");
    EXPECT_EQ(plots[0].curves[0].name, "rope 7");
    EXPECT_EQ(plots[0].curves[1].name, "corde 1");
    EXPECT_EQ(plots[1].curves[0].name, "x de rope 7");
    EXPECT_EQ(method_caption(film.plan(), 0.031, Language::kFrench), "exact, erreur inférieure à 0,031 px");
}

TEST(FilmPlot, RefusesWhatTheSceneDoesNotHave) {
    const auto refuse = [](const std::string& plots, const std::string& rope, const std::string& problem) {
        const std::string text = "schema = 1\n[[rope]]\n" + rope + "\n[overlay]\nplots = " + plots + "\n";
        const test::Failure failure =
            test::failure_of([&] { static_cast<void>(parse_scene(text, "plot.toml")); });
        EXPECT_EQ(failure.code, ExitCode::kInvalidScene);
        EXPECT_NE(failure.message.find(problem), std::string::npos) << failure.message;
    };
    const std::string free = "points = [[0.0, 0.0], [1.0, 0.0]]\npinned = []";
    constexpr const char* kPinned = "points = [[0.0, 0.0], [1.0, 0.0]]\npinned = [0, 1]";
    const std::string closed = "points = [[0.0, 0.0], [1.0, 0.0], [0.5, -1.0]]\nclosed = true";
    refuse("[\"angle\"]", free, "plot.toml:6:10: overlay.plots[0]: no rope has one pinned particle");
    refuse("[\"tip\", \"phase\"]", closed,
           "plot.toml:6:17: overlay.plots[1]: no rope has one pinned particle");
    refuse("[\"divergence\"]", free, "overlay.plots[0]: it is the distance of the tips of ropes 0 and 1");
    for (const auto& [first, second] :
         {std::pair(free, std::string(kPinned)), std::pair(std::string(kPinned), free)})
        refuse("[\"divergence\"]", first + "\n[[rope]]\n" + second,
               "all particles of one of them are pinned; pin fewer");
    refuse("[\"tip\", \"tip\"]", free, "overlay.plots[1]: the same plot twice");
    refuse("\"tip\"", free, "overlay.plots");
    refuse("[\"tips\"]", free, "did you mean \"tip\"?");
}

TEST(FilmPlot, ReadsVelocitiesOnlyForWhatShowsThem) {
    for (const auto& [plot, has_velocities] : {std::pair("energy", true), std::pair("angle", true),
                                               std::pair("phase", true), std::pair("tip", false)}) {
        Film film(plotted_scene(plot));
        EXPECT_FALSE(plot_of(film).curves.at(0).points.empty()) << plot;
        EXPECT_EQ(film.state(3).vx_m_s.empty(), !has_velocities) << plot;
    }
    const Scene both = plotted_scene("tip", {"overlay.energy=true"});
    EXPECT_FALSE(Film(both).state(3).vx_m_s.empty());
}

TEST(FilmPlot, DoesNotChangeTheMotionAndSimulatesItOnce) {
    Scene scene = plotted_scene("energy");
    Film film(scene);
    static_cast<void>(film.frame(3));
    scene.overlay.plots.clear();
    Film plain(scene);
    static_cast<void>(plain.frame(3));
    for (const std::int64_t k : {0, 7, 30}) EXPECT_EQ(film.state(k).x_m, plain.state(k).x_m);
    EXPECT_EQ(film.plan().simulation_passes, plain.plan().simulation_passes);
}

TEST(FilmPlot, IsTheSameInAnyOrder) {
    for (const char* const shutter : {"video.shutter=0", "video.shutter=0.5"}) {
        for (const char* const plot : {"energy", "tip", "phase", "angle"}) {
            const Scene scene = plotted_scene(plot, {shutter});
            const Film film(scene);
            const Film other(scene);
            std::vector<Image> frames;
            for (std::int64_t k = 0; k < 6; ++k) frames.push_back(film.frame(k));
            for (const std::size_t k : {5, 2, 0, 4})
                EXPECT_TRUE(test::equal_images(other.frame(static_cast<std::int64_t>(k)), frames[k]))
                    << plot << " " << k;
            EXPECT_FALSE(frames[2] == frames[5]);
        }
    }
}

TEST(FilmPlot, DoesNotMakeAnEmptyFrameNonEmpty) {
    Film film(plotted_scene("tip", {"camera.center=[100,100]", "camera.height=1"}));
    EXPECT_TRUE(film.is_empty(0.5));
    EXPECT_TRUE(test::poses_of(film, {0.5}).shows_nothing());
}

TEST(FilmPlot, NeedsAMotion) {
    EXPECT_EQ(test::code_of([] { const Renderer renderer(plotted_scene("tip")); }), ExitCode::kInvalidScene);
}

}  // namespace
}  // namespace corda
