#include "corda/media/verify/verify.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "corda/core/basics.hpp"
#include "corda/media/chunks/chunk.hpp"
#include "corda/media/defs.hpp"
#include "support/decode_video.hpp"
#include "support/failure.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

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

TEST_F(Video, VerifySurvivesDamageAndReportsIt) {
    make_video(file("a.mp4"), small_video(), 60);
    const std::string whole = test::read_file(file("a.mp4"));
    // Damage to any byte must not crash it, and damage to picture data must be reported.
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

TEST_F(Video, VerifyReportsTimeStampsThatCannotBe) {
    make_video(file("a.mp4"), small_video({10, 1}), 60);  // chunks of 20 frames
    const auto made = test::run_shell("ffmpeg -v error -i " + file("a.mp4") +
                                      " -c copy -movflags frag_keyframe+empty_moov " + file("b.mp4"));
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const std::string whole = test::read_file(file("b.mp4"));
    // Decode times of a fragment that no video has and that libav lets pass.
    for (const std::uint64_t ticks :
         {0x7000'0000'0000'0000U, 0x4000'0000'0000'0000U, 0x1000'0000'0000'0100U}) {
        std::size_t at = whole.find("tfdt");
        for (int fragment = 0; fragment < 3; ++fragment, at = whole.find("tfdt", at + 4)) {
            ASSERT_NE(at, std::string::npos);
            ASSERT_EQ(whole[at + 4], 1) << "the decode time is not 64 bits wide";
            std::string changed = whole;
            for (std::size_t i = 0; i < 8; ++i)
                changed[at + 8 + i] = static_cast<char>(ticks >> (56 - 8 * i));
            test::write_file(file("b.mp4"), changed);
            EXPECT_THAT(all_problems(verify(file("b.mp4"))), HasSubstr("a frame has the time stamp"))
                << ticks << " " << fragment;
        }
    }
}

TEST_F(Video, VerifyFindsALateIndexAndRoundedClocks) {
    make_video(file("a.mp4"), small_video({24000, 1001}), 60);
    test::copy_video(file("a.mp4"), file("b.mp4"), test::Retag::kNone);
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
    test::copy_video(file("a.mp4"), file("b.mp4"), test::Retag::kNone);
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

TEST_F(Video, VerifyComparesFramesThatItIsToldOf) {
    make_video(file("a.mp4"), small_video(), 150);
    const auto red_at = [&](std::int64_t frame, std::uint8_t red, VerifyDepth depth) {
        return all_problems(verify(file("a.mp4"), depth, {{frame, {{32, 32, {red, 0, 0}}}}}));
    };
    for (const VerifyDepth depth : {VerifyDepth::kKeyFrames, VerifyDepth::kAllFrames}) {
        EXPECT_THAT(red_at(60, 255, depth), IsEmpty());
        EXPECT_THAT(red_at(60, 248, depth), HasSubstr("at (32, 32) frame 60 shows R'G'B' 25"));
    }
    EXPECT_THAT(red_at(59, 255, VerifyDepth::kAllFrames), IsEmpty());
    EXPECT_THAT(red_at(59, 248, VerifyDepth::kAllFrames), HasSubstr("frame 59 shows"));
    EXPECT_THAT(red_at(59, 248, VerifyDepth::kKeyFrames), IsEmpty());  // it is not decoded
}

TEST_F(Video, AChunkThatDoesNotShowWhatWasDrawnGetsNoName) {
    for (const VerifyDepth depth : {VerifyDepth::kKeyFrames, VerifyDepth::kAllFrames}) {
        VideoWriter writer(file("a.mp4"), small_video(), {});
        write_frames(writer, 60);
        ChunkEncoder encoder = writer.chunk_encoder(60);
        for (int k = 60; k < 120; ++k) encoder.encode(frame_image(k), {{0, 0, kWidth, kHeight}}, k == 119);
        Chunk chunk = encoder.finish();
        ASSERT_EQ(chunk.colors.size(), 2U);
        const bool is_first = depth == VerifyDepth::kKeyFrames;
        chunk.colors[is_first ? 0 : 1].patches[0].rgb[1] ^= 0x40;
        writer.append(std::move(chunk));
        EXPECT_THAT(test::failure_of([&] { writer.finish(depth); }).message,
                    HasSubstr(is_first ? "frame 60 shows" : "frame 119 shows"));
        EXPECT_FALSE(std::filesystem::exists(file("a.mp4")));
        std::filesystem::remove_all(file("a.mp4.parts"));
    }
}

TEST_F(Video, AChunkWhoseLastFrameIsNotWhatWasDrawnIsNotMade) {
    for (const PixelChoice pix : {PixelChoice::k420, PixelChoice::k444}) {
        VideoDef def = small_video();
        def.encoder.pix = pix;
        VideoWriter writer(file("a.mp4"), def, {});
        for (const bool is_told : {true, false}) {
            ChunkEncoder encoder = writer.chunk_encoder(0);
            encoder.encode(frame_image(0), {}, false);
            Image other = frame_image(1);
            for (std::size_t i = 0; i < other.size_bytes(); i += 4) other.data()[i] ^= 0x40U;
            const auto end = [&] {
                encoder.encode(other, is_told ? Damage{other.rect()} : Damage{}, true);
                static_cast<void>(encoder.finish());
            };
            if (is_told)
                EXPECT_NO_THROW(end());
            else
                EXPECT_THAT(test::failure_of(end).message, HasSubstr("libx264 shows R'G'B'"));
        }
    }
}

TEST_F(Video, VerifyFindsTheSameByKeyFrames) {
    for (const Rational fps : {Rational{30, 1}, Rational{24000, 1001}}) {
        for (const int frames : {1, 7, 150}) {
            const std::string name = file("a" + std::to_string(frames) + std::to_string(fps.num) + ".mp4");
            make_video(name, small_video(fps), frames);
            VerifyReport all = verify(name);
            VerifyReport keys = verify(name, VerifyDepth::kKeyFrames);
            EXPECT_TRUE(keys.ok()) << (keys.problems.empty() ? "" : keys.problems.front());
            EXPECT_NE(all.notes, keys.notes);  // which name the decoded frames
            all.notes.clear();
            keys.notes.clear();
            EXPECT_EQ(all, keys) << frames;
        }
    }
}

TEST_F(Video, VerifyByKeyFramesFindsOneThatDoesNotDecode) {
    make_video(file("a.mp4"), small_video(), 150);
    std::string bytes = test::read_file(file("a.mp4"));
    const VerifyReport whole = verify(file("a.mp4"), VerifyDepth::kKeyFrames);
    ASSERT_TRUE(whole.ok());
    // Within the first picture, behind what x264 says of itself.
    const std::size_t data = bytes.find("mdat");
    ASSERT_NE(data, std::string::npos);
    for (std::size_t i = 720; i < 1200; ++i) bytes[data + i] = static_cast<char>(0x5a);
    test::write_file(file("b.mp4"), bytes);
    EXPECT_FALSE(verify(file("b.mp4"), VerifyDepth::kKeyFrames).ok());
}

TEST_F(Video, VerifyReportsFilesThatAreNoVideo) {
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
    write_png(file("b.mp4"), Image(8, 8), {}, {.force = true});
    const VerifyReport report = verify(file("b.mp4"));
    EXPECT_THAT(report.problems, Contains(HasSubstr("not an MP4")));
    EXPECT_THAT(report.container, HasSubstr("png"));
}

}  // namespace
}  // namespace corda::media
