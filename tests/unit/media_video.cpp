#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "corda/core/error.hpp"
#include "corda/media/mp4_remux.hpp"
#include "corda/media/png.hpp"
#include "corda/media/verify.hpp"
#include "corda/media/video_writer.hpp"
#include "corda/media/yuv420.hpp"
#include "support/command.hpp"
#include "support/decode_video.hpp"

namespace corda::media {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kWidth = 320;
constexpr int kHeight = 180;

class Video : public testing::Test {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

    test::ScratchFolder folder_;
};

void fill(Image& image, const PixelRect& rect, std::array<std::uint8_t, 3> rgb) {
    const PixelRect inside = rect.intersected(image.rect());
    for (int y = inside.y0; y < inside.y1; ++y) {
        for (int x = inside.x0; x < inside.x1; ++x) {
            std::copy(rgb.begin(), rgb.end(), image.pixel(x, y));
            image.pixel(x, y)[3] = 255;
        }
    }
}

struct Patch {
    PixelRect rect;
    std::array<std::uint8_t, 3> rgb{};
};
const std::array<Patch, 4> patches{{{{16, 16, 64, 64}, {255, 0, 0}},
                                    {{80, 16, 128, 64}, {0, 255, 0}},
                                    {{144, 16, 192, 64}, {0, 0, 255}},
                                    {{208, 16, 256, 64}, {128, 128, 128}}}};

Image background() {
    Image image(kWidth, kHeight);
    fill(image, image.rect(), {18, 22, 30});
    for (const Patch& patch : patches) fill(image, patch.rect, patch.rgb);
    return image;
}

PixelRect bob(std::int64_t frame) {
    const int x = 140 + static_cast<int>(std::lround(100 * std::sin(static_cast<double>(frame) * 0.2)));
    return {x, 100, x + 21, 121};
}

Image frame_image(std::int64_t frame) {
    Image image = background();
    fill(image, bob(frame), {240, 200, 90});
    return image;
}

VideoDef small_video(Rational fps = {60, 1}) {
    VideoDef def;
    def.width_px = kWidth;
    def.height_px = kHeight;
    def.fps = FrameRate(fps);
    return def;
}

void write_frames(VideoWriter& writer, std::int64_t frames) {
    for (std::int64_t k = 0; k < frames; ++k) {
        writer.write(frame_image(k), k == 0 ? PixelRect{0, 0, kWidth, kHeight} : bob(k).united(bob(k - 1)));
    }
}

void make_video(const std::string& path, const VideoDef& def, std::int64_t frames) {
    VideoWriter writer(path, def, {"A swing", R"({"scene":"test"})"});
    write_frames(writer, frames);
    EXPECT_EQ(writer.frames(), frames);
    writer.finish();
}

std::string all_problems(const VerifyReport& report) {
    std::string text;
    for (const auto& line : report.problems) text += line + "\n";
    return text;
}

double luma_psnr(const Yuv420Image& a, const Yuv420Image& b) {
    double sum = 0.0;
    const int count = a.width() * a.height();
    for (int i = 0; i < count; ++i) {
        const double difference = static_cast<double>(a.plane(0)[i]) - b.plane(0)[i];
        sum += difference * difference;
    }
    return 10.0 * std::log10(255.0 * 255.0 * count / std::max(sum, 1e-9));
}

/// R'G'B' of the mean of the middle 16x16 pixels of a patch.
std::array<double, 3> shown_color(const Yuv420Image& picture, const PixelRect& rect) {
    std::array<double, 3> mean{};
    for (int plane = 0; plane < 3; ++plane) {
        const int scale = plane == 0 ? 1 : 2;
        const int x0 = (rect.x0 + 16) / scale;
        const int y0 = (rect.y0 + 16) / scale;
        const int side = 16 / scale;
        for (int y = y0; y < y0 + side; ++y) {
            for (int x = x0; x < x0 + side; ++x) {
                mean[plane] += picture.plane(plane)[y * picture.plane_width(plane) + x] / double(side * side);
            }
        }
    }
    const double y = (mean[0] - 16) / 219;
    const double cb = (mean[1] - 128) / 224;
    const double cr = (mean[2] - 128) / 224;
    const double r = y + 1.5748 * cr;
    const double b = y + 1.8556 * cb;
    return {255 * r, 255 * (y - 0.2126 * r - 0.0722 * b) / 0.7152, 255 * b};
}

class VideoRates : public Video, public testing::WithParamInterface<Rational> {};

TEST_P(VideoRates, StampsAndDurationsAreExact) {
    const Rational fps = GetParam();
    make_video(file("a.mp4"), small_video(fps), 60);
    const auto video = test::decode_video(file("a.mp4"));
    ASSERT_EQ(video.pts.size(), 60U);
    EXPECT_EQ(video.tick_num, 1);
    EXPECT_EQ(video.tick_den, fps.num);
    for (std::int64_t k = 0; k < 60; ++k) EXPECT_EQ(video.pts[static_cast<std::size_t>(k)], k * fps.den);
    EXPECT_EQ(video.stream_duration, 60 * fps.den);
    // libav reports the container's duration in whole microseconds.
    EXPECT_NEAR(static_cast<double>(video.container_duration_us), 60e6 / fps.value(), 1.0);
    const VerifyReport report = verify(file("a.mp4"));
    EXPECT_TRUE(report.ok()) << all_problems(report);
    EXPECT_EQ(report.fps, fps);
    EXPECT_EQ(report.duration_s, Rational::reduced(60 * fps.den, fps.num));
    EXPECT_FALSE(fs::exists(file("a.mp4.part")));
    EXPECT_FALSE(fs::exists(file("a.mp4.tmp")));
}

INSTANTIATE_TEST_SUITE_P(All, VideoRates,
                         testing::Values(Rational{60, 1}, Rational{30000, 1001}, Rational{24000, 1001},
                                         Rational{1, 2}, Rational{7, 3}, Rational{1000, 1}, Rational{25, 1}));

TEST_F(Video, ColorsComeBack) {
    make_video(file("a.mp4"), small_video(), 60);
    const auto video = test::decode_video(file("a.mp4"));
    EXPECT_EQ(video.range, 1);            // AVCOL_RANGE_MPEG
    EXPECT_EQ(video.matrix, 1);           // BT.709
    EXPECT_EQ(video.primaries, 1);        // BT.709
    EXPECT_EQ(video.transfer, 13);        // IEC 61966-2-1
    EXPECT_EQ(video.chroma_location, 1);  // left
    double worst = 0.0;
    for (const Patch& patch : patches) {
        const auto rgb = shown_color(video.pictures[0], patch.rect);
        for (int c = 0; c < 3; ++c)
            worst = std::max(worst, std::abs(std::clamp(rgb[c], 0.0, 255.0) - patch.rgb[c]));
    }
    RecordProperty("worst", std::to_string(worst));
    EXPECT_LE(worst, 2.0);  // measured 1.14
    const Image first = frame_image(0);
    Yuv420Image want(kWidth, kHeight);
    convert_to_yuv420(first, first.rect(), want);
    const double psnr = luma_psnr(video.pictures[0], want);
    RecordProperty("psnr", std::to_string(psnr));
    EXPECT_GE(psnr, 40.0);  // measured 64
}

TEST_F(Video, DamagedFramesEqualWholeOnes) {
    make_video(file("a.mp4"), small_video(), 30);
    {
        VideoWriter writer(file("b.mp4"), small_video(), {"A swing", R"({"scene":"test"})"});
        for (int k = 0; k < 30; ++k) writer.write(frame_image(k), {0, 0, kWidth, kHeight});
        writer.finish();
    }
    EXPECT_EQ(test::read_file(file("a.mp4")), test::read_file(file("b.mp4")));
}

TEST_F(Video, TheFirstFrameIsTakenWholeAndAnEmptyDamageRepeatsIt) {
    for (const PixelRect damage : {PixelRect{0, 0, kWidth, kHeight}, PixelRect{}}) {
        VideoWriter writer(file(damage.empty() ? "b.mp4" : "a.mp4"), small_video(), {});
        for (int k = 0; k < 5; ++k) writer.write(frame_image(0), damage);
        writer.finish();
    }
    EXPECT_EQ(test::read_file(file("a.mp4")), test::read_file(file("b.mp4")));
}

TEST_F(Video, SameBytesOnTwoRuns) {
    make_video(file("a.mp4"), small_video(), 60);
    make_video(file("b.mp4"), small_video(), 60);
    EXPECT_EQ(test::read_file(file("a.mp4")), test::read_file(file("b.mp4")));
}

TEST_F(Video, OneFrame) {
    make_video(file("a.mp4"), small_video({30000, 1001}), 1);
    VerifyReport report = verify(file("a.mp4"));
    EXPECT_TRUE(report.ok()) << all_problems(report);
    EXPECT_EQ(report.frames, 1);
    EXPECT_EQ(report.duration_s, (Rational{1001, 30000}));
    make_video(file("slow.mp4"), small_video({1, 2}), 1);
    report = verify(file("slow.mp4"));
    EXPECT_TRUE(report.ok()) << all_problems(report);
    EXPECT_EQ(report.duration_s, (Rational{2, 1}));
}

TEST_F(Video, EveryPresetAndExtremeRateFactorsPassTheirOwnCheck) {
    for (const std::string& preset : x264_presets()) {
        if (preset == "placebo") continue;
        VideoDef def = small_video();
        def.encoder.preset = preset;
        EXPECT_NO_THROW(make_video(file(preset + ".mp4"), def, 8)) << preset;
    }
    for (const int crf : {1, 10, 23, 30, 35, 40, 45, 51}) {
        for (const char* preset : {"ultrafast", "veryfast", "medium"}) {
            VideoDef def = small_video();
            def.encoder.crf = crf;
            def.encoder.preset = preset;
            EXPECT_NO_THROW(make_video(file("crf.mp4"), def, 8)) << crf << " " << preset;
        }
    }
}

TEST_F(Video, SmallestSize) {
    VideoDef def = small_video();
    def.width_px = 2;
    def.height_px = 2;
    VideoWriter writer(file("a.mp4"), def, {});
    Image image(2, 2);
    writer.write(image, image.rect());
    writer.finish();
    EXPECT_TRUE(verify(file("a.mp4")).ok());
}

TEST_F(Video, AbandonLeavesAPlayablePart) {
    {
        VideoWriter writer(file("a.mp4"), small_video({24000, 1001}), {"A swing", "{}"});
        write_frames(writer, 60);
        EXPECT_EQ(writer.abandon(), file("a.mp4.part"));
    }
    EXPECT_FALSE(fs::exists(file("a.mp4")));
    const auto video = test::decode_video(file("a.mp4.part"));
    ASSERT_EQ(video.pts.size(), 60U);
    for (std::int64_t k = 0; k < 60; ++k) EXPECT_EQ(video.pts[static_cast<std::size_t>(k)], k * 1001);
    EXPECT_THAT(all_problems(verify(file("a.mp4.part"))), HasSubstr("fragments"));

    const RemuxResult result = recover_part(file("a.mp4.part"), file("a.mp4"));
    EXPECT_EQ(result.frames, 60);
    EXPECT_FALSE(result.truncated);
    EXPECT_TRUE(verify(file("a.mp4")).ok());
    EXPECT_FALSE(fs::exists(file("a.mp4.part")));
}

TEST_F(Video, ATornPartLosesOnlyItsLastFragment) {
    constexpr int kFrames = 100;
    VideoDef def = small_video({10, 1});  // a key frame every 20 frames
    {
        VideoWriter writer(file("a.mp4"), def, {});
        write_frames(writer, kFrames);
        writer.abandon();
    }
    const std::string whole = test::read_file(file("a.mp4.part"));
    const std::size_t last_fragment = whole.rfind("mdat");
    test::write_file(file("b.part"), whole.substr(0, last_fragment + 40));
    const RemuxResult torn = recover_part(file("b.part"), file("b.mp4"));
    EXPECT_TRUE(torn.truncated);
    EXPECT_EQ(torn.frames, 80);
    EXPECT_TRUE(verify(file("b.mp4")).ok()) << all_problems(verify(file("b.mp4")));
    const std::size_t second_fragment = whole.find("moof", whole.find("moof") + 4);
    // Wherever it is cut: whole fragments, or nothing at all.
    for (std::size_t length = 0; length < whole.size(); length += 61) {
        test::write_file(file("b.part"), whole.substr(0, length));
        try {
            const auto frames = recover_part(file("b.part"), file("b.mp4")).frames;
            ASSERT_EQ(frames % 20, 0) << length;
        } catch (const Error& error) {
            ASSERT_EQ(error.code(), ExitCode::kMismatch) << length << " " << error.what();
            ASSERT_LT(length, second_fragment) << error.what();
        }
    }
}

TEST_F(Video, FragmentsReachTheDiskWhileItRuns) {
    VideoDef def = small_video({10, 1});
    VideoWriter writer(file("a.mp4"), def, {});
    write_frames(writer, 150);
    // The encoder looks 50 odd frames ahead; all earlier fragments must be there. Nothing was closed.
    fs::copy_file(file("a.mp4.part"), file("killed.part"));
    EXPECT_GE(recover_part(file("killed.part"), file("killed.mp4")).frames, 60);
}

void expect_refused(const VideoDef& def, ExitCode code, const std::string& words, const std::string& path) {
    try {
        const VideoWriter writer(path, def, {});
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code);
        EXPECT_THAT(error.what(), HasSubstr(words));
    }
    EXPECT_FALSE(fs::exists(path));
    EXPECT_FALSE(fs::exists(path + ".part"));
}

