#include "corda/core/image.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace corda {
namespace {

TEST(Color, ReadsAndWritesHexadecimalText) {
    EXPECT_EQ(Color::parse("#12ABef"), (Color{0x12, 0xab, 0xef, 255}));
    EXPECT_EQ(Color::parse("#12abef80"), (Color{0x12, 0xab, 0xef, 0x80}));
    EXPECT_EQ(Color::parse("#1aF"), (Color{0x11, 0xaa, 0xff, 255}));
    EXPECT_EQ(Color::parse("#1aF8"), (Color{0x11, 0xaa, 0xff, 0x88}));
    EXPECT_EQ((Color{0x12, 0xab, 0xef, 255}.text()), "#12abef");
    EXPECT_EQ((Color{0x12, 0xab, 0xef, 0x80}.text()), "#12abef80");
}

TEST(Color, ReadsTheNamesOfCssInAnyCase) {
    EXPECT_EQ(Color::parse("aqua"), (Color{0x00, 0xff, 0xff, 255}));
    EXPECT_EQ(Color::parse("Gray"), (Color{0x80, 0x80, 0x80, 255}));
    EXPECT_EQ(Color::parse("YELLOW"), (Color{0xff, 0xff, 0x00, 255}));
    EXPECT_EQ(Color::parse("Orange"), (Color{0xff, 0xa5, 0x00, 255}));
    EXPECT_EQ(Color::parse("steelblue"), (Color{0x46, 0x82, 0xb4, 255}));
    EXPECT_EQ(Color::parse("transparent"), (Color{0, 0, 0, 0}));
}

TEST(Color, ReadsAllOfItsNames) {
    const auto names = Color::names();
    EXPECT_EQ(names.size(), 148U);
    EXPECT_TRUE(std::ranges::is_sorted(names));
    for (const std::string_view name : names) EXPECT_TRUE(Color::parse(name).has_value()) << name;
}

TEST(Color, RejectsOtherText) {
    for (const char* text : {"", "redd", "red ", "#red", "#12", "#12g", "#12345", "123456", "#12345g",
                             "tomatoes", "#1234567", "#-12345", "#12345678 "}) {
        EXPECT_FALSE(Color::parse(text).has_value()) << text;
    }
}

}  // namespace
}  // namespace corda
