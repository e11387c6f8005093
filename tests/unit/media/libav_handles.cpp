#include <gmock/gmock.h>

#include <string>

extern "C" {
#include <libavutil/log.h>
}

#include "support/command.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Output on stderr of an error that the host application reports by libav.
std::string printed() {
    testing::internal::CaptureStderr();
    av_log(nullptr, AV_LOG_ERROR, "trouble of the host\n");
    return testing::internal::GetCapturedStderr();
}

TEST_F(Video, LeavesLibavsMessagesToTheHostOnceItIsDone) {
    EXPECT_THAT(printed(), HasSubstr("trouble of the host"));
    {
        VideoWriter writer(file("a.mp4"), small_video(), {});
        EXPECT_THAT(printed(), IsEmpty());
        write_frames(writer, 8);
        writer.finish();
    }
    EXPECT_THAT(printed(), HasSubstr("trouble of the host"));
}

TEST_F(Video, PrintsNothingItself) {
    make_video(file("a.mp4"), small_video(), 8);
    std::string broken = test::read_file(file("a.mp4"));
    const std::size_t data = broken.find("mdat");
    for (std::size_t i = data + 700; i < data + 800; ++i) broken[i] = static_cast<char>(broken[i] ^ 0xa5);
    testing::internal::CaptureStderr();
    test::write_file(file("b.mp4"), broken);
    EXPECT_FALSE(verify(file("b.mp4")).ok());
    abandon_video(file("c.mp4"), small_video(), 8);
    make_video(file("d.mp4"), small_video(), 8);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace corda::media
