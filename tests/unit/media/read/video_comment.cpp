#include "corda/media/read/video_comment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "support/failure.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

using test::failure_of;
using testing::HasSubstr;

/// An object with a list in it; the innermost list is at level `levels`.
std::string nested_json(int levels) {
    const auto lists = static_cast<std::size_t>(levels - 1);
    return R"({"provenance":)" + std::string(lists, '[') + std::string(lists, ']') + "}";
}

TEST(VideoComment, IsRefusedByItsDepth) {
    EXPECT_EQ(comment_problem(nested_json(kDeepestJsonLevel)), "");
    EXPECT_TRUE(parse_untrusted_json(nested_json(kDeepestJsonLevel)).is_object());
    for (const int levels : {kDeepestJsonLevel + 1, 30'000}) {
        const std::string comment = nested_json(levels);
        EXPECT_THAT(comment_problem(comment), HasSubstr("nested more than 16 levels"));
        EXPECT_EQ(failure_of([&] { static_cast<void>(parse_untrusted_json(comment)); }).code,
                  ExitCode::kMismatch);
    }
    // Lists that are not closed are no JSON, however deep.
    EXPECT_THAT(comment_problem(std::string(60'000, '[')), HasSubstr("nested"));
}

TEST(VideoComment, IsRefusedByItsSize) {
    const std::string comment = R"({"frames":1,"a":")" + std::string(kMaxJsonBytes, 'a') + "\"}";
    EXPECT_THAT(comment_problem(comment), HasSubstr("more than 65536"));
}

TEST_F(Video, WithANestedCommentIsNoSoundOne) {
    make_video(file("a.mp4"), small_video(), 4);
    for (const int levels : {17, 1000}) {
        const auto copied =
            test::run_shell("ffmpeg -v error -y -i " + file("a.mp4") + " -c copy -metadata comment='" +
                            nested_json(levels) + "' " + file("b.mp4"));
        ASSERT_EQ(copied.exit_code, 0) << copied.err;
        const auto failure = failure_of([&] { static_cast<void>(video_comment(file("b.mp4"))); });
        EXPECT_EQ(failure.code, ExitCode::kUsage);
        EXPECT_THAT(failure.message, HasSubstr("nested more than 16 levels deep"));
    }
}

/// A copy with a few damaged bytes, most of them in the header.
std::string damaged(std::string bytes, std::uint32_t seed) {
    std::mt19937 random(seed);  // the same everywhere
    for (std::uint32_t i = 0; i < 1 + seed % 5 && !bytes.empty(); ++i) {
        const std::size_t range =
            random() % 4 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 4096);
        const std::size_t at = random() % range;
        switch (random() % 4) {
            case 0:
                bytes.erase(at, 1 + random() % 8);
                break;
            case 1:
                bytes.insert(at, bytes.substr(random() % bytes.size(), random() % 60));
                break;
            case 2:
                bytes.replace(at, 4, random() % 2 == 0 ? "\xff\xff\xff\xff" : std::string(4, '\0'));
                break;
            default:
                bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ (1U << random() % 8));
        }
    }
    return bytes;
}

TEST_F(Video, OfDamagedBytesHasACommentOrIsRefused) {
    for (const std::string name : {"a.mp4", "a.mov", "a.webm", "a.mkv"}) {
        make_video(file(name), small_video(), 3);
        const std::string whole = test::read_file(file(name));
        EXPECT_THAT(video_comment(file(name)), HasSubstr("\"scene\":\"test\""));
        int read = 0;
        for (std::uint32_t seed = 0; seed < 200; ++seed) {
            test::write_file(file("b"), damaged(whole, seed));
            const auto failure = failure_of([&] { static_cast<void>(video_comment(file("b"))); });
            EXPECT_TRUE(failure.code == ExitCode::kOk || failure.code == ExitCode::kIo ||
                        failure.code == ExitCode::kUsage)
                << name << seed << failure.message;
            read += failure.code == ExitCode::kOk ? 1 : 0;
        }
        EXPECT_GT(read, 0) << name;
    }
}

}  // namespace
}  // namespace corda::media
