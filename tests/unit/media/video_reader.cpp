#include "corda/media/video_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "corda/core/basics.hpp"
#include "support/decode_video.hpp"
#include "video_support.hpp"

namespace corda::media {
namespace {

TEST_F(Video, ReaderGivesThePicturesThatLibavGives) {
    make_video(file("a.mp4"), small_video(), 12);
    const auto expected = test::decode_video(file("a.mp4"));
    VideoReader reader(file("a.mp4"));
    Yuv420Image picture;
    std::size_t frames = 0;
    for (; reader.read(picture); ++frames) {
        ASSERT_LT(frames, expected.pictures.size());
        EXPECT_EQ(picture, expected.pictures[frames]) << frames;
    }
    EXPECT_EQ(frames, 12U);
    EXPECT_FALSE(reader.read(picture));
}

TEST_F(Video, ReaderRefusesOtherFiles) {
    for (const std::string& path : {folder_.write("a.mp4", "no video"), file("missing.mp4")}) {
        try {
            const VideoReader reader(path);
            FAIL() << path;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::kIo);
            EXPECT_THAT(error.what(), testing::HasSubstr("the file does not open: "));
        }
    }
}

}  // namespace
}  // namespace corda::media
