#include "corda/media/read/video_comment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

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
        const auto failure = failure_of([&] { static_cast<void>(comment_in_child(file("b.mp4"))); });
        EXPECT_EQ(failure.code, ExitCode::kUsage);
        EXPECT_THAT(failure.message, HasSubstr("nested more than 16 levels deep"));
    }
}

}  // namespace
}  // namespace corda::media
