#include "corda/render/frame_renderer.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "support/draw_lists.hpp"
#include "support/image_matchers.hpp"

namespace corda::render {
namespace {

/// Composites an image onto a grey ground, like a viewer.
std::uint8_t over(const std::uint8_t* rgba, int channel, int level) {
    return static_cast<std::uint8_t>((rgba[channel] * rgba[3] + level * (255 - rgba[3]) + 127) / 255);
}

/// The largest difference, in levels, of a picture with alpha, put on a ground of that level, from the same
/// list drawn on that ground.
int largest_difference(view::DrawList list, int level) {
    const Image clear = render_reference(list);
    for (Color* color : {&list.ground.top, &list.ground.bottom}) {
        const std::uint8_t rgba[]{color->r, color->g, color->b, color->a};
        *color = {over(rgba, 0, level), over(rgba, 1, level), over(rgba, 2, level)};
    }
    const Image opaque = render_reference(list);
    int largest = 0;
    for (int y = 0; y < list.height; ++y) {
        for (int x = 0; x < list.width; ++x) {
            for (int c = 0; c < 3; ++c)
                largest =
                    std::max(largest, std::abs(over(clear.pixel(x, y), c, level) - opaque.pixel(x, y)[c]));
        }
    }
    return largest;
}

TEST(TransparentGround, CompositesToAnOpaqueGroundOnBlackAndWhite) {
    for (const Color& ground : {Color{0, 0, 0, 0}, {255, 255, 255, 0}, {200, 60, 10, 100}}) {
        for (std::uint32_t seed = 1; seed <= 8; ++seed) {
            // A halo and a line, each rounded once, and the alpha of the file.
            view::DrawList list = test::random_draw_list(seed, 160, 120, 1, 12);
            list.ground = {ground, ground};
            for (const int level : {0, 255, 99}) EXPECT_LE(largest_difference(list, level), 2);  // measured 2
            list = test::random_draw_list(seed, 160, 120, 8, 12);
            list.ground = {ground, ground};
            // Each layer rounds once more.
            for (const int level : {0, 255, 99}) EXPECT_LE(largest_difference(list, level), 3);  // measured 3
        }
    }
}

TEST(TransparentGround, KeepsColourAndCoverageOfALine) {
    view::DrawList list;
    list.width = 40;
    list.height = 20;
    list.ground = {{0, 0, 0, 0}, {0, 0, 0, 0}};
    list.add_layer({200, 100, 50});
    list.add_capsule({5.0, 10.25}, {35.0, 10.25}, 3.0);
    const Image image = render_reference(list);
    const std::uint8_t* const edge = image.pixel(20, 7);  // from 7 to 8, covered from 7.25 on
    EXPECT_EQ(edge[3], 191);
    EXPECT_NEAR(edge[0], 200, 1);
    EXPECT_NEAR(edge[1], 100, 1);
    EXPECT_EQ(image.pixel(20, 10)[3], 255);
    EXPECT_EQ(image.pixel(20, 2)[3], 0);
}

TEST(TransparentGround, ShowsInHalos) {
    view::DrawList list;
    list.width = 40;
    list.height = 40;
    list.ground = {{10, 20, 30, 0}, {10, 20, 30, 0}};
    list.add_layer({255, 0, 0});
    list.add_capsule({0.0, 20.0}, {40.0, 20.0}, 8.0);
    list.add_layer({0, 0, 255});
    list.add_capsule({20.0, 0.0}, {20.0, 40.0}, 3.0, 4.0);
    const Image image = render_reference(list);
    EXPECT_EQ(image.pixel(5, 20)[3], 255);
    EXPECT_EQ(image.pixel(14, 20)[3], 0);  // 5.5 px from the axis: within the halo
    EXPECT_EQ(image.pixel(20, 20)[3], 255);
    EXPECT_EQ(image.pixel(20, 20)[2], 255);
}

TEST(TintedLayer, OfOneTintEqualsAPlainLayer) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        view::DrawList list = test::random_draw_list(seed, 160, 120, 4, 30);
        view::DrawList tinted = list;
        for (view::Layer& layer : tinted.layers) {
            layer.is_tinted = true;
            for (std::size_t i = 0; i < layer.capsule_count; ++i)
                tinted.capsules[layer.first_capsule + i].tint = {layer.color.r, layer.color.g, layer.color.b};
            layer.color = {1, 2, 3, layer.color.a};
        }
        EXPECT_TRUE(test::equal_images(render_reference(tinted), render_reference(list))) << seed;
    }
}

view::DrawList two_links(view::PixelPoint joint) {
    view::DrawList list;
    list.width = 60;
    list.height = 40;
    list.add_layer({}, true);
    list.add_capsule({5.0, 20.0}, joint, 8.0, 0.0, {200, 0, 0});
    list.add_capsule(joint, {55.0, 20.0}, 8.0, 0.0, {0, 0, 200});
    return list;
}

TEST(TintedLayer, HasSharpEdgesBetweenCollinearLinks) {
    const Image image = render_reference(two_links({30.25, 20.0}));
    for (const int y : {14, 20, 25}) {
        EXPECT_EQ(image.pixel(28, y)[0], 199);  // the next link's round end counts as one to 256
        EXPECT_EQ(image.pixel(28, y)[2], 1);
        EXPECT_NEAR(image.pixel(30, y)[0], 50, 2);  // a quarter of the pixel
        EXPECT_NEAR(image.pixel(30, y)[2], 150, 2);
        EXPECT_EQ(image.pixel(32, y)[0], 1);
        EXPECT_EQ(image.pixel(32, y)[2], 199);
    }
    EXPECT_EQ(image.pixel(10, 20)[0], 200);
}

TEST(TintedLayer, CoversCornersLikeAPlainLayer) {
    view::DrawList list = two_links({30.0, 8.0});
    const Image tinted = render_reference(list);
    list.layers.front().is_tinted = false;
    const Image plain = render_reference(list);
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 60; ++x) EXPECT_EQ(tinted.pixel(x, y)[3], plain.pixel(x, y)[3]);
    }
    EXPECT_NEAR(tinted.pixel(30, 2)[0], 100, 3);  // outside of the bend: half of each
    EXPECT_NEAR(tinted.pixel(30, 2)[2], 100, 3);
}

TEST(TintedLayer, ShowsTheHeaviestCapsule) {
    view::DrawList list = two_links({30.0, 20.0});
    list.add_capsule({30.0, 20.0}, {30.0, 20.0}, 12.0, 0.0, {0, 250, 0, 64});
    const Image image = render_reference(list);
    EXPECT_GE(image.pixel(30, 20)[1], 240);
    EXPECT_LE(image.pixel(30, 20)[0], 4);
}

TEST(MarkCovered, MarksPixelsThatABlackLineHalfCovers) {
    view::DrawList list;
    list.width = 60;
    list.height = 40;
    list.ground.top = list.ground.bottom = {255, 255, 255, 255};
    list.add_layer({0, 0, 0, 255});
    list.add_capsule({5.3, 8.1}, {44.2, 31.7}, 3.6);
    list.add_capsule({44.2, 31.7}, {70.0, 10.0}, 1.1);
    const Image image = render_reference(list);
    std::vector<std::uint8_t> mask(60 * 40);
    mark_covered(list, 7, mask);
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 60; ++x)
            ASSERT_EQ(mask[60 * y + x], image.pixel(x, y)[0] < 128 ? 7 : 0) << x << ", " << y;
    }
}

}  // namespace
}  // namespace corda::render
