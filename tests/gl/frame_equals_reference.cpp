#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "corda/gl/context.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/view/draw_list.hpp"
#include "corda/view/font.hpp"
#include "support/cancel.hpp"
#include "support/draw_lists.hpp"
#include "support/failure.hpp"
#include "support/image_matchers.hpp"

namespace corda {
namespace {

using test::equal_images;

class RandomCapsules : public testing::TestWithParam<std::tuple<int, int, std::size_t>> {};

TEST_P(RandomCapsules, EqualTheReferenceByteForByte) {
    const auto [width, height, layers] = GetParam();
    const gl::Context context;
    render::FrameRenderer renderer(context, width, height);
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        const view::DrawList list = test::random_draw_list(seed, width, height, layers, 60, 12);
        renderer.render(list);
        EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(list))) << "seed " << seed;
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, RandomCapsules,
                         testing::Values(std::tuple{64, 64, 1}, std::tuple{641, 359, 4},
                                         std::tuple{1920, 1080, 5}, std::tuple{333, 77, 300},
                                         std::tuple{1, 1, 2}),
                         [](const auto& param) {
                             return std::to_string(std::get<0>(param.param)) + "x" +
                                    std::to_string(std::get<1>(param.param)) + "_" +
                                    std::to_string(std::get<2>(param.param)) + "_layers";
                         });

TEST(TransparentGrounds, EqualTheReferenceByteForByte) {
    const gl::Context context;
    render::FrameRenderer renderer(context, 333, 177);
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
        view::DrawList list = test::random_draw_list(seed, 333, 177, 5, seed % 2 == 0 ? 3 : 40);
        list.ground.top.a = seed < 3 ? 0 : 130;
        list.ground.bottom.a = seed % 3 == 0 ? 255 : list.ground.top.a;
        renderer.render(list);
        EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(list))) << "seed " << seed;
        list.layers.pop_back();  // a damage that is less than the frame
        list.capsules.resize(list.layers.back().first_capsule + list.layers.back().capsule_count);
        renderer.render(list);
        EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(list))) << "seed " << seed;
    }
}

TEST(TintedLayers, EqualTheReferenceByteForByte) {
    const gl::Context context;
    render::FrameRenderer renderer(context, 641, 359);
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
        // Plain lists, then some with tinted layers, from the second frame on with less damage.
        view::DrawList list = test::random_draw_list(seed, 641, 359, 6, seed % 2 == 0 ? 4 : 60, 3, seed % 3);
        list.ground.top.a = seed > 6 ? 100 : 255;
        renderer.render(list);
        EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(list))) << "seed " << seed;
    }
}

TEST(TintedLayers, EqualTheReferenceWhereManyCapsulesOverlap) {
    // Beyond 257 the sums are rounded, in the order of the capsules.
    const gl::Context context;
    render::FrameRenderer renderer(context, 64, 48);
    view::DrawList list = test::random_draw_list(1, 64, 48, 1, 3000, 0, 1);
    renderer.render(list);
    EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(list)));
}

void move_down(view::DrawList& list, int rows) {
    for (view::Capsule& capsule : list.capsules) capsule.ay += static_cast<float>(rows);
}

TEST(Bands, EqualTheReferenceByteForByte) {
    // 16384 x 1000 pixels and 2 layers are 3 bands.
    constexpr int kWidth = 16384;
    constexpr int kHeight = 1000;
    const gl::Context context;
    render::FrameRenderer renderer(context, kWidth, kHeight);
    for (std::uint32_t seed = 1; seed <= 2; ++seed) {
        view::DrawList list = test::random_draw_list(seed, kWidth, seed == 1 ? kHeight : 600, 2, 60);
        list.height = kHeight;
        list.ground = {{10, 20, 30}, {90, 20, 0}};
        if (seed == 2) {  // alone, so that the damage does not begin at the top
            move_down(list, 333);
            view::DrawList empty = list;
            empty.layers.clear();
            empty.capsules.clear();
            renderer.render(empty);
        }
        int checks = 0;
        const CancelScope count([&checks] { return ++checks > 0; });
        const Damage damage = renderer.render(list);
        EXPECT_EQ(damage.front().y0 == 0, seed == 1);
        EXPECT_GE(checks, 1);  // measured 2 and 1
        EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(list))) << "seed " << seed;
    }
}

