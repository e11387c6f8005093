#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <tuple>

#include "corda/gl/context.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/render/reference_renderer.hpp"
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
    render::FrameRenderer renderer(width, height);
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        const view::DrawList list = test::random_draw_list(seed, width, height, layers, 60);
        renderer.render(list);
        EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(list))) << "seed " << seed;
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, RandomCapsules,
                         testing::Values(std::tuple{64, 64, 1}, std::tuple{641, 359, 4},
                                         std::tuple{1920, 1080, 5}, std::tuple{333, 77, 64},
                                         std::tuple{1, 1, 2}),
                         [](const auto& param) {
                             return std::to_string(std::get<0>(param.param)) + "x" +
                                    std::to_string(std::get<1>(param.param)) + "_" +
                                    std::to_string(std::get<2>(param.param)) + "_layers";
                         });

TEST(DamagedRedraw, EqualsTheFullRedrawByteForByte) {
    constexpr int kWidth = 320;
    constexpr int kHeight = 200;
    const gl::Context context;
    render::FrameRenderer damaged(kWidth, kHeight);
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        // A few capsules, so that frames leave most of the picture alone; every fifth frame is empty.
        view::DrawList list = test::random_draw_list(seed, kWidth, kHeight, 3, seed % 5 == 0 ? 0 : 2);
        list.background = {10, 20, 30, 255};
        const PixelRect damage = damaged.render(list);
        render::FrameRenderer full(kWidth, kHeight);
        EXPECT_EQ(full.render(list), damaged.image().rect());
        EXPECT_TRUE(equal_images(damaged.image(), full.image()))
            << "frame " << seed << " damage " << damage.x0 << ',' << damage.y0 << ' ' << damage.x1 << ','
            << damage.y1;
    }
}

TEST(DamagedRedraw, LeavesAnUnchangedFrameAlone) {
    const gl::Context context;
    render::FrameRenderer renderer(64, 64);
    view::DrawList list = test::random_draw_list(1, 64, 64, 1, 0);
    EXPECT_EQ(renderer.render(list), (PixelRect{0, 0, 64, 64}));
    EXPECT_TRUE(renderer.render(list).empty());
    list.background.r ^= 1U;
    EXPECT_EQ(renderer.render(list), (PixelRect{0, 0, 64, 64}));
}

TEST(DamagedRedraw, AfterAFailureDrawsTheWholeFrame) {
    const auto list_of = [](std::uint32_t seed, std::size_t layers, std::size_t capsules) {
        view::DrawList list = test::random_draw_list(seed, 64, 64, layers, capsules);
        list.background = {10, 20, 30, 255};
        return list;
    };
    const gl::Context context;
    render::FrameRenderer renderer(64, 64);
    renderer.render(list_of(1, 1, 20));
    glEnable(GL_NONE);  // what OpenGL reports next: when the masks for a fifth layer have been made
    EXPECT_EQ(test::failure_of([&] { renderer.render(list_of(2, 5, 1)); }).code, ExitCode::kNoGl);
    const view::DrawList list = list_of(3, 5, 0);
    EXPECT_EQ(renderer.render(list), renderer.image().rect());
    EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(list)));
}

TEST(TwoRenderers, OfDifferentSizeShareAContext) {
    const gl::Context context;
    render::FrameRenderer small(33, 17);
    render::FrameRenderer large(640, 360);
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
    render::FrameRenderer renderer(64, 64);
    first.reset();  // ends neither the display nor the context of the other
    second.make_current();
    const view::DrawList list = test::random_draw_list(1, 64, 64, 2, 20);
    renderer.render(list);
    EXPECT_TRUE(equal_images(renderer.image(), render::render_reference(list)));
}

}  // namespace
}  // namespace corda
