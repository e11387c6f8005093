#include "corda/view/trail.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace corda::view {
namespace {

TEST(Trails, FadeInLayersOfWhatIsYounger) {
    DrawList list;
    list.width = 400;
    list.height = 100;
    std::vector<FadingPoint> path;
    for (int i = 0; i <= 60; ++i) path.push_back({{20.0 + 5.0 * i, 50.0}, i / 60.0});
    add_trail(path, 4.0, {10, 20, 30, 255}, list);
    double covered = 0.0;  // what the young end is after each layer
    std::size_t last = 1000;
    for (const Layer& layer : list.layers) {
        EXPECT_LE(layer.capsule_count, last);
        last = layer.capsule_count;
        covered += (1.0 - covered) * layer.color.a / 255.0;
    }
    EXPECT_EQ(list.layers.front().capsule_count, 240U);
    EXPECT_GT(list.layers.back().capsule_count, 0U);
    EXPECT_LT(list.layers.back().capsule_count, 30U);  // measured 20
    EXPECT_NEAR(covered, 0.8, 0.02);                   // measured 0.803
    // The young end is the thickest.
    EXPECT_LT(list.capsules.front().radius, 0.5F * list.capsules.back().radius);
    EXPECT_NEAR(list.capsules.back().radius, 4.0F, 0.1F);
}

TEST(Trails, OfATranslucentRopeAreMoreSoThanIt) {
    DrawList list;
    list.width = list.height = 400;
    std::vector<FadingPoint> path;
    for (int i = 0; i <= 10; ++i) path.push_back({{30.0 * i, 50.0}, 0.1 * i});
    add_trail(path, 4.0, {255, 255, 255, 128}, list);
    double covered = 0.0;
    for (const Layer& layer : list.layers) covered += (1.0 - covered) * layer.color.a / 255.0;
    EXPECT_NEAR(covered, 0.8 * 128.0 / 255.0, 0.02);  // measured 0.40
}

TEST(Trails, AreSmooth) {
    // A quarter of a circle, of few points, with a last one that is closer.
    DrawList list;
    list.width = list.height = 400;
    std::vector<FadingPoint> path;
    for (const double left : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.05})
        path.push_back({{300.0 * std::cos(1.5 * left), 300.0 * std::sin(1.5 * left)}, left});
    add_trail(path, 1.0, {}, list);
    for (std::size_t i = 4; i < 20; ++i) {  // but for the first step, which has no neighbour before it
        const Capsule& piece = list.capsules[i];
        EXPECT_NEAR(std::hypot(piece.ax, piece.ay), 300.0, 0.5) << i;  // measured 0.12; chords: 3.4
    }
}

TEST(Trails, OfOnePointAreEmpty) {
    DrawList list;
    list.width = list.height = 100;
    add_trail(std::vector<FadingPoint>{{{50.0, 50.0}, 1.0}}, 4.0, {}, list);
    add_trail({}, 4.0, {}, list);
    EXPECT_TRUE(list.capsules.empty());
}

}  // namespace
}  // namespace corda::view
