#include "corda/render/tiles.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "corda/render/coverage.hpp"
#include "support/draw_lists.hpp"

namespace corda::render {
namespace {

bool holds(const Tiles& tiles, const Batch& batch, int x, int y) {
    for (std::size_t i = batch.first_run; i < batch.first_run + batch.run_count; ++i) {
        const PixelRect& rect = tiles.runs()[i].rect;
        if (x >= rect.x0 && x < rect.x1 && y >= rect.y0 && y < rect.y1) return true;
    }
    return false;
}

TEST(Tiles, HoldAllThatTheirCapsulesTouch) {
    constexpr int kWidth = 700;
    constexpr int kHeight = 300;
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        const view::DrawList list = test::random_draw_list(seed, kWidth, kHeight, 1, 3);
        Tiles tiles;
        tiles.plan(list);
        if (list.capsules.empty()) continue;
        ASSERT_EQ(tiles.batches().size(), 1U);
        for (const view::Capsule& capsule : list.capsules) {
            for (int y = 0; y < kHeight; ++y) {
                for (int x = 0; x < kWidth; ++x) {
                    const float distance_px = segment_distance_px(capsule, static_cast<float>(x) + 0.5F,
                                                                  static_cast<float>(y) + 0.5F);
                    const float radius = std::max(capsule.radius, capsule.halo_radius);
                    if (coverage_within(radius, distance_px) == 0) continue;
                    ASSERT_TRUE(holds(tiles, tiles.batches()[0], x, y)) << seed << ": " << x << ',' << y;
                }
            }
        }
    }
}

TEST(Tiles, AreFewAlongALine) {
    view::DrawList list;
    constexpr int kSide = 16 * Tiles::kSidePx;
    list.width = kSide;
    list.height = kSide;
    list.add_layer({});
    list.add_capsule({0.0, 0.0}, {kSide, kSide}, 2.0);
    Tiles tiles;
    tiles.plan(list);
    EXPECT_EQ(tiles.tiles(), 16U + 15U + 15U);  // of 256
    EXPECT_EQ(tiles.runs().size(), 16U);        // one per row
    EXPECT_EQ(tiles.runs().back().rect.x1, kSide);
}

TEST(Tiles, OfLayersThatDoNotMeetAreOneBatch) {
    view::DrawList list;
    constexpr double kSide = Tiles::kSidePx;
    list.width = 10 * Tiles::kSidePx;
    list.height = Tiles::kSidePx;
    // In the middle of a tile of the row.
    const auto add = [&list](int tile, std::uint8_t color) {
        list.add_layer({color, 0, 0});
        list.add_capsule({(tile + 0.5) * kSide, 0.5 * kSide}, {(tile + 0.5) * kSide, 0.5 * kSide}, 2.0);
    };
    add(0, 1);
    add(1, 2);
    list.add_layer({});  // empty
    add(2, 3);
    add(1, 4);  // meets the second
    add(0, 5);  // meets the first, of the batch before
    Tiles tiles;
    tiles.plan(list);
    ASSERT_EQ(tiles.batches().size(), 2U);
    EXPECT_EQ(tiles.batches()[0].capsule_count, 3U);
    EXPECT_EQ(tiles.batches()[0].run_count, 3U);
    EXPECT_EQ(tiles.batches()[1].first_capsule, 3U);
    EXPECT_EQ(tiles.batches()[1].capsule_count, 2U);
    EXPECT_EQ(tiles.batches()[1].first_run, 3U);
    EXPECT_EQ(tiles.runs()[3].color.r, 4);
}

}  // namespace
}  // namespace corda::render
