#include "corda/core/image.hpp"

#include <gtest/gtest.h>

namespace corda {
namespace {

TEST(Color, ReadsAndWritesHexadecimalText) {
    EXPECT_EQ(Color::parse("#12ABef"), (Color{0x12, 0xab, 0xef, 255}));
    EXPECT_EQ(Color::parse("#12abef80"), (Color{0x12, 0xab, 0xef, 0x80}));
    EXPECT_EQ(Color::parse("transparent"), (Color{0, 0, 0, 0}));
    EXPECT_EQ((Color{0x12, 0xab, 0xef, 255}.text()), "#12abef");
    EXPECT_EQ((Color{0x12, 0xab, 0xef, 0x80}.text()), "#12abef80");
}

TEST(Color, RefusesEverythingElse) {
    for (const char* text : {"", "red", "#123", "123456", "#12345g", "#1234567", "#-12345", "#12345678 "}) {
        EXPECT_FALSE(Color::parse(text).has_value()) << text;
    }
}

}  // namespace
}  // namespace corda
