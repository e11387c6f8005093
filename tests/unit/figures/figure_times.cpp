#include "corda/figures/figure_times.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support.hpp"

namespace corda::figures {
namespace {

using testing::ElementsAre;

TEST(FigureTimes, AreThoseOfTheFirstSwing) {
    ReadScene scene(pendulum_toml("duration = 3.0", "100"));
    const FigureTimes moments = find_figure_times(scene.film, scene.reading, {});
    EXPECT_TRUE(moments.is_swing);
    ASSERT_EQ(moments.strobe_s.size(), 6U);
    EXPECT_EQ(moments.strobe_s.front(), 0.0);
    // Half the period at 60 degrees: 1.0765 s (R2).
    EXPECT_NEAR(moments.strobe_s.back(), 1.0765, 0.01);
    EXPECT_THAT(moments.stills_s, ElementsAre(0.0, 0.75, 1.5, 2.25, 3.0));
    for (const double time_s : moments.strobe_s) EXPECT_EQ(scene.film.state_at(time_s).time_s, time_s);
    EXPECT_EQ(scene.film.simulation_passes(), 1);  // all of them are recorded
}

TEST(FigureTimes, AreThoseOfTheWholeMotionIfNothingSwings) {
    ReadScene scene(
        "[world]\nduration = 1.0\n[[rope]]\npoints = [[0.0, 0.0], [1.0, 0.0]]\npinned = []\n[video]\nfps = "
        "10\n");
    const FigureTimes moments = find_figure_times(scene.film, scene.reading, {});
    EXPECT_FALSE(moments.is_swing);
    EXPECT_THAT(moments.strobe_s, ElementsAre(0.0, 0.2, 0.4, 0.6, 0.8, 1.0));
}

TEST(FigureTimes, AreTheRequestedOnes) {
    ReadScene scene(pendulum_toml(), {0.123, 0.456});
    const FigureTimes moments = find_figure_times(scene.film, scene.reading, {0.456, 0.123});
    EXPECT_THAT(moments.strobe_s, ElementsAre(0.123, 0.456));
    EXPECT_THAT(moments.stills_s, ElementsAre(0.123, 0.456));
    EXPECT_EQ(scene.film.state_at(0.456).time_s, 0.456);
    EXPECT_EQ(scene.film.simulation_passes(), 1);
}

}  // namespace
}  // namespace corda::figures
