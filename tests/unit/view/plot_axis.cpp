#include "corda/view/plot_axis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace corda::view {
namespace {

using testing::ElementsAre;

std::vector<std::string> texts_of(const PlotAxis& axis) {
    std::vector<std::string> texts;
    for (const PlotAxis::Label& label : axis.labels) texts.push_back(label.text);
    return texts;
}

TEST(PlotAxis, EndsAtRoundValues) {
    PlotAxis axis{.low = -0.3, .high = 1.1, .low_px = 0, .high_px = 140};
    axis.extend_to_labels(4);
    axis.set_labels(4);
    EXPECT_THAT(texts_of(axis), ElementsAre("−0.5", "0", "0.5", "1", "1.5"));
    EXPECT_EQ(axis.labels.back().at_px, 140);
    EXPECT_DOUBLE_EQ(axis.px(0.5), 70.0);
}

TEST(PlotAxis, HasLabelsAtTheEndsThatAreGiven) {
    const auto texts = [](double low, double high, int most) {
        PlotAxis axis{.low = low, .high = high, .low_px = 0, .high_px = 140, .is_given = true};
        axis.extend_to_labels(most);
        axis.set_labels(most);
        return texts_of(axis);
    };
    EXPECT_THAT(texts(-90.0, 90.0, 4), ElementsAre("−90", "−45", "0", "45", "90"));
    EXPECT_THAT(texts(-180.0, 180.0, 7), ElementsAre("−180", "−120", "−60", "0", "60", "120", "180"));
    EXPECT_THAT(texts(0.0, 20.0, 7), ElementsAre("0", "5", "10", "15", "20"));
    EXPECT_THAT(texts(0.03, 0.12, 4), ElementsAre("0.03", "0.06", "0.09", "0.12"));
    EXPECT_THAT(texts(-4.0, 5.0, 5), ElementsAre("−4", "−2", "0", "2", "4"));  // no round steps end at both
}

TEST(PlotAxis, IsNotStretchedByRounding) {
    PlotAxis axis{.low = -40.0001, .high = 40.0, .low_px = 0, .high_px = 140};
    axis.extend_to_labels(5);
    EXPECT_EQ(axis.low, -40.0);
    EXPECT_EQ(axis.high, 40.0);
    PlotAxis more{.low = -40.5, .high = 40.0, .low_px = 0, .high_px = 140};
    more.extend_to_labels(5);
    EXPECT_EQ(more.low, -60.0);
}

TEST(PlotAxis, HasPowersOfTenIfItIsLogarithmic) {
    PlotAxis axis{
        .low = std::log10(3e-7), .high = std::log10(0.2), .low_px = 0, .high_px = 70, .is_log = true};
    axis.extend_to_labels(3);
    axis.set_labels(3);
    EXPECT_THAT(texts_of(axis), ElementsAre("10⁻⁶", "10⁻³", "10⁰"));  // 10⁻⁷ is its lower end
    EXPECT_DOUBLE_EQ(axis.px(1e-6), 10.0);
    EXPECT_EQ(axis.labels.front().at_px, 10);
    PlotAxis narrow{.low = 2.0, .high = 2.0, .low_px = 0, .high_px = 70, .is_log = true};
    narrow.extend_to_labels(3);
    EXPECT_EQ(narrow.high, 3.0);
}

TEST(PlotAxis, KeepsItsLabelsApart) {
    Font font;
    PlotAxis axis{.low = 0.0, .high = 100'000.0, .low_px = 0, .high_px = 150};
    axis.set_labels_apart(8, 4, 20, font);
    EXPECT_THAT(texts_of(axis), ElementsAre("0", "100000"));
}

TEST(VisiblePoints, OfAFunctionAreTheOutlineOfEachColumn) {
    std::vector<PixelPoint> points;
    for (int i = 0; i < 1000; ++i) points.push_back({0.01 * i, i == 333 ? 9.0 : i == 555 ? -9.0 : 0.0});
    const auto kept = visible_points(points);
    EXPECT_LE(kept.size(), 4U * 10U);
    EXPECT_THAT(kept, testing::Contains(333U));
    EXPECT_THAT(kept, testing::Contains(555U));
    EXPECT_EQ(kept.front(), 0U);
    EXPECT_EQ(kept.back(), 999U);
    EXPECT_TRUE(visible_points({}).empty());
}

TEST(VisiblePoints, OfAPathAreHalfAPixelApart) {
    std::vector<PixelPoint> points;
    for (int i = 0; i < 1000; ++i) points.push_back({100.0 * std::cos(0.01 * i), 100.0 * std::sin(0.01 * i)});
    EXPECT_EQ(visible_points(points).size(), 1000U);  // a pixel apart
    for (PixelPoint& point : points) point = {0.1 * point.x, 0.1 * point.y};
    const std::size_t count = visible_points(points).size();
    EXPECT_GT(count, 100U);
    EXPECT_LT(count, 200U);
}

}  // namespace
}  // namespace corda::view
