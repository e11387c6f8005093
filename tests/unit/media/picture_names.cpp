#include "corda/media/picture_names.hpp"

#include <gtest/gtest.h>

namespace corda::media {
namespace {

TEST(PictureNames, HaveTheNumberOfTheFrame) {
    EXPECT_EQ(picture_name("frames/%04d.png", 7), "frames/0007.png");
    EXPECT_EQ(picture_name("frames/%04d.png", 12345), "frames/12345.png");
    EXPECT_EQ(picture_name("a%db.png", 7), "a7b.png");
}

TEST(PictureNames, AreKnownAgain) {
    for (const char* const name : {"0007.png", "0123.png", "12345.png"})
        EXPECT_TRUE(is_picture_name("frames/%04d.png", name)) << name;
    for (const char* const name :
         {"007.png", "0007.jpg", "a0007.png", "000a.png", ".png", "", "0007.png.png"})
        EXPECT_FALSE(is_picture_name("frames/%04d.png", name)) << name;
    EXPECT_TRUE(is_picture_name("a%db.png", "a7b.png"));
    EXPECT_FALSE(is_picture_name("a%da.png", "a.png"));
}

}  // namespace
}  // namespace corda::media
