#include "corda/media/format/format.hpp"

#include <gtest/gtest.h>

#include "corda/core/basics.hpp"

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

TEST(PictureNames, OnlyTheLastPartOfThePathIsAPattern) {
    EXPECT_NO_THROW(check_picture_names("100%/a%d/%04d.png"));
    EXPECT_EQ(picture_name("100%/a%d/%04d.png", 7), "100%/a%d/0007.png");
    EXPECT_TRUE(is_picture_name("100%/a%d/%04d.png", "0007.png"));
}

TEST(PictureNames, TwoPerCentSignsAreOne) {
    EXPECT_EQ(picture_name("50%%/50%%_%02d%%.png", 7), "50%%/50%_07%.png");
    EXPECT_EQ(picture_name("%%d%d.png", 7), "%d7.png");
    EXPECT_EQ(picture_name("%%%04d.png", 7), "%0007.png");
    EXPECT_TRUE(is_picture_name("50%%_%02d%%.png", "50%_07%.png"));
    EXPECT_FALSE(is_picture_name("50%%_%02d%%.png", "50%%_07%%.png"));
}

TEST(PictureNames, WithoutExactlyOneNumberAreRefused) {
    for (const char* const name : {"a.png", "%d%d.png", "%04d/a.png", "%%04d.png", "50%_%d.png", "%4d.png",
                                   "%00d.png", "%d%", "%", "%d/"})
        EXPECT_THROW(check_picture_names(name), Error) << name;
}

}  // namespace
}  // namespace corda::media
