#include "corda/figures/chapters.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support.hpp"

namespace corda::figures {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Chapters, DescribeThePendulum) {
    ReadScene scene(pendulum_toml("duration = 2.0"));
    const auto write = [](const std::string&, double, const std::vector<double>&) {};
    const report::Chapter motion =
        motion_chapter(scene.film, scene.motion, find_figure_times(scene.film, scene.motion, {}), write);
    EXPECT_THAT(motion.summary, AllOf(HasSubstr("2 particles, 1 bar (1 real); gravity of (0, -9.81) m/s2"),
                                      HasSubstr("Method: exact at tolerance 1e-09, because the scene asks "
                                                "for exact. There is no bound of its error.")));
    ASSERT_EQ(motion.pictures.size(), 6U);
    EXPECT_THAT(motion.pictures[0].caption, HasSubstr("the last is where the first swing ends"));
    EXPECT_EQ(motion.pictures[1].caption, "The scene at t = 0 s.");
    EXPECT_EQ(motion.tables.at(0).rows.at(0).at(1), report::Cell(scene.motion.speed.size));
    EXPECT_THAT(tension_chapter(scene.film, scene.motion).summary,
                StartsWith("The largest tension is 39.2 N at "));
    EXPECT_THAT(path_chapter(scene.film, scene.motion).summary, StartsWith("The largest speed is 3.13 m/s"));
    EXPECT_THAT(strain_chapter(scene.film, scene.motion).summary, HasSubstr("an error of the method"));
    EXPECT_THAT(energy_chapter(scene.film, scene.motion).summary, HasSubstr("The energy error"));
}

TEST(Chapters, HaveUnitsAndTheCurvesOfTheMotion) {
    ReadScene scene(pendulum_toml("duration = 1.0", "10"));
    const report::Plot phase = phase_chapter(scene.film, scene.motion).plots.at(0);
    EXPECT_EQ(phase.x_title, "angle (rad)");
    EXPECT_EQ(phase.y_title, "angular velocity (rad/s)");
    EXPECT_EQ(phase.series.at(0).points.size(), 81U);  // eight per frame
    EXPECT_NEAR(phase.series.at(0).points[0].first, 1.0472, 1e-4);
    const report::Plot path = path_chapter(scene.film, scene.motion).plots.at(0);
    EXPECT_EQ(path.x_title, "x (m)");
    EXPECT_TRUE(path.has_equal_scales);
    EXPECT_NEAR(path.series.at(0).points[0].first, 3.0 + std::sqrt(0.75), 1e-12);  // in world coordinates
    const report::Plot energy = energy_chapter(scene.film, scene.motion).plots.at(0);
    EXPECT_EQ(energy.y_title, "energy (J)");
    ASSERT_EQ(energy.series.size(), 3U);
    EXPECT_EQ(tension_chapter(scene.film, scene.motion).plots.at(0).y_title, "largest tension (N)");
}

TEST(Chapters, UseXAndVxWhereAnAngleSaysNothing) {
    // A double pendulum whose end passes near its pin.
    ReadScene scene("[world]\nduration = 0.1\n[[rope]]\npoints = [[0.0, 0.0], [1.0, 0.0], [0.05, 0.0]]\n");
    const report::Plot phase = phase_chapter(scene.film, scene.motion).plots.at(0);
    EXPECT_EQ(phase.x_title, "x (mm)");
    EXPECT_EQ(phase.y_title, "vx (mm/s)");
    EXPECT_THAT(phase.caption, HasSubstr("horizontal position of the free end of rope 0 (particle 2)"));
    EXPECT_NEAR(phase.series.at(0).points[0].first, 50.0, 1e-9);  // relative to the pin
}

TEST(Chapters, SayWhyTensionsAreNotKnown) {
    ReadScene scene(
        "[world]\nduration = 0.05\n[[net]]\ngrid = { columns = 4, rows = 3, spacing = 0.1 "
        "}\n[solver]\nmethod = \"relaxation\"\n");
    const report::Chapter tension = tension_chapter(scene.film, scene.motion);
    EXPECT_TRUE(tension.plots.empty());
    EXPECT_THAT(tension.summary, StartsWith("Tensions of net 0 are not known: method relaxation"));
}

TEST(Chapters, ShowSixBodiesAndCountTheOthers) {
    std::string bodies = "[world]\nduration = 0.05\n";
    for (int i = 0; i < 8; ++i)
        bodies += "[[rope]]\nhang = { links = 3, length = 2.0, angle_deg = 9.0 }\nmass = 1000.0\n";
    ReadScene scene(bodies);
    const report::Chapter tension = tension_chapter(scene.film, scene.motion);
    const report::Plot& plot = tension.plots.at(0);
    EXPECT_EQ(plot.series.size(), 6U);
    EXPECT_EQ(plot.series.at(5).name, "rope 5");
    EXPECT_EQ(plot.y_title, "largest tension (kN)");
    EXPECT_THAT(plot.caption, HasSubstr("2 more bodies are not shown."));
    // Released from a straight line; the top link has the largest tension.
    const report::Plot& along = tension.plots.at(1);
    ASSERT_EQ(along.series.at(0).points.size(), 3U);
    EXPECT_NEAR(along.series.at(0).points[1].first, 1.0, 1e-12);
    EXPECT_GT(along.series.at(0).points[0].second, along.series.at(0).points[2].second);
}

}  // namespace
}  // namespace corda::figures
