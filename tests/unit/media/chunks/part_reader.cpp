#include "corda/media/chunks/part_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "corda/core/part_file.hpp"
#include "corda/media/chunks/finish_part.hpp"
#include "support/failure.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

/// A part of a video of one ending, with three whole chunks and frames of a fourth one.
class PartOf : public Video, public testing::WithParamInterface<const char*> {
  protected:
    PartOf() {
        VideoWriter writer(path_, def_, {"A swing", "{}"}, {});
        chunk_ = writer.frames_per_chunk();
        for (int chunk = 0; chunk < 3; ++chunk) {
            write(writer, chunk * chunk_, (chunk + 1) * chunk_);
            ends_.push_back(test::read_file(part_path(path_)).size());
        }
        write(writer, 3 * chunk_, 3 * chunk_ + chunk_ / 2);
        bytes_ = test::read_file(writer.abandon());
        ends_.push_back(bytes_.size());
    }

    static void write(VideoWriter& writer, std::int64_t first, std::int64_t end) {
        for (std::int64_t k = first; k < end; ++k) {
            const Image image = frame_image(k);
            writer.write(image, {image.rect()});
        }
    }

    /// The number of frames in the chunks that end within the first `bytes`.
    [[nodiscard]] std::int64_t frames_within(std::size_t bytes) const {
        const auto whole =
            std::count_if(ends_.begin(), ends_.end(), [&](std::size_t end) { return end <= bytes; });
        return std::min<std::int64_t>(whole * chunk_, 3 * chunk_ + chunk_ / 2);
    }

    /// Recovers a part whose bytes are sound up to `sound` or beyond.
    void expect_recovered(const std::string& bytes, std::size_t sound) {
        const std::string part = file("b.part");
        const std::string video = file(std::string("b") + GetParam());
        test::write_file(part, bytes);
        const std::int64_t frames = frames_within(sound);
        if (frames == 0) {
            const test::Failure failure =
                test::failure_of([&] { recover_part(part, video, {.force = true}); });
            EXPECT_EQ(failure.code, ExitCode::kMismatch);
            EXPECT_THAT(failure.message, testing::HasSubstr("no whole chunk with a valid checksum"));
            return;
        }
        const RemuxResult result = recover_part(part, video, {.force = true});
        EXPECT_EQ(result.frames, frames) << sound;
        EXPECT_EQ(result.truncated,
                  bytes.size() > *std::find_if(ends_.rbegin(), ends_.rend(),
                                               [&](std::size_t end) { return end <= sound; }))
            << sound;
    }

    VideoDef def_ = small_video({2, 1});
    std::string path_ = file(std::string("a") + GetParam());
    std::int64_t chunk_ = 0;
    std::vector<std::size_t> ends_;  ///< of the chunks
    std::string bytes_;
};

TEST_P(PartOf, EndsWithItsLastWholeChunk) {
    expect_recovered(bytes_, bytes_.size());
    for (const std::size_t end : ends_) {
        for (const std::size_t before : {0, 1, 30, 300})
            expect_recovered(bytes_.substr(0, end - before), end - before);
        // Within the head of the next fragment, with which libav gives up on all.
        for (const std::size_t after : {1, 100, 264})
            if (end < bytes_.size()) expect_recovered(bytes_.substr(0, end + after), end);
    }
}

TEST_P(PartOf, EndsBeforeAChangedByte) {
    for (int i = 0; i < 8; ++i) {
        const std::size_t at = (2 * i + 1) * bytes_.size() / 16;
        std::string changed = bytes_;
        changed[at] = static_cast<char>(changed[at] ^ 1);
        expect_recovered(changed, at);
    }
}

TEST_P(PartOf, IsGoneOnWithBeforeAChangedByte) {
    const std::int64_t all = 4 * chunk_;
    const std::string whole = file(std::string("whole") + GetParam());
    VideoWriter uninterrupted(whole, def_, {"A swing", "{}"}, {});
    write(uninterrupted, 0, all);
    uninterrupted.finish();
    std::string changed = bytes_;
    changed[(ends_[0] + ends_[1]) / 2] ^= 1;
    test::write_file(part_path(path_), changed);
    VideoWriter writer(check_video_output(path_, def_, "", false, false, 0, all, true), {"A swing", "{}"});
    ASSERT_EQ(writer.frames(), chunk_);
    write(writer, chunk_, all);
    writer.finish();
    EXPECT_TRUE(test::read_file(path_) == test::read_file(whole));
}

INSTANTIATE_TEST_SUITE_P(All, PartOf,
                         testing::Values(".mp4", ".mov", ".webm", ".mkv", ".gif", ".apng", ".webp"),
                         [](const auto& each) { return std::string(each.param + 1); });

}  // namespace
}  // namespace corda::media
