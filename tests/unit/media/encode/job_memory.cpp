#include "corda/media/encode/job_memory.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace corda::media {
namespace {

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
    EXPECT_LT(bytes_per_pixel("a.mov", ""), bytes_per_pixel("a.apng", ""));
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
