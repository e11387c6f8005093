#include "corda/media/format/format.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
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

/// A video of 320x180 at 50 fps by this encoder and of these pixels.
VideoDef encoded_by(const std::string& codec, PixelChoice pix = PixelChoice::kAuto) {
    VideoDef def;
    def.width_px = 320;
    def.height_px = 180;
    def.fps = FrameRate({50, 1});
    def.encoder.codec = codec;
    def.encoder.pix = pix;
    return def;
}

TEST(Formats, AreNamedAsLibavNamesThem) {
    for (const Ending& ending : endings()) {
        EXPECT_TRUE(*ending.muxer == '\0' || av_guess_format(ending.muxer, nullptr, nullptr) != nullptr)
            << ending.muxer;
        for (const char* const codec : ending.codecs)
            EXPECT_TRUE(codec == nullptr || find_codec(codec) != nullptr) << codec;
    }
    for (const Codec& codec : codecs()) {
        EXPECT_TRUE(codec.is_built_in || avcodec_find_encoder_by_name(codec.name) != nullptr) << codec.name;
        EXPECT_NE(avcodec_descriptor_get_by_name(codec.stream), nullptr) << codec.name;
        for (const char* const format : codec.pixel_formats)
            EXPECT_TRUE(format == nullptr || av_get_pix_fmt(format) != AV_PIX_FMT_NONE) << format;
    }
}

TEST(Formats, TheAdvisedPackageIsOneOfThisRelease) {
    EXPECT_TRUE(std::filesystem::exists("/usr/share/doc/" + libavcodec_package())) << libavcodec_package();
}

TEST(Formats, AreFoundByTheEndingOfAName) {
    EXPECT_STREQ(find_ending("some.folder/a.b.mp4").muxer, "mp4");
    EXPECT_STREQ(find_ending("a.webm").muxer, "webm");
    EXPECT_EQ(find_ending("frames/%04d.png").kind, FileKind::kPictures);
    EXPECT_EQ(find_ending("-").kind, FileKind::kStream);
    EXPECT_EQ(find_ending("/dev/stdout").kind, FileKind::kStream);
}

TEST(Formats, TheEndingChoosesTheCodecAndTheGroundThePixels) {
    struct Case {
        const char* path;
        const char* codec;
        const char* opaque;
        const char* transparent;
    };
    for (const Case& wanted :
         {Case{"a.mp4", "libx264", "yuv420p", "yuv420p"}, Case{"a.webm", "libvpx-vp9", "yuv420p", "yuva420p"},
          Case{"a.mov", "prores_ks", "yuv444p10le", "yuva444p10le"}, Case{"a.mkv", "ffv1", "bgr0", "bgra"},
          Case{"a.gif", "gif", "rgba", "rgba"}, Case{"%d.png", "png", "rgba", "rgba"},
          Case{"-", "rawvideo", "yuv420p", "rgba"}}) {
        for (const bool is_transparent : {false, true}) {
            const Format format = find_format(wanted.path, encoded_by(""), is_transparent);
            EXPECT_STREQ(format.codec->name, wanted.codec) << wanted.path;
            EXPECT_STREQ(format.pixel_format, is_transparent ? wanted.transparent : wanted.opaque)
                << wanted.path;
            EXPECT_FALSE(format.is_fallback) << wanted.path;
        }
    }
}

TEST(Formats, ShortNamesStandForAnEncoderThatHasThePixels) {
    const auto codec_of = [](const char* path, const VideoDef& def) {
        return std::string(find_format(path, def).codec->name);
    };
    EXPECT_EQ(codec_of("a.mp4", encoded_by("h264")), "libx264");
    EXPECT_EQ(codec_of("a.mp4", encoded_by("h265")), "libx265");
    EXPECT_EQ(codec_of("a.mp4", encoded_by("av1")), "libsvtav1");
    EXPECT_EQ(codec_of("a.mp4", encoded_by("av1", PixelChoice::k444)), "libaom-av1");
    EXPECT_EQ(codec_of("a.webm", encoded_by("vp9", PixelChoice::k444)), "libvpx-vp9");
    EXPECT_STREQ(find_format("a.mp4", encoded_by("h264", PixelChoice::k444)).pixel_format, "yuv444p");
}

TEST(Formats, UnknownOnesAreRefusedNamingTheKnown) {
    for (const char* const name : {"a.avi", "a", "a.mp4.part", "mp4", ".mp4", "a.mp4/b", ""}) {
        const test::Failure failure = failure_of([&] { static_cast<void>(find_ending(name)); });
        EXPECT_EQ(failure.code, ExitCode::kUsage) << name;
        EXPECT_THAT(failure.message, HasSubstr("use .mp4, .webm, .mov, .mkv, .gif, %04d.png, -")) << name;
    }
    for (const char* const name : {"a.png", "%04d%d.png", "%4d.png", "%s.png", "%d/a.png", "%00d.png"}) {
        const test::Failure failure = failure_of([&] { static_cast<void>(find_ending(name)); });
        EXPECT_EQ(failure.code, ExitCode::kUsage) << name;
        EXPECT_THAT(failure.message, HasSubstr("frames/%04d.png")) << name;
    }
    const test::Failure failure =
        failure_of([] { static_cast<void>(find_format("a.mp4", encoded_by("libvpx-vp9"))); });
    EXPECT_EQ(failure.code, ExitCode::kUsage);
    EXPECT_THAT(failure.message, HasSubstr("cannot hold the codec 'libvpx-vp9'; use libx264"));
}