TEST_F(Video, RefusesBadSettingsBeforeAnyFile) {
    VideoDef def = small_video();
    def.width_px = 321;
    expect_refused(def, ExitCode::kUsage, "320 or 322", file("a.mp4"));
    def = small_video();
    def.width_px = 0;
    expect_refused(def, ExitCode::kUsage, "out of range", file("a.mp4"));
    def = small_video();
    def.encoder.preset = "swift";
    expect_refused(def, ExitCode::kUsage, "veryfast", file("a.mp4"));
    def = small_video();
    def.encoder.codec = "h263";
    expect_refused(def, ExitCode::kUsage, "libx264", file("a.mp4"));
    def = small_video();
    def.encoder.crf = 0;
    expect_refused(def, ExitCode::kUsage, "crf 0", file("a.mp4"));
    def = small_video();
    def.encoder.threads = 0;
    expect_refused(def, ExitCode::kUsage, "threads", file("a.mp4"));
    expect_refused(small_video(), ExitCode::kIo, "No such file", file("no/folder/a.mp4"));
}

TEST_F(Video, NoFramesIsAnErrorAndLeavesNothing) {
    {
        VideoWriter writer(file("a.mp4"), small_video(), {});
        EXPECT_THROW(writer.finish(), Error);
    }
    EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(Video, AFullDiskIsAnIoError) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
    fs::create_symlink("/dev/full", file("a.mp4.part"));
    try {
        VideoWriter writer(file("a.mp4"), small_video(), {});
        write_frames(writer, 60);
        writer.finish();
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kIo);
        EXPECT_THAT(error.what(), HasSubstr("No space left"));
        EXPECT_THAT(error.what(), HasSubstr("free some space"));
    }
    EXPECT_FALSE(fs::exists(file("a.mp4")));
}

