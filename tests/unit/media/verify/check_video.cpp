#include "corda/media/verify/check_video.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/decode_video.hpp"
#include "support/failure.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kFrames = 20;

/// A test with a film in a file of each ending.
class CheckVideo : public Video {
  protected:
    /// What is wrong with the video of this name; empty for nothing.
    [[nodiscard]] std::string problem(const std::string& name, const VideoDef& def,
                                      std::int64_t frames = kFrames,
                                      const Image& first = frame_image(0)) const {
        return test::failure_of([&] { check_video(file(name), find_format(name, def), def, frames, first); })
            .message;
    }

    VideoDef def_ = small_video({30000, 1001});
};

TEST_F(CheckVideo, FindsNothingInWhatWasWritten) {
    for (const std::string name : {"a.mp4", "a.mov", "a.webm", "a.mkv", "a.gif"}) {
        make_video(file(name), def_, kFrames);
        EXPECT_THAT(problem(name, def_), IsEmpty()) << name;
    }
}

TEST_F(CheckVideo, FindsAnotherNumberOfFramesAndAnotherRate) {
    for (const std::string name : {"a.mp4", "a.mov", "a.webm", "a.mkv", "a.gif"}) {
        make_video(file(name), def_, kFrames);
        EXPECT_THAT(problem(name, def_, kFrames + 1), HasSubstr("it has 20 frames instead of 21")) << name;
        EXPECT_THAT(problem(name, small_video({25, 1})), HasSubstr("frame 1 is at tick")) << name;
    }
}

TEST_F(CheckVideo, FindsAnotherFirstPicture) {
    for (const std::string name : {"a.mp4", "a.mov", "a.webm", "a.mkv", "a.gif"}) {
        make_video(file(name), def_, kFrames);
        Image other = frame_image(0);
        for (std::size_t i = 1; i < other.size_bytes(); i += 4) other.data()[i] ^= 0x40U;
        EXPECT_THAT(problem(name, def_, kFrames, other), HasSubstr("the first picture has R'G'B'")) << name;
        VideoDef larger = def_;
        larger.width_px += 2;
        EXPECT_THAT(problem(name, larger), HasSubstr("the first picture has 320x180 pixels")) << name;
    }
}

TEST_F(CheckVideo, FindsALateIndexRoundedClocksAndWrongTags) {
    make_video(file("a.mp4"), small_video(), kFrames);
    test::copy_video(file("a.mp4"), file("late.mp4"), test::Retag::kNone);
    EXPECT_THAT(problem("late.mp4", small_video()), HasSubstr("index is not before"));
    test::copy_video(file("a.mp4"), file("stream.mp4"), test::Retag::kStream);
    EXPECT_THAT(problem("stream.mp4", small_video()), HasSubstr("the colour tags of the first picture are"));
    test::copy_video(file("a.mp4"), file("box.mp4"), test::Retag::kContainer);
    EXPECT_THAT(problem("box.mp4", small_video()), HasSubstr("the colour tags of the container are"));
    const auto made =
        test::run_shell("ffmpeg -v error -i " + file("a.mp4") +
                        " -c copy -video_track_timescale 1001 -movflags +faststart " + file("clock.mp4"));
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_THAT(problem("clock.mp4", small_video()), HasSubstr("clock"));
}

TEST_F(CheckVideo, FindsAFirstPictureThatDoesNotDecode) {
    make_video(file("a.mp4"), def_, kFrames);
    std::string bytes = test::read_file(file("a.mp4"));
    const std::size_t data = bytes.find("mdat");  // behind it, what x264 says of itself
    for (std::size_t i = 720; i < 1200; ++i) bytes.at(data + i) = '\x5a';
    test::write_file(file("b.mp4"), bytes);
    EXPECT_THAT(problem("b.mp4", def_), HasSubstr("does not decode"));
}

}  // namespace
}  // namespace corda::media
