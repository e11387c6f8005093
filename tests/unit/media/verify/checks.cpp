#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "corda/media/verify/checks.hpp"

namespace corda::media {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The first note on a sound video of yuv420p.
std::string first_note(const char* codec, const char* container, int width_px, int height_px, Rational fps) {
    VerifyReport report;
    report.codec = codec;
    report.container = container;
    report.pixel_format = "yuv420p";
    if (report.codec == "h264") report.profile = "High";
    report.width_px = width_px;
    report.height_px = height_px;
    report.fps = fps;
    add_notes({}, VerifyDepth::kAllFrames, report);
    return report.notes.front();
}

TEST(Players, FollowFromTheLevelThatSizeAndRateTake) {
    EXPECT_THAT(first_note("av1", "mp4", 1920, 1080, {60, 1}), HasSubstr("Chrome, Edge and Firefox play it"));
    EXPECT_THAT(first_note("av1", "mp4", 8192, 4320, {30, 1}), HasSubstr("takes level 6.0"));
    EXPECT_THAT(first_note("av1", "mp4", 8192, 4320, {60, 1}), HasSubstr("takes level 6.1"));
    EXPECT_THAT(first_note("av1", "mp4", 640, 8706, {25, 1}), HasSubstr("beyond every level of AV1"));
    EXPECT_THAT(first_note("vp9", "webm", 3840, 2160, {60, 1}), HasSubstr("new Safari play it"));
    EXPECT_THAT(first_note("vp9", "webm", 8386, 16, {1, 1}), HasSubstr("takes level 6.0"));
    EXPECT_THAT(first_note("vp9", "webm", 8192, 8192, {25, 1}), HasSubstr("beyond every level of VP9"));
    EXPECT_THAT(first_note("h264", "mp4", 3840, 2160, {60, 1}), HasSubstr("PowerPoint play it"));
}

TEST(Players, AnotherCodecIsAdvisedIfItHasALevel) {
    EXPECT_THAT(first_note("h264", "mp4", 8192, 4320, {1, 1}), HasSubstr("or take H.265 or AV1"));
    EXPECT_THAT(first_note("h264", "mp4", 8192, 8192, {60, 1}), Not(HasSubstr("AV1")));
    EXPECT_THAT(first_note("av1", "mp4", 8192, 8192, {60, 1}), Not(HasSubstr("or take")));
}

}  // namespace
}  // namespace corda::media
