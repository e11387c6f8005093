#include "corda/media/encode/resources.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/failure.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

TEST_F(Video, TakesNoLessThanTheLeastNeed) {
    for (const char* const ending : {".mp4", ".webm", ".mov", ".mkv", ".gif"}) {
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
        EXPECT_THAT(disk_warning(format, path, def, kTooMany), testing::HasSubstr("may not fit on its disk"));
        const test::Failure failure =
            test::failure_of([&] { check_disk_space(format, path, def, kTooMany, 0); });
        EXPECT_EQ(failure.code, ExitCode::kIo);
        EXPECT_THAT(failure.message, testing::HasSubstr("does not fit on its disk"));
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

constexpr int kSidePx = 200;

std::uint64_t bytes_per_pixel(const char* path, const char* codec, const char* preset = "") {
    VideoDef def;
    def.width_px = kSidePx;
    def.height_px = kSidePx;
    def.encoder.codec = codec;
    def.encoder.preset = preset;
    return bytes_per_job(find_format(path, def), def) / (kSidePx * kSidePx);
}

TEST(JobMemory, FollowsFromTheEncoderAndItsPreset) {
    EXPECT_LT(bytes_per_pixel("a.mp4", "libx264", "ultrafast"),
              bytes_per_pixel("a.mp4", "libx264", "medium"));
    EXPECT_LT(bytes_per_pixel("a.mp4", "libx264", "medium"), bytes_per_pixel("a.mp4", "libx264", "placebo"));
    EXPECT_LT(bytes_per_pixel("%04d.png", ""), bytes_per_pixel("a.mov", ""));
    // An encoder that was not measured is taken for the largest.
    EXPECT_EQ(bytes_per_pixel("a.mp4", "h264_nvenc"), bytes_per_pixel("a.mp4", "libaom-av1"));
}

TEST(JobMemory, LimitsTheJobs) {
    EXPECT_EQ(jobs_of(3), 3);
    EXPECT_GE(jobs_of(0), 1);
    EXPECT_EQ(jobs_that_fit(2, 1), 2);
    EXPECT_EQ(jobs_that_fit(2, std::numeric_limits<std::uint64_t>::max()), 0);
}

}  // namespace
}  // namespace corda::media
