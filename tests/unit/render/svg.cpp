#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "corda/render/vector.hpp"
#include "corda/view/font.hpp"

namespace corda::render {
namespace {

using testing::HasSubstr;
using testing::Not;

view::DrawList crossing(const Ground& ground) {
    view::DrawList list;
    list.width = 100;
    list.height = 50;
    list.ground = ground;
    list.add_layer({255, 0, 0});
    list.add_capsule({10.0, 25.0}, {90.0, 25.125}, 2.0);
    list.add_layer({0, 0, 255, 51});
    list.add_capsule({50.0, 5.0}, {50.0, 45.0}, 3.0, 1.5);
    return list;
}

std::string svg_of(const view::DrawList& list, const std::string& title = "x") {
    const auto page = make_svg({.width_px = 100, .height_px = 50, .width_mm = 85.0, .title = title});
    page->draw(list, 0, 0);
    return page->finish();
}

TEST(Svg, HasOnePathPerWidthOfALayer) {
    const std::string svg = svg_of(crossing({{255, 255, 255}, {255, 255, 255}}), "a < b & c");
    EXPECT_THAT(svg, HasSubstr("<title>a &lt; b &amp; c</title>"));
    EXPECT_THAT(svg, HasSubstr(R"(width="85mm" height="42.5mm" viewBox="0 0 100 50")"));
    EXPECT_THAT(svg, HasSubstr("<g stroke=\"#ff0000\">\n<path stroke-width=\"4\" d=\"M10 25L90 25.12\"/>"));
    EXPECT_THAT(svg, HasSubstr("<g stroke=\"#0000ff\" opacity=\"0.2\">"));
    // The halo: the ground's colour, as see-through as the layer.
    EXPECT_THAT(svg, HasSubstr("<g stroke=\"#ffffff\" opacity=\"0.2\">\n<path stroke-width=\"9\""));
    EXPECT_THAT(svg, Not(HasSubstr("mask")));
}

TEST(Svg, PaintsHalosInTheColoursOfTheGround) {
    const std::string svg = svg_of(crossing({{0, 0, 0}, {255, 255, 255}}));
    EXPECT_THAT(svg, HasSubstr("<linearGradient id=\"ground0\""));
    EXPECT_THAT(svg, HasSubstr("<g stroke=\"url(#ground0)\" opacity=\"0.2\">"));
}

TEST(Svg, CutsHalosOutOverATransparentGround) {
    const std::string svg = svg_of(crossing({{0, 0, 0, 0}, {0, 0, 0, 0}}));
    EXPECT_THAT(svg, Not(HasSubstr("<rect width=\"100\" height=\"50\" fill=\"#000000\"")));
    EXPECT_THAT(svg, HasSubstr("<g mask=\"url(#mask1)\">\n<g stroke=\"#ff0000\">"));
    EXPECT_THAT(svg, HasSubstr("<use href=\"#halo0\"/>"));
}

TEST(Svg, NestsMasksOnlyLogarithmicallyDeep) {
    view::DrawList list = crossing({{0, 0, 0, 0}, {0, 0, 0, 0}});
    for (int i = 0; i < 1000; ++i) {
        list.add_layer({0, 0, 0});
        list.add_capsule({10.0 + 0.08 * i, 5.0}, {20.0, 45.0}, 1.0, 1.0);
    }
    const std::string svg = svg_of(list);
    int depth = 0;
    int deepest = 0;
    for (std::size_t i = 0; i < svg.size(); ++i) {
        if (svg.compare(i, 2, "<g") == 0) deepest = std::max(deepest, ++depth);
        if (svg.compare(i, 3, "</g") == 0) --depth;
    }
    EXPECT_EQ(depth, 0);
    EXPECT_LE(deepest, 13);        // measured 12
    EXPECT_LT(svg.size(), 1.2e6);  // measured 0.6 MB
}

TEST(Svg, EscapesControlCharactersOfATitle) {
    const std::string svg = svg_of(crossing({{255, 255, 255}, {255, 255, 255}}), "a\x01\x1b");
    EXPECT_THAT(svg, HasSubstr("<title>a\\x01\\x1b</title>"));
}

TEST(Svg, GivesEachLinkOfATintedLayerItsColour) {
    view::DrawList list;
    list.width = 100;
    list.height = 50;
    list.ground = {{255, 255, 255}, {255, 255, 255}};
    list.add_layer({0, 0, 0, 51}, true);
    list.add_capsule({10.0, 25.0}, {50.0, 25.0}, 2.0, 0.0, {255, 0, 0});
    list.add_capsule({50.0, 25.0}, {90.0, 25.0}, 2.0, 0.0, {0, 0, 255});
    const std::string svg = svg_of(list);
    const std::string first = R"(<path stroke="#ff0000" stroke-width="4")";
    const std::string blunt = R"(<path stroke="#ff0000" stroke-linecap="butt" stroke-width="4")";
    EXPECT_THAT(svg, HasSubstr("opacity=\"0.2\""));
    EXPECT_LT(svg.find(first), svg.find(blunt));
    EXPECT_LT(svg.find(R"(<path stroke="#0000ff" stroke-width="4")"), svg.find(blunt));
    EXPECT_THAT(svg, HasSubstr(R"(<path stroke="#0000ff" stroke-linecap="butt")"));
}

TEST(Svg, WritesTextOverTheLayers) {
    view::DrawList list = crossing({{255, 255, 255}, {255, 255, 255}});
    list.add_box({10, 5, 20, 9}, {1, 2, 3, 51});
    view::Font().write({.x_px = 10, .y_px = 40, .size_px = 12, .color = {4, 5, 6}, .utf8 = "a < b\x1b"},
                       list);
    const std::string svg = svg_of(list);
    EXPECT_THAT(svg,
                HasSubstr(R"(<rect x="10" y="5" width="10" height="4" fill="#010203" fill-opacity="0.2"/>)"));
    EXPECT_THAT(svg, HasSubstr(R"(font-size="12" fill="#040506" xml:space="preserve">a &lt; b\x1b</text>)"));
    EXPECT_LT(svg.find("<path"), svg.find("<text"));
}

TEST(Svg, DoesNotDarkenAGroundThatFadesOut) {
    const std::string svg = svg_of(crossing({{255, 255, 255}, {0, 0, 0, 0}}));
    EXPECT_THAT(
        svg,
        HasSubstr(R"(<stop stop-color="#ffffff"/><stop offset="1" stop-color="#ffffff" stop-opacity="0"/>)"));
}

}  // namespace
}  // namespace corda::render
