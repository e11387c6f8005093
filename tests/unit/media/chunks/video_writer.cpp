#include "corda/media/chunks/video_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>

#include "corda/core/file.hpp"
#include "corda/media/encode/yuv420.hpp"
#include "corda/media/format/format.hpp"
#include "support/cancel.hpp"
#include "support/decode_video.hpp"
#include "support/failure.hpp"
#include "support/file_size_limit.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

namespace fs = std::filesystem;
using test::failure_of;
using test::Yuv420Image;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

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
    return rgb_from_ycbcr(mean[0], mean[1], mean[2]);
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
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4"));
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

TEST_F(Video, FramesGivenByDamageEqualWholeFrames) {
    for (const PixelChoice pix : {PixelChoice::k420, PixelChoice::k444}) {
        VideoDef def = small_video();
        def.encoder.pix = pix;
        make_video(file("a.mp4"), def, 30);
        {
            VideoWriter writer(file("b.mp4"), def, {"A swing", R"({"scene":"test"})"}, {.force = true});
            for (int k = 0; k < 30; ++k) writer.write(frame_image(k), {{0, 0, kWidth, kHeight}});
            writer.finish();
        }
        EXPECT_EQ(test::read_file(file("a.mp4")), test::read_file(file("b.mp4")));
        fs::remove(file("a.mp4"));
    }
}

TEST_F(Video, FirstFrameIsTakenWholeAndEmptyDamageRepeatsIt) {
    for (const Damage& damage : {Damage{{0, 0, kWidth, kHeight}}, Damage{}}) {
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

/// During its lifetime, this process can open `count` more files.
class OpenFileLimit {
  public:
    explicit OpenFileLimit(rlim_t count) {
        const Descriptor next(::dup(STDERR_FILENO));
        EXPECT_EQ(::getrlimit(RLIMIT_NOFILE, &old_limit_), 0);
        const rlimit limit{static_cast<rlim_t>(next.get()) + count, old_limit_.rlim_max};
        EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);
    }
    OpenFileLimit(const OpenFileLimit&) = delete;
    OpenFileLimit& operator=(const OpenFileLimit&) = delete;
    ~OpenFileLimit() { EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &old_limit_), 0); }

  private:
    rlimit old_limit_{};
};

