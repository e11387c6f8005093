// Every codec in every container that takes it, with and without transparency, at whole and other rates: read
// back by the programs ffprobe and ffmpeg.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <string_view>

#include "corda/media/format/format.hpp"
#include "support/command.hpp"
#include "support/decode_rgba.hpp"
#include "support/failure.hpp"
#include "support/probe.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

constexpr PixelChoice kAny = PixelChoice::kAuto;
constexpr PixelChoice k444 = PixelChoice::k444;

/// A row of the matrix.
struct Variant {
    const char* name;  ///< of the test
    const char* ending;
    const char* codec;  ///< empty: that of the ending
    PixelChoice pix;
    bool is_transparent;
    Rational fps;
    const char* coding;  ///< codec, profile and pixel format, by ffprobe
    const char* colors;  ///< range, matrix, primaries and transfer, by ffprobe
    /// The least PSNR of the decoded frames, alpha included, over black and over white; 0: they are equal.
    /// A comment has the measured one.
    double psnr_db;
};

void PrintTo(const Variant& variant, std::ostream* out) {
    *out << variant.name;
}

constexpr const char* kYuv = "tv bt709 bt709 iec61966-2-1";
constexpr const char* kNone = "unknown unknown unknown unknown";
constexpr const char* kRgb = "pc gbr bt709 iec61966-2-1";

constexpr std::array kVariants{
    // Measured PSNR: 33.4, 49.4, 33.3, 48.1, 33.4, 50.3, 33.4, 58.9, 50.4, 33.4, 33.4, 80.9, 55.5.
    Variant{"h264", ".mp4", "", kAny, false, {30000, 1001}, "h264 High yuv420p", kYuv, 33.0},
    Variant{
        "h264_444", ".mp4", "h264", k444, false, {50, 1}, "h264 High 4:4:4 Predictive yuv444p", kYuv, 48.0},
    Variant{"h265", ".mp4", "h265", kAny, false, {24000, 1001}, "hevc Main yuv420p", kYuv, 33.0},
    Variant{"h265_444", ".mp4", "h265", k444, false, {7, 3}, "hevc Rext yuv444p", kYuv, 47.0},
    Variant{"av1", ".mp4", "libsvtav1", kAny, false, {30, 1}, "av1 Main yuv420p", kYuv, 33.0},
    Variant{"aom_444", ".mp4", "libaom-av1", k444, false, {25, 1}, "av1 High yuv444p", kYuv, 49.0},
    Variant{"vp9", ".webm", "", kAny, false, {30000, 1001}, "vp9 Profile 0 yuv420p", kYuv, 33.0},
    // By libavcodec's own decoder, which leaves alpha out.
    Variant{"vp9_alpha", ".webm", "", kAny, true, {60, 1}, "vp9 Profile 0 yuv420p", kYuv, 58.0},
    Variant{"vp9_444", ".webm", "", k444, false, {24, 1}, "vp9 Profile 1 yuv444p", kYuv, 49.0},
    Variant{"av1_webm", ".webm", "av1", kAny, false, {24000, 1001}, "av1 Main yuv420p", kYuv, 33.0},
    Variant{"aom_webm", ".webm", "libaom-av1", kAny, false, {50, 1}, "av1 Main yuv420p", kYuv, 33.0},
    Variant{"prores", ".mov", "", kAny, false, {24000, 1001}, "prores 4444 yuv444p12le", kYuv, 80.0},
    Variant{"prores_alpha", ".mov", "", kAny, true, {50, 1}, "prores 4444 yuva444p12le", kYuv, 55.0},
    Variant{"ffv1", ".mkv", "", kAny, false, {30000, 1001}, "ffv1 unknown bgr0", kRgb, 0.0},
    Variant{"ffv1_alpha", ".mkv", "", kAny, true, {1, 2}, "ffv1 unknown bgra", kRgb, 0.0},
    Variant{"gif", ".gif", "", kAny, false, {30000, 1001}, "gif unknown bgra", kNone, 0.0},
};

/// More than encoders hold back.
constexpr int kVideoFrames = 14;

/// A moving square on a ground with a half transparent strip, or on an opaque one.
Image picture_of(std::int64_t k, bool is_transparent) {
    Image image = frame_image(k);
    if (!is_transparent) return image;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            std::uint8_t* const p = image.pixel(x, y);
            const bool is_ground = p[0] == 18 && p[1] == 22 && p[2] == 30;
            if (is_ground) p[3] = y < 140 ? 0 : 128;
        }
    }
    return image;
}

VideoDef def_of(const Variant& variant) {
    VideoDef def = small_video(variant.fps);
    def.encoder.codec = variant.codec;
    def.encoder.pix = variant.pix;
    if (std::string_view(variant.codec) == "libaom-av1") def.encoder.preset = "8";
    if (std::string_view(variant.codec).find("av1") != std::string_view::npos && def.encoder.preset.empty())
        def.encoder.preset = "12";
    return def;
}

