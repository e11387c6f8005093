#include "corda/figures/chapters.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

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
                                                "for exact. There is no estimate of its error.")));
    ASSERT_EQ(motion.pictures.size(), 6U);
    EXPECT_THAT(motion.pictures[0].caption, HasSubstr("the last is where the first swing ends"));
    EXPECT_EQ(motion.pictures[1].caption, "The scene at t = 0 s.");
    EXPECT_EQ(motion.tables.at(0).rows.at(0).at(1), report::Cell(scene.motion.speed.size));
    EXPECT_THAT(tension_chapter(scene.film, scene.motion).summary,
                StartsWith("The largest tension is 39.2 N at "));
    EXPECT_THAT(path_chapter(scene.film, scene.motion).summary, StartsWith("The largest speed is 3.13 m/s"));
    const report::Chapter strain = strain_chapter(scene.film, scene.motion);
    EXPECT_THAT(strain.summary, HasSubstr("keep their lengths"));
    EXPECT_TRUE(strain.plots.empty());
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

/// The pendulum is let go at 60 degrees: R2 gives 1.0731820071493645 times the period of small swings.
TEST(Chapters, CompareThePeriodWithTheory) {
    ReadScene scene(pendulum_toml("duration = 12.0"));
    const report::Chapter angle = angle_chapter(scene.film, scene.motion);
    EXPECT_EQ(angle.plots.at(0).y_title, "angle (°)");
    EXPECT_NEAR(angle.plots.at(0).series.at(0).points[0].second, 60.0, 1e-9);
    ASSERT_EQ(scene.motion.periods_s.size(), 9U);
    const double period_s = 1.0731820071493645 * 2.006066680710647;
    for (const double its_s : scene.motion.periods_s) EXPECT_NEAR(its_s, period_s, 1e-6);
    EXPECT_EQ(
        angle.summary,
        "The film has 9 periods of 2.1529 s each; that of a point pendulum of this amplitude is 2.1529 s.");
    ReadScene brief(pendulum_toml("duration = 0.5"));
    EXPECT_EQ(angle_chapter(brief.film, brief.motion).summary,
              "No period is measured: the film of 0.5 s has no whole one between passes below the pin.");
    ReadScene dragged(pendulum_toml("duration = 4.0\ndrag = 0.5"));
    EXPECT_THAT(angle_chapter(dragged.film, dragged.motion).summary,
                testing::EndsWith("no theory in this report has a period for such a scene."));
}

/// R2, R3 and R4 of section 4 of src/corda/sim/README.md.
TEST(PeriodTheory, IsOfPendulumRodAndRope) {
    const auto period_s = [](const std::string& toml, double angle_deg) {
        const auto theory = period_theory(scene_of(toml), angle_deg);
        return theory ? theory->period_s : 0.0;
    };
    const std::string rope = "[[rope]]\nhang = { links = 10, length = 1.0, angle_deg = 5.0 }\n";
    EXPECT_NEAR(period_s("[[rope]]\nhang = { links = 1, length = 1.0, angle_deg = 5.0 }\n", 90.0),
                1.1803405990160962 * 2.006066680710647, 1e-14);
    EXPECT_NEAR(period_s(rope, 5.0), 2.0 * std::numbers::pi / 3.6766206576178, 1e-12);
    EXPECT_NEAR(period_s(rope + "[solver]\nmethod = \"relaxation\"\nforce = [0.0, -9.81]\n", 90.0),
                1.981078706687632, 1e-12);
    EXPECT_NEAR(period_s(rope + "mass = 1e-4\npayload = 1.0\n", 90.0), 1.1803405990160962 * 2.006066680710647,
                1e-14);
    for (const char* const other :
         {"payload = 1.0\n", "compliance = 1e-3\n", "pinned = [0, 10]\n", "mass = [1,1,1,1,1,1,1,1,1,1,2]\n",
          "[world]\ndrag = 0.1\n", "[world]\ngravity = [1.0, -9.0]\n", "[world]\ngravity = 0.0\n"})
        EXPECT_EQ(period_s(rope + other, 5.0), 0.0) << other;
    EXPECT_EQ(period_s(rope + rope, 5.0), 0.0);
}

TEST(Chapters, UseXAndVxWhereAnAngleSaysNothing) {
    // A double pendulum whose end passes near its pin.
    ReadScene scene("[world]\nduration = 0.1\n[[rope]]\npoints = [[0.0, 0.0], [1.0, 0.0], [0.05, 0.0]]\n");
    EXPECT_TRUE(angle_chapter(scene.film, scene.motion).plots.empty());
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