TEST(Bands, AreFollowedByAWholeFrameIfCancelled) {
    constexpr int kWidth = 16384;
    constexpr int kHeight = 1000;
    const gl::Context context;
    render::FrameRenderer renderer(context, kWidth, kHeight);
    renderer.render(test::random_draw_list(1, kWidth, kHeight, 2, 20));
    view::DrawList list = test::random_draw_list(2, kWidth, kHeight, 2, 20);
    for (const std::int64_t bands : {0, 1}) {
        {
            const CancelScope stop = test::cancel_after(bands);
            EXPECT_EQ(test::code_of([&] { renderer.render(list); }), ExitCode::kInterrupted);
        }
        list.layers.clear();
        list.capsules.clear();
        EXPECT_EQ(renderer.render(list), Damage{renderer.image().rect()});
        EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(list)));
        list = test::random_draw_list(3, kWidth, kHeight, 2, 20);
    }
}

TEST(Bands, AreNotUsedForSmallFrames) {
    const gl::Context context;
    render::FrameRenderer renderer(context, 640, 360);
    const CancelScope stop = test::cancel_after(0);
    EXPECT_NO_THROW(renderer.render(test::random_draw_list(1, 640, 360, 1, 20)));
}

TEST(DamagedRedraw, EqualsTheFullRedrawByteForByte) {
    constexpr int kWidth = 320;
    constexpr int kHeight = 200;
    const gl::Context context;
    render::FrameRenderer damaged(context, kWidth, kHeight);
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        // A few capsules, so that frames leave most of the picture alone; every fifth frame is empty.
        view::DrawList list = test::random_draw_list(seed, kWidth, kHeight, 3, seed % 5 == 0 ? 0 : 2);
        list.ground = {{10, 20, 30}, {90, 20, 0}};
        damaged.render(list);
        render::FrameRenderer full(context, kWidth, kHeight);
        EXPECT_EQ(full.render(list), Damage{damaged.image().rect()});
        EXPECT_TRUE(equal_images(damaged.image(), full.image())) << "frame " << seed;
    }
}

TEST(DamagedRedraw, EqualsTheFullRedrawIfStampsChange) {
    constexpr int kWidth = 320;
    constexpr int kHeight = 200;
    const gl::Context context;
    render::FrameRenderer damaged(context, kWidth, kHeight);
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        view::DrawList list = test::random_draw_list(seed, kWidth, kHeight, 1, 1, seed % 4);
        // Stamps overlap one another, their tiles and layers; of a see-through ground all are divided by
        // alpha once.
        list.ground = {{10, 20, 30}, {90, 20, 0, static_cast<std::uint8_t>(seed < 12 ? 255 : 70)}};
        damaged.render(list);
        EXPECT_TRUE(equal_images(damaged.image(), render::render_reference(list))) << "frame " << seed;
    }
}

TEST(DamagedRedraw, CoversTheTilesOfChangedStamps) {
    const gl::Context context;
    render::FrameRenderer renderer(context, 200, 100);
    view::Font font;
    const auto list_of = [&font](const char* changing, Color color) {
        view::DrawList list;
        list.width = 200;
        list.height = 100;
        font.write({10, 30, 16, {}, "stays"}, list);
        font.write({10, 90, 16, {}, changing}, list);
        list.add_box({150, 10, 190, 20}, color);
        return list;
    };
    const auto united = [](const Damage& damage) {
        PixelRect all;
        for (const PixelRect& part : damage) all = all.united(part);
        return all;
    };
    const view::DrawList first = list_of("1.20 s", {1, 2, 3});
    renderer.render(first);
    EXPECT_TRUE(renderer.render(first).empty());
    // A text of the same box: its digits are equally wide and high.
    const view::DrawList second = list_of("1.80 s", {1, 2, 3});
    const PixelRect& box = second.stamps[1].box;
    ASSERT_EQ(first.stamps[1].box, box);
    const PixelRect tiles{box.x0 / 16 * 16, box.y0 / 16 * 16, (box.x1 + 15) / 16 * 16,
                          std::min((box.y1 + 15) / 16 * 16, 100)};
    EXPECT_EQ(united(renderer.render(second)), tiles);
    const view::DrawList third = list_of("1.80 s", {1, 2, 4});
    EXPECT_EQ(united(renderer.render(third)), (PixelRect{144, 0, 192, 32}));
    EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(third)));
    const view::DrawList last = list_of("", {1, 2, 4});
    const PixelRect all = united(renderer.render(last));  // the third stamp is the second now
    EXPECT_EQ(all.united(tiles), all);
    EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(last)));
}

TEST(DamagedRedraw, OfAnUnchangedFrameIsEmpty) {
    const gl::Context context;
    render::FrameRenderer renderer(context, 64, 64);
    view::DrawList list = test::random_draw_list(1, 64, 64, 1, 0);
    EXPECT_EQ(renderer.render(list), (Damage{{0, 0, 64, 64}}));
    EXPECT_TRUE(renderer.render(list).empty());
    list.ground.bottom.r ^= 1U;
    EXPECT_EQ(renderer.render(list), (Damage{{0, 0, 64, 64}}));
}

