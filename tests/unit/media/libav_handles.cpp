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
        VideoWriter writer(file("a.mp4"), small_video(), 8);
        EXPECT_THAT(printed(), IsEmpty());
        write_frames(writer, 0, 8);
        writer.finish();
    }
    EXPECT_THAT(printed(), HasSubstr("trouble of the host"));
}

TEST_F(Video, PrintsNothingItself) {
    make_video(file("a.mp4"), small_video(), 8);
    testing::internal::CaptureStderr();
    {
        VideoWriter unfinished(file("c.mp4"), small_video(), 8);
        write_frames(unfinished, 0, 4);
    }
    make_video(file("d.mp4"), small_video(), 8);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace corda::media
