#include "corda/media/read/stored_video.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "corda/core/basics.hpp"
#include "support/decode_video.hpp"
#include "support/failure.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

TEST_F(Video, ReaderGivesThePicturesThatLibavGives) {
    make_video(file("a.mp4"), small_video(), 12);
    const auto expected = test::decode_video(file("a.mp4"));
    StoredVideo video(file("a.mp4"));
    EXPECT_EQ(video.rate(), (Rational{60, 1}));
    StoredPicture picture;
    std::size_t frames = 0;
    for (; video.read(picture); ++frames) {
        ASSERT_LT(frames, expected.pictures.size());
        EXPECT_EQ(picture.format, "yuv420p");
        for (int plane = 0; plane < 3; ++plane) {
            const test::Yuv420Image& wanted = expected.pictures[frames];
            const auto count = std::ptrdiff_t{wanted.plane_width(plane)} * wanted.plane_height(plane);
            EXPECT_TRUE(std::equal(wanted.plane(plane), wanted.plane(plane) + count,
                                   picture.samples.begin() + std::ptrdiff_t{plane} * kWidth * kHeight))
                << frames;
        }
    }
    EXPECT_EQ(frames, 12U);
    EXPECT_FALSE(video.read(picture));
}

TEST_F(Video, ReaderShowsThePicturesOfEveryPixelFormat) {
    const auto def_of = [](const char* codec, PixelChoice pix) {
        VideoDef def = small_video();
        def.encoder.codec = codec;
        def.encoder.pix = pix;
        return def;
    };
    const std::vector<std::pair<std::string, VideoDef>> videos{
        {file("420.mp4"), def_of("h264", PixelChoice::k420)},
        {file("444.mp4"), def_of("h264", PixelChoice::k444)},
        {file("10_bits.mov"), def_of("prores", PixelChoice::kAuto)},
        {file("exact.mkv"), def_of("ffv1", PixelChoice::kAuto)}};
    for (const auto& [path, def] : videos) {
        make_video(path, def, 3);
        StoredVideo video(path);
        StoredPicture picture;
        ASSERT_TRUE(video.read(picture)) << path;
        const Image shown = picture.rgba();
        for (const Patch& patch : patches) {
            const std::uint8_t* const pixel = shown.pixel(patch.rect.x0 + 24, patch.rect.y0 + 24);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c], patch.rgb[c], 3) << path << ' ' << c;  // 2
            EXPECT_EQ(pixel[3], 255);
        }
        EXPECT_TRUE(video.read(picture) && video.read(picture));
        EXPECT_FALSE(video.read(picture)) << path;
    }
}

TEST_F(Video, ReaderRefusesOtherFiles) {
    const auto failure_at = [](const std::string& path) {
        return test::failure_of([&path] { const StoredVideo video(path); });
    };
    const test::Failure text = failure_at(folder_.write("a.mp4", "no video"));
    EXPECT_EQ(text.code, ExitCode::kIo);
    EXPECT_THAT(text.message, testing::HasSubstr("is no video of a kind that is known"));
    const test::Failure missing = failure_at(file("missing.mp4"));
    EXPECT_EQ(missing.code, ExitCode::kIo);
    EXPECT_THAT(missing.message, testing::HasSubstr("missing.mp4"));
}

}  // namespace
}  // namespace corda::media