/// PSNR of the colours that show over a ground of this grey.
double psnr_over(int grey, const Image& a, const Image& b) {
    double squares = 0.0;
    for (std::size_t i = 0; i < a.size_bytes(); i += 4) {
        const auto over = [grey, i](const Image& image, int c) {
            const double alpha = image.data()[i + 3] / 255.0;
            return image.data()[i + c] * alpha + grey * (1.0 - alpha);
        };
        for (int c = 0; c < 3; ++c) squares += std::pow(over(a, c) - over(b, c), 2.0);
    }
    const double mean = squares / (static_cast<double>(a.size_bytes()) * 0.75);
    return mean == 0.0 ? 1000.0 : 10.0 * std::log10(255.0 * 255.0 / mean);
}

class EveryFormat : public testing::TestWithParam<Variant> {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const {
        return folder_.file(name + GetParam().ending);
    }
    void make(const std::string& path) const {
        VideoWriter writer(path, def_of(GetParam()), kVideoFrames, GetParam().is_transparent);
        for (std::int64_t k = 0; k < kVideoFrames; ++k)
            writer.write_whole(picture_of(k, GetParam().is_transparent));
        writer.finish();
    }
    test::ScratchFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Of, EveryFormat, testing::ValuesIn(kVariants),
                         [](const auto& variant) { return std::string(variant.param.name); });

TEST_P(EveryFormat, HasItsCodecItsTagsAndAllFrames) {
    make(file("a"));
    const test::VideoFacts video = test::probe(file("a"));
    EXPECT_EQ(video.codec + " " + video.profile + " " + video.pixel_format, GetParam().coding);
    EXPECT_EQ(video.colors, GetParam().colors);
    EXPECT_EQ(video.width_px, kWidth);
    EXPECT_EQ(video.height_px, kHeight);
    EXPECT_EQ(video.frames, kVideoFrames);
    EXPECT_NEAR(video.duration_s, kVideoFrames / GetParam().fps.value(), video.tick_s + 1e-6);
    // Containers that count milliseconds or hundredths of a second round; MP4 and QuickTime are exact.
    const bool is_exact =
        GetParam().ending == std::string_view(".mp4") || GetParam().ending == std::string_view(".mov");
    if (is_exact) {
        EXPECT_EQ(video.tick_s, 1.0 / static_cast<double>(GetParam().fps.num));
        const std::string bytes = test::read_file(file("a"));
        EXPECT_LT(bytes.find("moov"), bytes.find("mdat"));  // a browser starts to play at once
    }
    if (video.pixel_format == "yuv420p" && (video.codec == "h264" || video.codec == "hevc")) {
        EXPECT_EQ(video.chroma_location, "left");
    }
}

TEST_P(EveryFormat, ShowsWhatWasDrawnWhenItWas) {
    make(file("a"));
    const test::DecodedRgba video = test::decode_rgba(file("a"));
    const double tick_s = test::probe(file("a")).tick_s;
    ASSERT_EQ(video.pictures.size(), std::size_t{kVideoFrames});
    for (std::size_t k = 0; k < video.pictures.size(); ++k) {
        EXPECT_NEAR(video.times_s[k], static_cast<double>(k) / GetParam().fps.value(), 0.5 * tick_s + 1e-6)
            << k;
        const Image drawn = picture_of(static_cast<std::int64_t>(k), GetParam().is_transparent);
        if (GetParam().psnr_db == 0.0) {
            EXPECT_EQ(video.pictures[k], drawn) << k;
            continue;
        }
        for (const int grey : {0, 255})
            EXPECT_GE(psnr_over(grey, video.pictures[k], drawn), GetParam().psnr_db) << k << " over " << grey;
    }
}

TEST_P(EveryFormat, HasTheSameBytesFromFramesOfSeveralMakers) {
    make(file("a"));
    const CheckedVideo video = check_video_output(
        {.path = file("b"), .def = def_of(GetParam()), .end = kVideoFrames}, "", GetParam().is_transparent);
    VideoFile output(video, {"A swing", R"({"scene":"test"})"});
    FrameMaker even(video.format, 0, {});
    FrameMaker odd(video.format, 0, {});
    constexpr std::int64_t kBlock = 3;
    for (std::int64_t k = 0; k < kVideoFrames; ++k) {
        const Image image = picture_of(k, GetParam().is_transparent);
        output.add((k / kBlock % 2 == 0 ? even : odd).make(k, image, {image.rect()}));
    }
    output.commit();
    EXPECT_TRUE(test::read_file(file("a")) == test::read_file(file("b")));
}

TEST_F(Video, OneFrameIsAVideo) {
    for (const char* const ending : {".mp4", ".mov", ".webm", ".mkv", ".gif"}) {
        const std::string path = file(std::string("a") + ending);
        EXPECT_NO_THROW(make_video(path, small_video({25, 1}), 1)) << path;
        EXPECT_EQ(test::probe(path).frames, 1) << path;
        EXPECT_NEAR(test::probe(path).duration_s, 0.04, 1e-6) << path;
    }
}

