#include "corda/media/video_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "corda/core/basics.hpp"
#include "support/decode_video.hpp"
#include "support/failure.hpp"
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
    const auto failure_at = [](const std::string& path) {
        return test::failure_of([&path] { const VideoReader reader(path); });
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
