#include "corda/media/encode/disk_space.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/failure.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

TEST_F(Video, TakesNoLessThanTheLeastNeed) {
    for (const char* const ending : {".mp4", ".webm", ".mov", ".mkv", ".gif", ".apng", ".webp"}) {
        const VideoDef def = small_video({50, 1});
        const std::string path = file(std::string("a") + ending);
        make_video(path, def, 20);
        const DiskNeed need = disk_need(find_format(path, def), def, 20);
        EXPECT_GT(need.least, 0U) << ending;
        EXPECT_LT(need.least, 2 * test::read_file(path).size()) << ending;
        EXPECT_LT(need.least, need.usual) << ending;
    }
}

TEST_F(Video, ThatCannotFitOntoItsDiskIsRefused) {
    const VideoDef def = small_video({50, 1});
    constexpr std::int64_t kTooMany = 100'000'000'000'000;
    for (const std::string& path : {file("a.mp4"), file("new/folder/%04d.png")}) {
        const Format format = find_format(path, def);
        check_disk_space(format, path, def, 20, 0);
        EXPECT_EQ(disk_warning(format, path, def, 20), "");
        EXPECT_THAT(disk_warning(format, path, def, kTooMany),
                    testing::HasSubstr("may not fit onto its disk"));
        const test::Failure failure =
            test::failure_of([&] { check_disk_space(format, path, def, kTooMany, 0); });
        EXPECT_EQ(failure.code, ExitCode::kIo);
        EXPECT_THAT(failure.message, testing::HasSubstr("does not fit onto its disk"));
        // What stands already counts.
        check_disk_space(format, path, def, kTooMany, disk_need(format, def, kTooMany).least);
    }
    EXPECT_EQ(disk_need(find_format("-", def), def, kTooMany).least, 0U);
}

TEST_F(Video, EveryEncoderHasANeed) {
    for (const Ending& ending : endings()) {
        if (ending.kind == FileKind::kStream) continue;
        for (const char* const codec : ending.codecs) {
            if (codec == nullptr) continue;
            VideoDef def = small_video({50, 1});
            if (ending.kind == FileKind::kVideo) def.encoder.codec = codec;
            const Format format = find_format(std::string("a") + ending.text, def);
            EXPECT_GT(disk_need(format, def, 1000).usual, 0U) << ending.text << ' ' << codec;
        }
    }
}

}  // namespace
}  // namespace corda::media
