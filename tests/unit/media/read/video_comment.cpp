#include "corda/media/read/video_comment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "corda/media/chunks/finish_part.hpp"
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

/// Leaves a part whose comment is nested.
void leave_nested_part(const std::string& path, int levels) {
    VideoWriter writer(path, small_video(), {"A swing", nested_json(levels)}, {.force = true});
    write_frames(writer, 4);
    static_cast<void>(writer.abandon());
}

TEST(VideoComment, IsRefusedByItsDepth) {
    EXPECT_EQ(comment_problem(nested_json(kDeepestJsonLevel)), "");
    EXPECT_TRUE(parse_untrusted_json(nested_json(kDeepestJsonLevel)).is_object());
    for (const int levels : {kDeepestJsonLevel + 1, 30'000}) {
        const std::string comment = nested_json(levels);
        EXPECT_THAT(comment_problem(comment), HasSubstr("nested more than 16 levels"));
        EXPECT_EQ(failure_of([&] { static_cast<void>(parse_untrusted_json(comment)); }).code,
                  ExitCode::kMismatch);
        EXPECT_EQ(comment_number(comment, "frames"), std::nullopt);
        EXPECT_TRUE(told_origin(comment).empty());
        EXPECT_EQ(finished_comment(comment, 3), comment);
    }
    // Lists that are not closed are no JSON, however deep.
    EXPECT_THAT(comment_problem(std::string(60'000, '[')), HasSubstr("nested"));
}

TEST(VideoComment, IsRefusedByItsSize) {
    const std::string comment = R"({"frames":1,"a":")" + std::string(kMaxJsonBytes, 'a') + "\"}";
    EXPECT_THAT(comment_problem(comment), HasSubstr("more than 65536"));
    EXPECT_EQ(comment_number(comment, "frames"), std::nullopt);
}

TEST(VideoComment, NumbersBeyondTheRangeAreNone) {
    EXPECT_EQ(comment_number(R"({"frames":9223372036854775807})", "frames"), 9223372036854775807);
    EXPECT_EQ(comment_number(R"({"frames":9223372036854775808})", "frames"), std::nullopt);
    EXPECT_EQ(comment_number(R"({"frames":1e300})", "frames"), std::nullopt);
}

TEST_F(Video, WithANestedCommentIsNoSoundOne) {
    for (const int levels : {17, 1000}) {
        leave_nested_part(file("a.mp4"), levels);
        const auto failure = failure_of([&] { recover_part(file("a.mp4.part"), file("b.mp4")); });
        EXPECT_EQ(failure.code, ExitCode::kMismatch);
        EXPECT_THAT(failure.message, HasSubstr("its comment is JSON nested more than 16 levels deep"));
    }
    const auto failure = failure_of([&] { static_cast<void>(comment_in_child(file("a.mp4.part"))); });
    EXPECT_EQ(failure.code, ExitCode::kUsage);
    EXPECT_THAT(verify(file("a.mp4.part")).problems.back(), HasSubstr("nested more than 16 levels deep"));
}

}  // namespace
}  // namespace corda::media
