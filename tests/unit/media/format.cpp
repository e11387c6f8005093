#include "corda/media/format.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/pixdesc.h>
}

#include "support/failure.hpp"

namespace corda::media {
namespace {

using test::failure_of;
using testing::HasSubstr;

TEST(Formats, AreNamedAsLibavNamesThem) {
    for (const Format& format : formats()) {
        EXPECT_NE(av_guess_format(format.container, nullptr, nullptr), nullptr) << format.container;
        EXPECT_NE(avcodec_find_encoder_by_name(format.codec), nullptr) << format.codec;
        EXPECT_NE(av_get_pix_fmt(format.pixel_format), AV_PIX_FMT_NONE) << format.pixel_format;
    }
}

TEST(Formats, AreFoundByTheEndingOfAName) {
    EXPECT_STREQ(find_format("some.folder/a.b.mp4").container, "mp4");
    EXPECT_STREQ(find_format("a.mp4", "libx264").codec, "libx264");
}

TEST(Formats, UnknownOnesAreRefusedNamingTheKnown) {
    for (const char* const name : {"a.avi", "a", "a.mp4.part", "mp4", ".mp4", "a.mp4/b", ""}) {
        const test::Failure failure = failure_of([&] { static_cast<void>(find_format(name)); });
        EXPECT_EQ(failure.code, ExitCode::kUsage) << name;
        EXPECT_THAT(failure.message, HasSubstr("use .mp4")) << name;
    }
    const test::Failure failure = failure_of([] { static_cast<void>(find_format("a.mp4", "gif")); });
    EXPECT_EQ(failure.code, ExitCode::kUsage);
    EXPECT_THAT(failure.message, HasSubstr("cannot hold the codec 'gif'; use libx264"));
}

TEST(Formats, ListEachCodecOnce) {
    EXPECT_THAT(codec_names(), testing::ElementsAre("libx264"));
}

TEST(VideoDefs, OfEveryFieldTheBoundsAreChecked) {
    const auto code_with = [](void (*change)(VideoDef&)) {
        VideoDef def;
        change(def);
        return failure_of([&] { check_video_def(def); }).code;
    };
    constexpr ExitCode kOk = ExitCode::kOk;
    constexpr ExitCode kUsage = ExitCode::kUsage;
    EXPECT_EQ(code_with([](VideoDef&) {}), kOk);
    EXPECT_EQ(code_with([](VideoDef& d) { d.width_px = 16384, d.height_px = 4096; }), kOk);
    EXPECT_EQ(code_with([](VideoDef& d) { d.width_px = 16384, d.height_px = 4098; }), kUsage);
    EXPECT_EQ(code_with([](VideoDef& d) { d.width_px = 16386, d.height_px = 2; }), kUsage);
    EXPECT_EQ(code_with([](VideoDef& d) { d.width_px = 2, d.height_px = 2; }), kOk);
    EXPECT_EQ(code_with([](VideoDef& d) { d.height_px = 0; }), kUsage);
    EXPECT_EQ(code_with([](VideoDef& d) { d.height_px = -2; }), kUsage);
    EXPECT_EQ(code_with([](VideoDef& d) { d.height_px = std::numeric_limits<int>::max(); }), kUsage);
    EXPECT_EQ(code_with([](VideoDef& d) { d.fps = FrameRate({0, 1}); }), kUsage);
    EXPECT_EQ(code_with([](VideoDef& d) { d.fps = FrameRate({60, 0}); }), kUsage);
    EXPECT_EQ(code_with([](VideoDef& d) { d.fps = FrameRate({1'000'000'001, 1}); }), kUsage);
    EXPECT_EQ(code_with([](VideoDef& d) { d.encoder.threads = 64; }), kOk);
    EXPECT_EQ(code_with([](VideoDef& d) { d.encoder.threads = 65; }), kUsage);
    EXPECT_EQ(code_with([](VideoDef& d) { d.encoder.threads = 0; }), kUsage);
    EXPECT_EQ(code_with([](VideoDef& d) { d.encoder.crf = 1; }), kOk);
    EXPECT_EQ(code_with([](VideoDef& d) { d.encoder.crf = 51; }), kOk);
    EXPECT_EQ(code_with([](VideoDef& d) { d.encoder.crf = 52; }), kUsage);
    EXPECT_EQ(code_with([](VideoDef& d) { d.encoder.codec = ""; }), kUsage);
}

TEST(VideoDefs, OddSizesAreRefusedNamingTheEvenOnes) {
    VideoDef def;
    def.width_px = 1;
    def.height_px = 1081;
    const test::Failure failure = failure_of([&] { check_video_def(def); });
    EXPECT_EQ(failure.code, ExitCode::kUsage);
    EXPECT_THAT(failure.message, HasSubstr("width of 2 and a height of 1080 or 1082"));
}

}  // namespace
}  // namespace corda::media