TEST_F(Video, OfManyChunksIsMadeInMemoryWithFewOpenFiles) {
    constexpr std::int64_t kFrames = 40;  // 20 chunks
    const VideoDef def = small_video({1, 1});
    const Format format = find_format("a.mp4", def);
    const std::int64_t per_chunk = frames_per_chunk(format, def.fps);
    ASSERT_EQ(per_chunk, 2);
    std::vector<Chunk> chunks;
    for (std::int64_t first = 0; first < kFrames; first += per_chunk) {
        ChunkEncoder encoder(make_encoder(format, def, first), first);
        for (std::int64_t k = first; k < first + per_chunk; ++k)
            encoder.encode(frame_image(k), {{0, 0, kWidth, kHeight}}, k + 1 == first + per_chunk);
        chunks.push_back(encoder.finish());
    }
    std::vector<std::string> files;
    {
        const OpenFileLimit limit(8);
        files = video_files({.path = "a.mp4", .def = def, .format = format, .end = kFrames},
                            {"A swing", R"({"scene":"test"})"}, chunks);
    }
    make_video(file("a.mp4"), def, kFrames);
    EXPECT_EQ(files, std::vector{test::read_file(file("a.mp4"))});
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
    for (const std::string preset : find_codec("libx264")->presets) {
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

// x264 writes into a video what it was asked for.
TEST_F(Video, QuantizerOfUltrafastIsConstant) {
    for (const auto& [preset, crf, words] : {std::tuple{"ultrafast", 18, " rc=cqp mbtree=0 qp=14 "},
                                             {"ultrafast", 2, " rc=cqp mbtree=0 qp=1 "},
                                             {"superfast", 18, " rc=crf mbtree=0 crf=18.0 "},
                                             {"veryfast", 18, " rc=crf mbtree=1 crf=18.0 "}}) {
        VideoDef def = small_video();
        def.encoder.preset = preset;
        def.encoder.crf = crf;
        make_video(file("a.mp4"), def, 2);
        const std::string bytes = test::read_file(file("a.mp4"));
        const std::size_t told = bytes.find(" rc=");
        ASSERT_NE(told, std::string::npos) << preset;
        EXPECT_THAT(bytes.substr(told, 60), StartsWith(words)) << preset;
        fs::remove(file("a.mp4"));
    }
}

TEST_F(Video, SmallestSize) {
    VideoDef def = small_video();
    def.width_px = 2;
    def.height_px = 2;
    VideoWriter writer(file("a.mp4"), def, {});
    Image image(2, 2);
    writer.write(image, {image.rect()});
    writer.finish();
    EXPECT_TRUE(verify(file("a.mp4")).ok());
}

TEST_F(Video, RefusesBadSettingsBeforeAnyFile) {
    const auto expect_refused = [this](const VideoDef& def, const std::string& words) {
        const test::Failure failure = failure_of([&] { VideoWriter(file("a.mp4"), def, {}); });
        EXPECT_EQ(failure.code, ExitCode::kUsage);
        EXPECT_THAT(failure.message, HasSubstr(words));
    };
    VideoDef def = small_video();
    def.width_px = 321;
    expect_refused(def, "320 or 322");
    def = small_video();
    def.width_px = 0;
    expect_refused(def, "out of range");
    def = small_video();
    def.encoder.preset = "swift";
    expect_refused(def, "veryfast");
    def = small_video();
    def.encoder.codec = "h263";
    expect_refused(def, "libx264");
    def = small_video();
    def.encoder.crf = 0;
    expect_refused(def, "crf 0");
    def = small_video();
    def.encoder.threads = 0;
    expect_refused(def, "threads");
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(Video, RefusesNamesThatCannotBeWritten) {
    const auto code_for = [](const std::string& path) {
        return failure_of([&] { VideoWriter(path, small_video(), {}); }).code;
    };
    EXPECT_EQ(code_for(file("no/folder/a.mp4")), ExitCode::kIo);
    EXPECT_EQ(code_for(file("a.avi")), ExitCode::kUsage);
    fs::create_symlink("/dev/null", file("null.mp4"));
    EXPECT_EQ(code_for(file("null.mp4")), ExitCode::kIo);  // an MP4 is not written from front to back
    EXPECT_THAT(folder_.files(), ElementsAre("null.mp4"));
}

TEST_F(Video, WithoutFramesCannotBeFinishedAndLeavesNoFile) {
    {
        VideoWriter writer(file("a.mp4"), small_video(), {});
        EXPECT_EQ(failure_of([&] { writer.finish(); }).code, ExitCode::kUsage);
    }
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(Video, AbandonedWithoutFramesLeavesNoFile) {
    {
        VideoWriter writer(file("a.mp4"), small_video(), {});
        EXPECT_EQ(writer.abandon(), "");
    }
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(Video, WithoutAFragmentLeavesNoFile) {
    {
        VideoWriter writer(file("a.mp4"), small_video(), {});
        write_frames(writer, 1);
    }
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(Video, AbandonedPlaysAsChunks) {
    const auto chunks = abandon_video(file("a.mp4"), small_video({24000, 1001}), 60);
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4.parts"));
    ASSERT_EQ(chunks.size(), 2U);
    EXPECT_EQ(chunks[0].frames + chunks[1].frames, 60);
    const auto video = test::decode_video(chunks[0].path);
    ASSERT_EQ(video.pts.size(), 48U);
    for (std::int64_t k = 0; k < 48; ++k) EXPECT_EQ(video.pts[static_cast<std::size_t>(k)], k * 1001);
    EXPECT_THAT(all_problems(verify(chunks[0].path)), IsEmpty());
}

TEST_F(Video, HasEveryChunkOnTheDiskOnceItIsWhole) {
    for (const char* const name : {"a.mp4", "a.webm", "a.mkv"}) {
        const std::string parts = parts_path(file(name));
        VideoWriter writer(file(name), small_video({30, 1}), {"A swing", "{}"}, {});
        const std::int64_t chunk = writer.manifest().per_chunk;
        for (int chunks = 1; chunks <= 2; ++chunks) {
            write_frames(writer, chunk);
            // The folder as a kill would leave it now.
            const std::string copy = parts_path(file("copy"));
            fs::remove_all(copy);
            fs::copy(parts, copy);
            EXPECT_EQ(recover(copy, file(std::string("copy_") + name), {.force = true}).frames,
                      chunks * chunk)
                << name;
        }
        EXPECT_EQ(writer.abandon(), parts);
    }
}

TEST_F(Video, EndsAChunkWithItsLastFrame) {
    VideoWriter writer(check_video_output({.path = file("a.mp4"), .def = small_video(), .end = 8}), {});
    write_frames(writer, 7);
    EXPECT_THAT(chunk_files(file("a.mp4.parts")), IsEmpty());
    writer.write(frame_image(7), {bob(6), bob(7)});
    fs::copy(file("a.mp4.parts"), file("copy.mp4.parts"));
    EXPECT_EQ(recover(file("copy.mp4.parts"), file("copy.mp4")).frames, 8);
    writer.finish();
    EXPECT_TRUE(test::read_file(file("a.mp4")) == test::read_file(file("copy.mp4")));
}

TEST_F(Video, KeepsAllFramesIfCancelledWhileItIsJoined) {
    {
        VideoWriter writer(check_video_output({.path = file("a.mp4"), .def = small_video(), .end = 5}), {});
        write_frames(writer, 5);
        const CancelScope stop = test::cancel_after(0);
        EXPECT_EQ(test::code_of([&] { writer.finish(); }), ExitCode::kInterrupted);
        EXPECT_EQ(writer.abandon(), file("a.mp4.parts"));
        EXPECT_EQ(writer.frames(), 5);
    }
    EXPECT_EQ(recover(file("a.mp4.parts"), file("b.mp4")).frames, 5);
}

TEST_F(Video, SkipsTheChunksThatAreThere) {
    const auto output = [&](std::optional<Shard> shard) {
        return check_video_output({.path = file("a.mp4"),
                                   .def = small_video(),
                                   .first = 50,  // chunks of 10, 60, 60 and 20 frames
                                   .end = 200,
                                   .resume = !shard,
                                   .shard = shard});
    };
    {
        VideoWriter writer(output(Shard{1, 2}), {});
        EXPECT_THAT(writer.lacking_chunks(), ElementsAre(1, 3));
        for (int k = 0; k < 80; ++k)
            writer.write(frame_image(k < 60 ? 60 + k : 120 + k), {{0, 0, kWidth, kHeight}});
        EXPECT_EQ(writer.frames(), 80);
        writer.finish();
        EXPECT_FALSE(fs::exists(file("a.mp4")));
    }
    VideoWriter rest(output({}), {});
    EXPECT_EQ(rest.frames(), 80);
    EXPECT_THAT(rest.lacking_chunks(), ElementsAre(0, 2));
    for (int k = 0; k < 70; ++k)
        rest.write(frame_image(k < 10 ? 50 + k : 110 + k), {{0, 0, kWidth, kHeight}});
    rest.finish();
    VideoWriter all(
        check_video_output({.path = file("b.mp4"), .def = small_video(), .first = 50, .end = 200}), {});
    for (int k = 50; k < 200; ++k) all.write(frame_image(k), {{0, 0, kWidth, kHeight}});
    all.finish();
    EXPECT_TRUE(test::read_file(file("a.mp4")) == test::read_file(file("b.mp4")));
}

TEST_F(Video, AnExistingFileIsReplacedOnlyWithForce) {
    test::write_file(file("a.mp4"), "precious");
    const test::Failure failure = failure_of([&] { VideoWriter(file("a.mp4"), small_video(), {}); });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, HasSubstr("--force"));
    EXPECT_EQ(test::read_file(file("a.mp4")), "precious");
    make_video(file("a.mp4"), small_video(), 4);
    EXPECT_TRUE(verify(file("a.mp4")).ok());
}

TEST_F(Video, AFileThatAppearedMeanwhileIsNotReplaced) {
    VideoWriter writer(file("a.mp4"), small_video(), {});
    write_frames(writer, 4);
    test::write_file(file("a.mp4"), "precious");
    const test::Failure failure = failure_of([&] { writer.finish(); });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message,
                HasSubstr("finished chunks are in '" + file("a.mp4.parts") + "'; --resume --force"));
    EXPECT_EQ(test::read_file(file("a.mp4")), "precious");
    EXPECT_EQ(chunk_files(file("a.mp4.parts")).size(), 1U);
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4", "a.mp4.parts"));
}

TEST_F(Video, AChunkThatIsGoneAtTheEndIsNamed) {
    VideoWriter writer(file("a.mp4"), small_video(), {});
    write_frames(writer, 150);
    fs::remove(chunk_files(file("a.mp4.parts"))[1].path);
    const test::Failure failure = failure_of([&] { writer.finish(); });
    EXPECT_EQ(failure.code, ExitCode::kMismatch);
    EXPECT_EQ(failure.message, "chunk 1 (frames 60..119) is missing in '" + file("a.mp4.parts") +
                                   "': --resume makes it again");
    EXPECT_FALSE(fs::exists(file("a.mp4")));
}

TEST_F(Video, ForceReplacesTheFileBehindALink) {
    test::write_file(file("real.mp4"), "old");
    fs::create_symlink("real.mp4", file("a.mp4"));
    make_video(file("a.mp4"), small_video(), 4);
    EXPECT_TRUE(fs::is_symlink(file("a.mp4")));
    EXPECT_TRUE(verify(file("real.mp4")).ok());
}

TEST_F(Video, AnInterruptedRenderIsReplacedOnlyWithForce) {
    const std::string chunk = abandon_video(file("a.mp4"), small_video(), 4)[0].path;
    for (const auto& start : std::vector<std::function<void()>>{
             [&] { static_cast<void>(check_video_output({.path = file("a.mp4"), .def = small_video()})); },
             [&] { VideoWriter(file("a.mp4"), small_video(), {}); }}) {
        const test::Failure failure = failure_of(start);
        EXPECT_EQ(failure.code, ExitCode::kIo);
        EXPECT_THAT(failure.message, HasSubstr("interrupted render"));
        EXPECT_THAT(failure.message, HasSubstr("--force"));
        EXPECT_TRUE(fs::exists(chunk));
    }
    static_cast<void>(check_video_output({.path = file("a.mp4"), .def = small_video(), .force = true}));
    make_video(file("a.mp4"), small_video(), 8);
    EXPECT_EQ(verify(file("a.mp4")).frames, 8);
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4"));
}

TEST_F(Video, TwoRendersNeverWriteToOneName) {
    VideoWriter writer(file("a.mp4"), small_video(), {});
    write_frames(writer, 8);
    for (const bool force : {false, true}) {
        for (const auto& start : std::vector<std::function<void()>>{
                 [&] {
                     static_cast<void>(
                         check_video_output({.path = file("a.mp4"), .def = small_video(), .force = force}));
                 },
                 [&] { VideoWriter(file("a.mp4"), small_video(), {}, {.force = force}); }}) {
            const test::Failure failure = failure_of(start);
            EXPECT_EQ(failure.code, ExitCode::kIo);
            EXPECT_THAT(failure.message, HasSubstr("another render is writing"));
        }
    }
    writer.finish();
    EXPECT_EQ(verify(file("a.mp4")).frames, 8);
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4"));
}

TEST_F(Video, AFullDiskIsAnIoErrorAndKeepsTheChunks) {
    // A limit on the size of files stops the video as a full disk does.
    const test::Failure failure = failure_of([&] {
        const test::FileSizeLimit limit(8192);
        make_video(file("a.mp4"), small_video(), 240);
    });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, HasSubstr("File too large"));
    EXPECT_THAT(failure.message, HasSubstr("ulimit"));
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4.parts"));
}

TEST_F(Video, AWriterThatFailedKeepsItsWholeChunks) {
    auto writer = std::make_unique<VideoWriter>(file("a.mp4"), small_video(), VideoMetadata{});
    const test::Failure full = failure_of([&] {
        write_frames(*writer, 60);
        const test::FileSizeLimit limit(512);
        write_frames(*writer, 60);
    });
    EXPECT_EQ(full.code, ExitCode::kIo);
    EXPECT_THAT(full.message, HasSubstr("finished chunks are in '" + file("a.mp4.parts") + "'; --resume"));
    EXPECT_EQ(writer->frames(), 60);
    EXPECT_EQ(writer->abandon(), file("a.mp4.parts"));
    writer.reset();
    EXPECT_EQ(recover(file("a.mp4.parts"), file("a.mp4")).frames, 60);
}

}  // namespace
}  // namespace corda::media