TEST_F(Video, VerifyFindsATruncatedFile) {
    make_video(file("a.mp4"), small_video(), 60);
    const std::string whole = test::read_file(file("a.mp4"));
    for (std::size_t length = 0; length < whole.size(); length += whole.size() / 40 + 1) {
        test::write_file(file("b.mp4"), whole.substr(0, length));
        EXPECT_FALSE(verify(file("b.mp4")).ok()) << length;
    }
    test::write_file(file("b.mp4"), whole.substr(0, whole.size() - 1));
    EXPECT_THAT(all_problems(verify(file("b.mp4"))), HasSubstr("breaks off"));
}

TEST_F(Video, VerifySurvivesDamageAndNoticesIt) {
    make_video(file("a.mp4"), small_video(), 60);
    const std::string whole = test::read_file(file("a.mp4"));
    // Any byte may be hit: no crash. In the picture data it must be noticed.
    for (std::size_t at = 0; at < whole.size(); at += 97) {
        std::string broken = whole;
        broken[at] = static_cast<char>(broken[at] ^ 0xff);
        test::write_file(file("b.mp4"), broken);
        EXPECT_NO_THROW((void)verify(file("b.mp4"))) << at;
    }
    std::string broken = whole;
    const std::size_t data = whole.find("mdat");
    for (std::size_t i = data + 1200; i < data + 1300; ++i) broken[i] = static_cast<char>(broken[i] ^ 0xa5);
    test::write_file(file("b.mp4"), broken);
    EXPECT_FALSE(verify(file("b.mp4")).ok());
}

