#include "corda/render/reads.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "support/draw_lists.hpp"

namespace corda::render {
namespace {

TEST(Reads, HoldEveryRunOnceAndInOrder) {
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
            for (; next < read.first_run; ++next)  // those beside the band
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

TEST(Reads, AreFewWhereLittleIsBetweenTheRuns) {
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

TEST(Reads, AreSlicedByWhatTheBufferHolds) {
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
