#include "corda/media/write/video_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>

#include "corda/core/file.hpp"
#include "corda/media/format/format.hpp"
#include "support/cancel.hpp"
#include "support/failure.hpp"
#include "support/file_size_limit.hpp"
#include "support/probe.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

namespace fs = std::filesystem;
using test::failure_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

TEST_F(Video, FramesGivenByDamageEqualWholeFrames) {
    for (const PixelChoice pix : {PixelChoice::k420, PixelChoice::k444}) {
        VideoDef def = small_video();
        def.encoder.pix = pix;
        make_video(file("a.mp4"), def, 30);
        VideoWriter writer(file("b.mp4"), def, 30, false, true);
        for (int k = 0; k < 30; ++k) writer.write_whole(frame_image(k));
        writer.finish();
        EXPECT_EQ(test::read_file(file("a.mp4")), test::read_file(file("b.mp4")));
        fs::remove(file("a.mp4"));
    }
}

TEST_F(Video, FirstFrameIsTakenWholeAndEmptyDamageRepeatsIt) {
    for (const Damage& damage : {Damage{{0, 0, kWidth, kHeight}}, Damage{}}) {
        VideoWriter writer(file(damage.empty() ? "b.mp4" : "a.mp4"), small_video(), 5);
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

TEST_F(Video, HasAKeyFrameEverySecondOrTwo) {
    for (const auto& [rate, frames] : {std::pair{Rational{60, 1}, 60},
                                       {{24, 1}, 48},
                                       {{25, 1}, 50},
                                       {{30, 1}, 60},
                                       {{30000, 1001}, 60},
                                       {{120, 1}, 120},
                                       {{5, 1}, 10},
                                       {{1, 10}, 1}})
        EXPECT_EQ(key_interval(FrameRate(rate)), frames) << rate.text();
    for (const char* const name : {"a.mp4", "a.webm"}) {
        make_video(file(name), small_video({5, 1}), 25);
        const auto probe = test::run_shell("ffprobe -v error -of csv=p=0 -show_entries packet=flags " +
                                           file(name) + " | grep -n K | cut -d: -f1 | tr '\\n' ' '");
        EXPECT_EQ(probe.out, "1 11 21 ") << name;
    }
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
    VideoWriter writer(file("a.mp4"), def, 1);
    writer.write_whole(Image(2, 2));
    EXPECT_NO_THROW(writer.finish());
}

TEST_F(Video, RefusesBadSettingsBeforeAnyFile) {
    const auto expect_refused = [this](const VideoDef& def, const std::string& words) {
        const test::Failure failure = failure_of([&] { VideoWriter(file("a.mp4"), def, 1); });
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
        return failure_of([&] { VideoWriter(path, small_video(), 1); }).code;
    };
    EXPECT_EQ(code_for(file("no/folder/a.mp4")), ExitCode::kIo);
    EXPECT_EQ(code_for(file("a.avi")), ExitCode::kUsage);
    fs::create_symlink("/dev/null", file("null.mp4"));
    EXPECT_EQ(code_for(file("null.mp4")), ExitCode::kIo);  // an MP4 is not written from front to back
    EXPECT_THAT(folder_.files(), ElementsAre("null.mp4"));
}

TEST_F(Video, ThatIsNotFinishedLeavesNoFile) {
    for (const char* const name : {"a.mp4", "a.webm", "a.mkv", "a.mov", "a.gif"}) {
        for (const int frames : {0, 1, 60}) {
            VideoWriter writer(file(name), small_video({25, 1}), 100);
            write_frames(writer, 0, frames);
        }
        EXPECT_THAT(folder_.files(), IsEmpty()) << name;
    }
}

TEST_F(Video, ThatIsStoppedWhileItEndsLeavesNoFile) {
    for (const char* const name : {"a.mp4", "a.gif"}) {
        VideoWriter writer(file(name), small_video({25, 1}), 5);
        write_frames(writer, 0, 5);
        {
            const CancelScope stop = test::cancel_after(0);
            EXPECT_EQ(test::code_of([&] { writer.finish(); }), ExitCode::kInterrupted) << name;
        }
        EXPECT_FALSE(fs::exists(file(name)));
    }
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(Video, ThatDoesNotShowWhatWasDrawnGetsNoName) {
    for (const char* const name : {"a.mp4", "a.webm", "a.mkv", "a.mov", "a.gif"}) {
        const CheckedVideo video =
            check_video_output({.path = file(name), .def = small_video({25, 1}), .end = 2});
        VideoFile output(video, {});
        FrameMaker maker(video.format, 0, {});
        ReadyFrame first = maker.make(0, frame_image(0), {});
        for (std::size_t i = 0; i < first.drawn.size_bytes(); i += 4) first.drawn.data()[i] ^= 0x40U;
        output.add(std::move(first));
        output.add(maker.make(1, frame_image(1), {}));
        const test::Failure failure = failure_of([&] { output.commit(); });
        EXPECT_EQ(failure.code, ExitCode::kEncoder) << name;
        EXPECT_THAT(failure.message, HasSubstr("the first picture has R'G'B'")) << name;
        EXPECT_FALSE(fs::exists(file(name)));
    }
}

TEST_F(Video, AnExistingFileIsReplacedOnlyWithForce) {
    test::write_file(file("a.mp4"), "precious");
    const test::Failure failure = failure_of([&] { VideoWriter(file("a.mp4"), small_video(), 4); });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, HasSubstr("--force"));
    EXPECT_EQ(test::read_file(file("a.mp4")), "precious");
    make_video(file("a.mp4"), small_video(), 4);
    EXPECT_EQ(test::probe(file("a.mp4")).frames, 4);
}

TEST_F(Video, AFileThatAppearedMeanwhileIsNotReplaced) {
    VideoWriter writer(file("a.mp4"), small_video(), 4);
    write_frames(writer, 0, 4);
    test::write_file(file("a.mp4"), "precious");
    EXPECT_EQ(failure_of([&] { writer.finish(); }).code, ExitCode::kIo);
    EXPECT_EQ(test::read_file(file("a.mp4")), "precious");
}

TEST_F(Video, ForceReplacesALinkAndNotItsFile) {
    test::write_file(file("real.mp4"), "old");
    fs::create_symlink("real.mp4", file("a.mp4"));
    make_video(file("a.mp4"), small_video(), 4);
    EXPECT_FALSE(fs::is_symlink(file("a.mp4")));
    EXPECT_EQ(test::probe(file("a.mp4")).frames, 4);
    EXPECT_EQ(test::read_file(file("real.mp4")), "old");
}

TEST_F(Video, AFullDiskIsAnIoErrorAndLeavesNoFile) {
    for (const char* const name : {"a.mp4", "a.webm", "a.mkv", "a.mov", "a.gif"}) {
        // A limit on the size of files stops the video as a full disk does.
        const test::Failure failure = failure_of([&] {
            const test::FileSizeLimit limit(4096);
            make_video(file(name), small_video({25, 1}), 240);
        });
        EXPECT_EQ(failure.code, ExitCode::kIo) << name;
        EXPECT_THAT(failure.message, HasSubstr("File too large")) << name;
        EXPECT_THAT(folder_.files(), IsEmpty()) << name;
    }
}

}  // namespace
}  // namespace corda::media