TEST_F(Video, VerifyFindsALateIndexAndRoundedClocks) {
    make_video(file("a.mp4"), small_video({24000, 1001}), 60);
    test::copy_video(file("a.mp4"), file("b.mp4"), test::Retag::kNothing);
    const VerifyReport report = verify(file("b.mp4"));
    EXPECT_FALSE(report.faststart);
    EXPECT_THAT(all_problems(report), HasSubstr("+faststart"));
    EXPECT_THAT(all_problems(report),
                HasSubstr("movie_timescale"));  // libav's default movie clock is 1/1000 s
}

TEST_F(Video, VerifyFindsWrongTags) {
    make_video(file("a.mp4"), small_video(), 4);
    test::copy_video(file("a.mp4"), file("b.mp4"), test::Retag::kStream);
    std::string problems = all_problems(verify(file("b.mp4")));
    EXPECT_THAT(problems, HasSubstr("transfer tag"));
    EXPECT_THAT(problems, HasSubstr("matrix tag"));
    test::copy_video(file("a.mp4"), file("b.mp4"), test::Retag::kContainer);
    problems = all_problems(verify(file("b.mp4")));
    EXPECT_THAT(problems, HasSubstr("colr box: tv smpte170m"));
    test::copy_video(file("a.mp4"), file("b.mp4"), test::Retag::kNothing);
    EXPECT_THAT(all_problems(verify(file("b.mp4"))), testing::Not(HasSubstr("tag")));
}

