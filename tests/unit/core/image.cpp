#include "corda/core/image.hpp"

#include <gtest/gtest.h>

namespace corda {
namespace {

TEST(PixelRect, UnionIgnoresEmptyRectangles) {
    const PixelRect a{2, 3, 5, 7};
    EXPECT_EQ(a.united({}), a);
    EXPECT_EQ(PixelRect{}.united(a), a);
    EXPECT_EQ(a.united({9, 9, 9, 12}), a);
    EXPECT_EQ(a.united({0, 6, 3, 9}), (PixelRect{0, 3, 5, 9}));
}

TEST(PixelRect, IntersectionOfSeparateRectanglesIsEmpty) {
    EXPECT_TRUE((PixelRect{0, 0, 2, 2}.intersected({2, 0, 4, 2}).empty()));
    EXPECT_EQ((PixelRect{0, 0, 4, 4}.intersected({2, -1, 9, 3})), (PixelRect{2, 0, 4, 3}));
}

TEST(Image, IsStoredRowByRowFromTheTop) {
    Image image(3, 2);
    image.pixel(2, 1)[3] = 7;
    EXPECT_EQ(image.size_bytes(), 24U);
    EXPECT_EQ(image.data()[23], 7);
}

}  // namespace
}  // namespace corda