TEST(Formats, RatesThatAContainerCannotCountAreRefused) {
    const auto message_for = [](const char* path, Rational fps) {
        VideoDef def = encoded_by("");
        def.fps = FrameRate(fps);
        return failure_of([&] { static_cast<void>(find_format(path, def)); }).message;
    };
    for (const Rational rate :
         {Rational{50, 1}, Rational{100, 3}, Rational{30000, 1001}, Rational{24, 1}, Rational{1, 10}})
        EXPECT_EQ(message_for("a.gif", rate), "") << rate.text();
    EXPECT_THAT(message_for("a.gif", {60, 1}), HasSubstr("use 50 (--fps 50)"));
    EXPECT_THAT(message_for("a.gif", {100, 1}), HasSubstr("use 50 (--fps 50)"));
    EXPECT_THAT(message_for("a.gif", {1, 1000}), HasSubstr("use 20/13107 (--fps 20/13107)"));
    EXPECT_THAT(message_for("a.webm", {2000, 1}), HasSubstr("use 1000 or less"));
    for (const char* const path : {"a.mp4", "a.mov", "a.webm", "a.mkv", "-", "%d.png"})
        EXPECT_EQ(message_for(path, {30000, 1001}) + message_for(path, {24000, 1001}), "") << path;
}

TEST(Formats, QualityIsCheckedForTheEncoderThatIsMeant) {
    const auto message_for = [](const char* path, const char* codec, void (*change)(EncoderDef&)) {
        VideoDef def = encoded_by(codec);
        change(def.encoder);
        return failure_of([&] { static_cast<void>(find_format(path, def)); }).message;
    };
    constexpr auto kCrf52 = [](EncoderDef& def) { def.crf = 52; };
    constexpr auto kSlow = [](EncoderDef& def) { def.preset = "slow"; };
    EXPECT_THAT(message_for("a.mp4", "", kCrf52),
                HasSubstr("crf 52 is out of range; use 1 to 51 for libx264"));
    EXPECT_EQ(message_for("a.mp4", "av1", kCrf52), "");
    EXPECT_THAT(message_for("a.mov", "", kCrf52), HasSubstr("leave it out"));
    EXPECT_EQ(message_for("a.mp4", "", kSlow), "");
    EXPECT_THAT(message_for("a.webm", "", kSlow), HasSubstr("use one of 0, 1, 2, 3, 4, 5, 6, 7, 8"));
    EXPECT_THAT(message_for("a.gif", "", kSlow), HasSubstr("has no presets; leave it out"));
}

TEST(VideoDefs, OfEveryFieldTheBoundsAreChecked) {
    const auto code_with = [](void (*change)(VideoDef&)) {
        VideoDef def;
        change(def);
        return failure_of([&] {
                   check_video_def(def);
                   static_cast<void>(find_format("a.mp4", def));
               })
            .code;
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
    EXPECT_EQ(code_with([](VideoDef& d) { d.encoder.codec = "h266"; }), kUsage);
}

TEST(VideoDefs, OddSizesAreRefusedNamingTheEvenOnes) {
    VideoDef def;
    def.width_px = 1;
    def.height_px = 1081;
    const test::Failure failure = failure_of([&] { static_cast<void>(find_format("a.mp4", def)); });
    EXPECT_EQ(failure.code, ExitCode::kUsage);
    EXPECT_THAT(failure.message, HasSubstr("width of 2 and a height of 1080 or 1082"));
    EXPECT_EQ(failure_of([&] { static_cast<void>(find_format("a.mov", def)); }).code, ExitCode::kOk);
}

TEST(VideoDefs, SizesThatAFormatCannotHaveAreRefusedNamingItsLimit) {
    const auto refusal = [](const char* path, int width_px, int height_px, const char* codec = "") {
        VideoDef def;
        def.width_px = width_px;
        def.height_px = height_px;
        def.fps = FrameRate({25, 1});
        def.encoder.codec = codec;
        return failure_of([&] { static_cast<void>(find_format(path, def)); }).message;
    };
    for (const auto& [width_px, height_px] : {std::pair{1, 1}, {1, 2}, {2, 1}, {16, 1}}) {
        EXPECT_THAT(refusal("a.mkv", width_px, height_px), HasSubstr("use sides of 2 or more, or another"));
        for (const char* const path : {"a.mov", "a.gif", "%04d.png"})
            EXPECT_EQ(refusal(path, width_px, height_px), "") << path;
    }
    EXPECT_EQ(refusal("a.mkv", 2, 2), "");
    EXPECT_EQ(refusal("a.gif", 16384, 2), "");
    EXPECT_THAT(refusal("a.mp4", 64, 8706, "libsvtav1"), HasSubstr("use a height of 8704 or less"));
    EXPECT_EQ(refusal("a.mp4", 16384, 64, "libsvtav1"), "");
    EXPECT_EQ(refusal("a.mp4", 64, 16384, "libaom-av1"), "");
}

}  // namespace
}  // namespace corda::media
