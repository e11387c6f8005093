#include "corda/figures/sweep_figures.hpp"

#include <gmock/gmock.h>

#include "support/files.hpp"
#include "unit/sweep/support.hpp"

namespace corda::figures {
namespace {

TEST(SweepPlot, AxesHaveTheUnitsOfTheirKeys) {
    const sweep::SweepFolder folder;
    const sweep::SweepDef def = folder.load(
        "samples = 2\n[vary]\n\"rope[0].payload\" = [1, 2]\n\"world.drag\" = [0, 1]\n"
        "\"rope[0].hang.angle_deg\" = [5, 10]\n[output]\nsummary = [\"period_s\"]\n");
    using Titles = std::pair<std::string, std::string>;
    EXPECT_EQ(sweep_plot_titles(def, "period_s:payload"), Titles("period (s)", "payload (kg)"));
    EXPECT_EQ(sweep_plot_titles(def, "world.drag:angle_deg"), Titles("drag (1/s)", "angle (°)"));
}

}  // namespace
}  // namespace corda::figures
