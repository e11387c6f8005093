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

TEST(Tiles, ContainAllPixelsThatTheirCapsulesCover) {
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

TEST(Tiles, BatchLayersThatShareNoTile) {
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

TEST(Reads, ContainEveryRunOnceInOrder) {
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        const view::DrawList list = test::random_draw_list(seed, 1900, 1000, 6, 20, 0, seed % 3);
        Tiles tiles;
        tiles.plan(list);
        const PixelRect band{0, 100, 1900, seed % 2 == 0 ? 1000 : 300};
        std::size_t next = 0;
        const Batch* last = nullptr;
        for (const Read& read : plan_reads(tiles, band)) {
            EXPECT_EQ(read.is_first_of_batch, read.batch != last);
            EXPECT_GE(read.first_run, read.batch->first_run);
            EXPECT_LE(read.end_run, read.batch->first_run + read.batch->run_count);
            EXPECT_LE(pixels_of(read.rect), kMaxReadPx);
            EXPECT_EQ(read.rect, read.rect.intersected(band));
            EXPECT_GE(read.first_run, next);
            for (; next < read.first_run; ++next)  // runs outside of the band
                EXPECT_TRUE(tiles.runs()[next].rect.intersected(band).empty());
            for (; next < read.end_run; ++next) {
                const PixelRect rect = tiles.runs()[next].rect.intersected(band);
                EXPECT_EQ(read.rect.united(rect), read.rect);  // if it is empty, too
            }
            last = read.batch;
        }
        for (; next < tiles.runs().size(); ++next)
            EXPECT_TRUE(tiles.runs()[next].rect.intersected(band).empty());
    }
}

TEST(Reads, JoinRunsThatAreClose) {
    view::DrawList list;
    list.width = 1920;
    list.height = 1080;
    list.add_layer({});
    list.add_capsule({960.0, 0.0}, {1000.0, 1080.0}, 2.0);
    Tiles tiles;
    tiles.plan(list);
    EXPECT_EQ(tiles.runs().size(), 68U);
    EXPECT_EQ(plan_reads(tiles, {0, 0, 1920, 1080}).size(), 1U);

    // From corner to corner a rectangle would be the whole frame.
    list.layers.clear();
    list.capsules.clear();
    list.add_layer({});
    list.add_capsule({0.0, 0.0}, {1920.0, 1080.0}, 2.0);
    tiles.plan(list);
    const std::vector<Read> reads = plan_reads(tiles, {0, 0, 1920, 1080});
    EXPECT_EQ(tiles.runs().size(), 68U);
    EXPECT_LE(reads.size(), 6U);                       // measured 4
    EXPECT_LT(pixels_of(std::span(reads)), 600'000U);  // measured 551 808 of 2 073 600
}

TEST(Reads, AreSlicedToFitTheBuffer) {
    constexpr int kRows = static_cast<int>(kMaxReadPx / 1024);
    const auto read_of = [](int rows) { return Read{.rect = {0, 0, 1024, rows}}; };
    const std::vector<Read> reads{read_of(kRows / 2), read_of(kRows - kRows / 2), read_of(1), read_of(kRows),
                                  read_of(1)};
    const std::vector<std::span<const Read>> slices = slices_of(reads);
    ASSERT_EQ(slices.size(), 4U);
    EXPECT_EQ(slices[0].size(), 2U);
    const Read* next = reads.data();
    for (const std::span<const Read> slice : slices) {
        EXPECT_EQ(slice.data(), next);
        EXPECT_LE(pixels_of(slice), kMaxReadPx);
        next += slice.size();
    }
    EXPECT_EQ(next, reads.data() + reads.size());
    EXPECT_TRUE(slices_of({}).empty());
}

}  // namespace
}  // namespace corda::render