/// The delays of the frames of a GIF, in hundredths of a second.
std::vector<int> delays_of(const std::string& gif) {
    constexpr std::string_view kControl = "\x21\xf9\x04";  // GIF89a, 23
    std::vector<int> delays;
    for (std::size_t at = gif.find(kControl); at != std::string::npos; at = gif.find(kControl, at + 8)) {
        if (gif.at(at + 7) != 0) continue;  // other bytes by chance
        delays.push_back(static_cast<unsigned char>(gif[at + 4]) +
                         256 * static_cast<unsigned char>(gif[at + 5]));
    }
    return delays;
}

TEST_F(Video, AGifOfAnyRateHasDelaysThatAddUpExactly) {
    constexpr std::int64_t kFrames = 25;
    for (const Rational rate : {Rational{24, 1}, Rational{30, 1}, Rational{30000, 1001}, Rational{50, 1}}) {
        make_video(file("a.gif"), small_video(rate), kFrames);
        const std::vector<int> delays = delays_of(test::read_file(file("a.gif")));
        ASSERT_EQ(delays.size(), kFrames) << rate.text();
        std::int64_t end = 0;
        for (std::int64_t k = 1; k <= kFrames; ++k) {
            end += delays[static_cast<std::size_t>(k - 1)];
            EXPECT_EQ(end, std::llround(100.0 * static_cast<double>(k) / rate.value())) << rate.text() << k;
        }
    }
}

TEST_F(Video, AnAnimationPlaysAsOftenAsAsked) {
    const auto bytes_of = [&](const char* ending, int loop) {
        VideoDef def = small_video({25, 1});
        def.loop = loop;
        make_video(file(std::string("a") + ending), def, 3);
        return test::read_file(file(std::string("a") + ending));
    };
    using namespace std::string_literals;
    const auto has = [](const std::string& bytes, const std::string& part) {
        return bytes.find(part) != std::string::npos;
    };
    EXPECT_TRUE(has(bytes_of(".gif", 0), "NETSCAPE2.0\x03\x01\0\0"s));
    EXPECT_TRUE(has(bytes_of(".gif", 3), "NETSCAPE2.0\x03\x01\x02\0"s));  // repetitions
    EXPECT_FALSE(has(bytes_of(".gif", 1), "NETSCAPE2.0"));
    EXPECT_EQ(test::code_of([&] { std::ignore = bytes_of(".mp4", 3); }),
              ExitCode::kUsage);  // it says nothing of that
}

TEST_F(Video, AGifOfManyColoursHasTheNearest) {
    const auto colourful = [](std::int64_t k) {
        Image image(kWidth, kHeight);
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                std::uint8_t* const p = image.pixel(x, y);
                p[0] = static_cast<std::uint8_t>(x * 255 / kWidth);
                p[1] = static_cast<std::uint8_t>(y * 255 / kHeight);
                p[2] = static_cast<std::uint8_t>(40 * k);
                p[3] = 255;
            }
        }
        return image;
    };
    VideoWriter writer(file("a.gif"), small_video({50, 1}), 5);
    for (std::int64_t k = 0; k < 5; ++k) writer.write_whole(colourful(k));
    writer.finish();
    const test::DecodedRgba video = test::decode_rgba(file("a.gif"));
    ASSERT_EQ(video.pictures.size(), 5U);
    for (std::int64_t k = 0; k < 5; ++k)
        EXPECT_GT(psnr_over(0, video.pictures[static_cast<std::size_t>(k)], colourful(k)), 25.0) << k;
}

TEST_F(Video, AGifOnATransparentGroundShowsItThroughEveryFrame) {
    const auto cut_out = [](std::int64_t k) {
        Image image(kWidth, kHeight);
        fill(image, bob(k), {240, 200, 90});
        return image;
    };
    VideoWriter writer(file("a.gif"), small_video({50, 1}), 6, true);
    for (std::int64_t k = 0; k < 6; ++k) writer.write_whole(cut_out(k));
    writer.finish();
    const test::DecodedRgba video = test::decode_rgba(file("a.gif"));
    ASSERT_EQ(video.pictures.size(), 6U);
    for (std::int64_t k = 0; k < 6; ++k) {
        const Image& decoded = video.pictures[static_cast<std::size_t>(k)];
        for (const int grey : {0, 255}) EXPECT_EQ(psnr_over(grey, decoded, cut_out(k)), 1000.0) << k;
    }
}

TEST_F(Video, AGifHasNoColourToCompareWhereItIsTransparent) {
    Image image = frame_image(0);
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)  // also within a patch
            image.pixel(x, y)[3] = static_cast<std::uint8_t>(std::clamp(2 * (y - 20), 0, 255));
    VideoWriter writer(file("a.gif"), small_video({50, 1}), 2, true);
    for (int k = 0; k < 2; ++k) writer.write_whole(image);
    EXPECT_NO_THROW(writer.finish());
}

}  // namespace
}  // namespace corda::media
