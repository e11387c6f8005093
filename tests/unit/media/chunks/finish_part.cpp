#include "corda/media/chunks/finish_part.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "support/failure.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

namespace fs = std::filesystem;
using test::failure_of;
using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(Video, RecoveredIsTheWholePart) {
    abandon_video(file("a.mp4"), small_video({24000, 1001}), 60);
    const RemuxResult result = recover_part(file("a.mp4.part"), file("a.mp4"));
    EXPECT_EQ(result.frames, 60);
    EXPECT_FALSE(result.truncated);
    EXPECT_TRUE(verify(file("a.mp4")).ok());
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4"));
}

TEST_F(Video, RecoveredDoesNotReplaceAnExistingFileWithoutForce) {
    abandon_video(file("a.mp4"), small_video(), 8);
    test::write_file(file("a.mp4"), "precious");
    EXPECT_EQ(failure_of([&] { recover_part(file("a.mp4.part"), file("a.mp4")); }).code, ExitCode::kIo);
    EXPECT_EQ(test::read_file(file("a.mp4")), "precious");
    EXPECT_EQ(recover_part(file("a.mp4.part"), file("a.mp4"), {.force = true}).frames, 8);
    EXPECT_TRUE(verify(file("a.mp4")).ok());
}

TEST_F(Video, APartThatIsBeingWrittenIsNotRecovered) {
    VideoWriter writer(file("a.mp4"), small_video(), {});
    write_frames(writer, 8);
    const test::Failure failure = failure_of([&] { recover_part(file("a.mp4.part"), file("b.mp4")); });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, HasSubstr("another render is writing"));
    writer.finish();
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4"));
}

TEST_F(Video, APartWithAnotherNumberOfFramesStays) {
    abandon_video(file("a.mp4"), small_video(), 8);
    PartFile part = PartFile::open(file("a.mp4.part"));
    const test::Failure failure =
        failure_of([&] { finish_part(part, file("a.mp4"), {}, {.frames = 9, .rendered = {}}); });
    EXPECT_EQ(failure.code, ExitCode::kMismatch);
    EXPECT_THAT(failure.message, HasSubstr("8 frames instead of 9"));
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4.part"));
}

TEST_F(Video, APartStaysIfItIsDamagedOrToBeKept) {
    abandon_video(file("a.mp4"), small_video({10, 1}), 60);  // three chunks
    const std::string whole = test::read_file(file("a.mp4.part"));
    const RemuxResult kept = recover_part(file("a.mp4.part"), file("b.mp4"), {}, true);
    EXPECT_FALSE(kept.removed || kept.damaged || kept.truncated);
    EXPECT_TRUE(test::read_file(file("a.mp4.part")) == whole);
    // A changed byte in the second chunk, with a third one behind it.
    std::string changed = whole;
    changed[whole.rfind("mdat", whole.rfind("mdat") - 1) + 40] ^= 1;
    test::write_file(file("a.mp4.part"), changed);
    const RemuxResult damaged = recover_part(file("a.mp4.part"), file("a.mp4"));
    EXPECT_EQ(damaged.frames, 20);
    EXPECT_TRUE(damaged.damaged && damaged.truncated && !damaged.removed);
    EXPECT_TRUE(test::read_file(file("a.mp4.part")) == changed);
    EXPECT_TRUE(verify(file("a.mp4")).ok());
}

TEST_F(Video, ATornPartLosesOnlyItsLastFragment) {
    constexpr int kFrames = 100;
    abandon_video(file("a.mp4"), small_video({10, 1}), kFrames);  // a key frame every 20 frames
    const std::string whole = test::read_file(file("a.mp4.part"));
    const std::size_t last_fragment = whole.rfind("mdat");
    test::write_file(file("b.part"), whole.substr(0, last_fragment + 40));
    const RemuxResult torn = recover_part(file("b.part"), file("b.mp4"));
    EXPECT_TRUE(torn.truncated);
    EXPECT_EQ(torn.frames, 80);
    EXPECT_TRUE(verify(file("b.mp4")).ok()) << all_problems(verify(file("b.mp4")));
    const std::size_t second_fragment = whole.find("moof", whole.find("moof") + 4);
    // Cut anywhere, it gives whole fragments, or an error if there is none.
    for (std::size_t length = 0; length < whole.size(); length += 61) {
        test::write_file(file("b.part"), whole.substr(0, length));
        try {
            const auto frames = recover_part(file("b.part"), file("b.mp4"), {.force = true}).frames;
            ASSERT_EQ(frames % 20, 0) << length;
        } catch (const Error& error) {
            ASSERT_EQ(error.code(), ExitCode::kMismatch) << length << " " << error.what();
            ASSERT_LT(length, second_fragment) << error.what();
        }
    }
}

TEST_F(Video, APartWithADamagedTimeStampGivesWhatIsBefore) {
    abandon_video(file("a.mp4"), small_video({10, 1}), 60);  // fragments of 20 frames
    const std::string whole = test::read_file(file("a.mp4.part"));
    ASSERT_EQ(decode_times_in(whole), 3);
    for (const std::uint64_t ticks : kDamagedStamps) {
        test::write_file(file("b.part"), with_decode_time(whole, 2, ticks));
        const RemuxResult result = recover_part(file("b.part"), file("b.mp4"), {.force = true});
        EXPECT_EQ(result.frames, 40) << ticks;
        EXPECT_TRUE(result.truncated) << ticks;
        test::write_file(file("b.part"), with_decode_time(whole, 0, ticks));
        EXPECT_EQ(failure_of([&] { recover_part(file("b.part"), file("b.mp4"), {.force = true}); }).code,
                  ExitCode::kMismatch)
            << ticks;
    }
}

TEST_F(Video, FragmentsReachTheDiskWhileItRuns) {
    VideoDef def = small_video({10, 1});
    VideoWriter writer(file("a.mp4"), def, {});
    write_frames(writer, 150);
    // The encoder looks about 50 frames ahead. All earlier fragments must be there, although no file was
    // closed.
    fs::copy_file(file("a.mp4.part"), file("killed.part"));
    EXPECT_GE(recover_part(file("killed.part"), file("killed.mp4")).frames, 60);
}

}  // namespace
}  // namespace corda::media
