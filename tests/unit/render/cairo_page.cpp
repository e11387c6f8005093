#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>

#include "corda/render/vector.hpp"
#include "corda/view/font.hpp"

namespace corda::render {
namespace {

using testing::HasSubstr;

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

constexpr Ground kWhite{{255, 255, 255}, {255, 255, 255}};

TEST(Svg, HasItsSizeAndTitle) {
    const std::string svg = svg_of(crossing(kWhite), "a < b & c\x01\x1b");
    EXPECT_THAT(svg, HasSubstr("<title>a &lt; b &amp; c\\x01\\x1b</title>"));
    EXPECT_THAT(svg, HasSubstr(R"(width="85mm" height="42.5mm")"));
    EXPECT_THAT(svg, HasSubstr("stroke:rgb(100%,0%,0%)"));
    EXPECT_EQ(svg_of(crossing(kWhite)), svg_of(crossing(kWhite)));
}

/// The values of all attributes `id`, and what refers to them.
std::set<std::string> matches(const std::string& svg, const char* pattern) {
    std::set<std::string> all;
    const std::regex regex(pattern);
    for (std::sregex_iterator it(svg.begin(), svg.end(), regex), end; it != end; ++it) all.insert((*it)[1]);
    return all;
}

TEST(Svg, HasIdentifiersThatNoOtherHas) {
    view::DrawList list = crossing({{0, 0, 0, 0}, {0, 0, 0, 0}});
    view::Font().write({.x_px = 10, .y_px = 40, .size_px = 12, .color = {4, 5, 6}, .utf8 = "a < b\x1b"},
                       list);
    const std::string svg = svg_of(list);
    const auto ids = matches(svg, R"(\bid="([^"]*)\")");
    EXPECT_FALSE(ids.empty());
    EXPECT_THAT(ids, ::testing::IsSupersetOf(matches(svg, R"((?:url\(#|xlink:href="#)([^")]*))")));
    EXPECT_TRUE(matches(svg, R"(( href=))").empty());  // Inkscape 1.2 knows xlink:href alone
    list.add_box({10, 5, 20, 9}, {1, 2, 3, 51});
    for (const std::string& id : matches(svg_of(list), R"(\bid="([^"]*)\")"))
        EXPECT_FALSE(ids.contains(id)) << id;
}

TEST(Svg, StaysSmallWithManyHalosOverATransparentGround) {
    view::DrawList list = crossing({{0, 0, 0, 0}, {0, 0, 0, 0}});
    for (int i = 0; i < 100; ++i) {
        list.add_layer({0, 0, 0});
        list.add_capsule({10.0 + 0.8 * i, 5.0}, {20.0, 45.0}, 1.0, 1.0);
    }
    EXPECT_LT(svg_of(list).size(), 1.2e6);
}

}  // namespace
}  // namespace corda::render