TEST(DamagedRedraw, IsTheWholeFrameAfterAFailure) {
    const auto list_of = [](std::uint32_t seed, std::size_t layers, std::size_t capsules) {
        view::DrawList list = test::random_draw_list(seed, 64, 64, layers, capsules);
        list.ground = {{10, 20, 30}, {90, 20, 0}};
        return list;
    };
    const gl::Context context;
    render::FrameRenderer renderer(context, 64, 64);
    renderer.render(list_of(1, 1, 20));
    glEnable(GL_NONE);  // what OpenGL reports next: when the frame has been drawn
    EXPECT_EQ(test::failure_of([&] { renderer.render(list_of(2, 1, 5)); }).code, ExitCode::kNoGl);
    const view::DrawList list = list_of(3, 1, 0);
    EXPECT_EQ(renderer.render(list), Damage{renderer.image().rect()});
    EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(list)));
}

/// A list, and those of an exposure: `count` of the same ground.
std::vector<view::DrawList> exposed_lists(std::uint32_t seed, std::size_t count, const Ground& ground) {
    std::vector<view::DrawList> lists;
    for (std::uint32_t i = 0; i <= count; ++i) {
        // Every fourth is empty.
        lists.push_back(
            test::random_draw_list(10 * seed + i, 320, 200, 2, i % 4 == 3 ? 0 : 2, i == 0 ? 3 : 0));
        lists.back().ground = ground;
    }
    return lists;
}

TEST(Exposures, EqualTheReferenceAfterAnyFrame) {
    const gl::Context context;
    render::FrameRenderer renderer(context, 320, 200);
    for (std::uint32_t seed = 1; seed <= 12; ++seed) {
        const Ground ground{{10, 20, 30}, {90, 20, 0, static_cast<std::uint8_t>(seed < 9 ? 255 : 80)}};
        const auto lists = exposed_lists(seed, seed < 3 ? 64 : seed, ground);
        const std::span<const view::DrawList> exposed(lists.begin() + 1, lists.end());
        for (const view::DrawList& list : exposed) renderer.expose(list);
        renderer.develop(lists.front());
        const Image want = render::render_reference(exposed, lists.front());
        EXPECT_TRUE(equal_images(renderer.image(), want)) << "seed " << seed;
        if (seed % 3 == 0) {  // a sharp frame, after an exposure that was given up
            renderer.expose(lists.back());
            renderer.render(lists.front());
            EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(lists.front())));
        }
    }
}

TEST(Exposures, ReportAllChangesAsDamage) {
    const gl::Context context;
    render::FrameRenderer renderer(context, 320, 200);
    Image shown(320, 200);
    for (std::uint32_t seed = 1; seed <= 12; ++seed) {
        const auto lists = exposed_lists(seed, 3, {{10, 20, 30}, {90, 20, 0}});
        for (std::size_t i = 1; i < lists.size(); ++i) renderer.expose(lists[i]);
        for (const PixelRect& part : renderer.develop(lists.front())) {
            for (int y = part.y0; y < part.y1; ++y)
                std::copy_n(renderer.image().pixel(part.x0, y), 4 * part.width(), shown.pixel(part.x0, y));
        }
        EXPECT_TRUE(equal_images(shown, renderer.image())) << "seed " << seed;
    }
}

TEST(TwoRenderers, OfDifferentSizesShareAContext) {
    const gl::Context context;
    render::FrameRenderer small(context, 33, 17);
    render::FrameRenderer large(context, 640, 360);
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        const view::DrawList small_list = test::random_draw_list(seed, 33, 17, 2, 5);
        const view::DrawList large_list = test::random_draw_list(seed + 100, 640, 360, 3, 20);
        small.render(small_list);
        large.render(large_list);
        EXPECT_TRUE(equal_images(small.image(), render::render_reference(small_list))) << "seed " << seed;
        EXPECT_TRUE(equal_images(large.image(), render::render_reference(large_list))) << "seed " << seed;
    }
}

TEST(TwoContexts, LiveAndDieIndependently) {
    auto first = std::make_unique<gl::Context>();
    const gl::Context second;
    render::FrameRenderer renderer(second, 64, 64);
    first.reset();  // ends neither the display nor the context of the other
    second.make_current();
    const view::DrawList list = test::random_draw_list(1, 64, 64, 2, 20);
    renderer.render(list);
    EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(list)));
}

}  // namespace
}  // namespace corda
