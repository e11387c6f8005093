#include "corda/core/image.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "corda/core/css_colors.hpp"

namespace corda {
namespace {

TEST(Color, ReadsAndWritesHexadecimalText) {
    EXPECT_EQ(Color::parse("#12ABef"), (Color{0x12, 0xab, 0xef, 255}));
    EXPECT_EQ(Color::parse("#12abef80"), (Color{0x12, 0xab, 0xef, 0x80}));
    EXPECT_EQ(Color::parse("transparent"), (Color{0, 0, 0, 0}));
    EXPECT_EQ((Color{0x12, 0xab, 0xef, 255}.text()), "#12abef");
    EXPECT_EQ((Color{0x12, 0xab, 0xef, 0x80}.text()), "#12abef80");
}

TEST(Color, ReadsTheNamesOfCssInAnyCase) {
    EXPECT_EQ(Color::parse("tomato"), (Color{0xff, 0x63, 0x47, 255}));
    EXPECT_EQ(Color::parse("RebeccaPurple"), (Color{0x66, 0x33, 0x99, 255}));
    EXPECT_EQ(Color::parse("aliceblue"), (Color{0xf0, 0xf8, 0xff, 255}));
    EXPECT_EQ(Color::parse("yellowgreen"), (Color{0x9a, 0xcd, 0x32, 255}));
    EXPECT_EQ(Color::parse("grey"), Color::parse("gray"));
    EXPECT_EQ(kCssColors.size(), 148U);
    EXPECT_TRUE(std::is_sorted(kCssColors.begin(), kCssColors.end(),
                               [](const CssColor& a, const CssColor& b) { return a.name < b.name; }));
}

TEST(Color, RejectsOtherText) {
    for (const char* text :
         {"", "redd", "red ", "#red", "#123", "123456", "#12345g", "#1234567", "#-12345", "#12345678 "}) {
        EXPECT_FALSE(Color::parse(text).has_value()) << text;
    }
}

}  // namespace
}  // namespace corda