TEST_F(Video, VerifyComparesWithWhatWasRendered) {
    make_video(file("a.mp4"), small_video(), 60);
    const std::string whole = test::read_file(file("a.mp4"));
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string changed = whole;
        const std::size_t at = changed.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        changed.replace(at, from.size(), to);
        test::write_file(file("b.mp4"), changed);
        return all_problems(verify(file("b.mp4")));
    };
    EXPECT_THAT(with("\"frames\":60", "\"frames\":61"), HasSubstr("61 frames were rendered"));
    EXPECT_THAT(with("\"fps\":\"60\"", "\"fps\":\"50\""), HasSubstr("rendered for 50 fps"));
    EXPECT_THAT(with("255,0,0]", "248,0,0]"), HasSubstr("shows R'G'B'"));
    EXPECT_THAT(with("\"fps\":\"60\"", "\"fps\":\"60\""), IsEmpty());
}

TEST_F(Video, VerifyTellsGarbageFromVideos) {
    EXPECT_THROW((void)verify(file("missing.mp4")), Error);
    EXPECT_THROW((void)verify(folder_.path()), Error);
    for (const std::string& text :
         {std::string(), std::string("hello, this is text\n"), std::string(5000, '\0'),
          std::string("\0\0\0\x08"
                      "ftyp",
                      8),
          std::string("\0\0\0\x01"
                      "ftyp\xff\xff\xff\xff\xff\xff\xff\xff",
                      16),
          std::string("\0\0\0\x08"
                      "ftyp\0\0\0\x10moov\0\0\0\x08trak",
                      24)}) {
        test::write_file(file("b.mp4"), text);
        EXPECT_THAT(verify(file("b.mp4")).problems, testing::Not(IsEmpty()));
    }
    write_png(file("b.mp4"), Image(8, 8));
    const VerifyReport report = verify(file("b.mp4"));
    EXPECT_THAT(report.problems, Contains(HasSubstr("not an MP4")));
    EXPECT_THAT(report.container, HasSubstr("png"));
}

TEST(Encoders, AreProbedByOpening) {
    const auto probes = probe_encoders();
    ASSERT_EQ(probes.size(), 12U);
    EXPECT_EQ(probes[0].name, "libx264");
    EXPECT_TRUE(probes[0].usable) << probes[0].reason;
    for (const auto& probe : probes) EXPECT_EQ(probe.usable, probe.reason.empty()) << probe.name;
}

}  // namespace
}  // namespace corda::media
