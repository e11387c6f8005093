#include "corda/media/chunks/join.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cctype>
#include <filesystem>

#include "support/failure.hpp"
#include "unit/media/video_support.hpp"

namespace corda::media {
namespace {

namespace fs = std::filesystem;
using test::failure_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(Video, RecoveredIsTheWholeFolder) {
    abandon_video(file("a.mp4"), small_video({24000, 1001}), 60);
    const Recovered result = recover(file("a.mp4.parts"), file("a.mp4"));
    EXPECT_EQ(result.frames, 60);
    EXPECT_EQ(result.left_out, 0);
    EXPECT_TRUE(verify(file("a.mp4")).ok());
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4"));
}

TEST_F(Video, RecoveredDoesNotReplaceAnExistingFileWithoutForce) {
    abandon_video(file("a.mp4"), small_video(), 8);
    test::write_file(file("a.mp4"), "precious");
    EXPECT_EQ(failure_of([&] { recover(file("a.mp4.parts"), file("a.mp4")); }).code, ExitCode::kIo);
    EXPECT_EQ(test::read_file(file("a.mp4")), "precious");
    EXPECT_EQ(recover(file("a.mp4.parts"), file("a.mp4"), {.force = true}).frames, 8);
    EXPECT_TRUE(verify(file("a.mp4")).ok());
}

TEST_F(Video, AFolderThatIsBeingWrittenIsNotRecovered) {
    VideoWriter writer(file("a.mp4"), small_video(), {});
    write_frames(writer, 8);
    const test::Failure failure = failure_of([&] { recover(file("a.mp4.parts"), file("b.mp4")); });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, HasSubstr("another render is writing"));
    writer.finish();
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4"));
}

TEST_F(Video, AFolderStaysIfChunksAreLeftOutOrItIsToBeKept) {
    const auto chunks = abandon_video(file("a.mp4"), small_video({10, 1}), 70);  // the fourth one is short
    ASSERT_EQ(chunks.size(), 4U);
    const Recovered kept = recover(file("a.mp4.parts"), file("b.mp4"), {}, true);
    EXPECT_EQ(kept.frames, 70);
    EXPECT_THAT(kept.gap, HasSubstr("chunk 3 (frames 60..79) is not whole"));
    EXPECT_FALSE(kept.removed || kept.is_damaged);
    damage(chunks[1].path, 3000);
    const Recovered damaged = recover(file("a.mp4.parts"), file("a.mp4"));
    EXPECT_EQ(damaged.frames, 20);
    EXPECT_EQ(damaged.gap, "chunk 1 (frames 20..39) is damaged");
    EXPECT_TRUE(damaged.is_damaged && !damaged.removed);
    EXPECT_EQ(damaged.left_out, 3);
    EXPECT_TRUE(verify(file("a.mp4")).ok());
    fs::remove(chunks[1].path);
    EXPECT_EQ(recover(file("a.mp4.parts"), file("a.mp4"), {.force = true}).gap,
              "chunk 1 (frames 20..39) is missing");
    fs::remove(chunks[0].path);
    const test::Failure none = failure_of([&] { recover(file("a.mp4.parts"), file("c.mp4")); });
    EXPECT_EQ(none.code, ExitCode::kMismatch);
    EXPECT_THAT(none.message, HasSubstr("no chunk to begin with: chunk 0 (frames 0..19) is missing"));
}

TEST_F(Video, AForgedChunkIsRefused) {
    VideoDef large = small_video();
    large.width_px *= 2;
    std::string other;
    {
        VideoWriter writer(file("b.mp4"), large, {});
        for (int k = 0; k < 60; ++k) writer.write(Image(2 * kWidth, kHeight), {});
        other = test::read_file(chunk_files(file("b.mp4.parts"))[0].path);
    }
    const auto chunks = abandon_video(file("a.mp4"), small_video(), 120);
    const std::string whole = test::read_file(chunks[1].path);
    // A chunk with this content whose checksum matches.
    const auto forge = [&](const std::string& bytes) {
        fs::remove(chunk_files(file("a.mp4.parts"))[1].path);
        ChunkFolder folder(file("a.mp4.parts"), ChunkFolder::Use::kContinue,
                           read_manifest(file("a.mp4.parts")).value());
        folder.add(1, 60, ".mp4", [&](OutputFile& output) {
            output.write(bytes);
            output.flush();
        });
    };
    const auto expect_refused = [&](const std::string& bytes, const std::string& words) {
        forge(bytes);
        const auto failure =
            failure_of([&] { recover(file("a.mp4.parts"), file("c.mp4"), {.force = true}); });
        EXPECT_EQ(failure.code, ExitCode::kMismatch);
        EXPECT_THAT(failure.message, HasSubstr(words));
    };
    expect_refused("no video", "is damaged");
    expect_refused(other, "it is of another video, or its encoder settings");
    expect_refused(whole.substr(0, whole.size() - 700), "is damaged");
    std::string slow = whole;
    slow.at(slow.find("stts") + 19) = 2;  // the last byte of a frame's duration
    expect_refused(slow, "frame 1 is not where it belongs");
    std::string flat = whole;
    const std::string coded = {kWidth >> 8, static_cast<char>(kWidth & 255), kHeight >> 8,
                               static_cast<char>(kHeight & 255)};
    flat.replace(flat.find(coded, flat.find("stsd")), 4, std::string(4, '\0'));
    expect_refused(flat, "is damaged");
    std::string recolored = whole;
    const std::size_t colors = recolored.find("\"patches\":[[");
    for (std::size_t at = colors; recolored.at(at) != ']'; ++at)
        if (std::isdigit(recolored[at]) != 0) recolored[at] = '1';
    expect_refused(recolored, "failed its check, and its chunks stay in '" + file("a.mp4.parts") + "':\n");
    forge(whole);
    EXPECT_EQ(recover(file("a.mp4.parts"), file("c.mp4")).frames, 120);
}

TEST_F(Video, AShortChunkMayEndInOtherColorsThanItBegan) {
    {
        VideoWriter writer(file("a.mp4"), small_video(), {});
        for (const auto& color :
             std::vector<std::array<std::uint8_t, 3>>{{200, 0, 0}, {0, 0, 200}, {0, 160, 0}}) {
            Image image(kWidth, kHeight);
            fill(image, image.rect(), color);
            writer.write(image, {image.rect()});
        }
        EXPECT_EQ(writer.abandon(), file("a.mp4.parts"));
    }
    EXPECT_EQ(recover(file("a.mp4.parts"), file("a.mp4")).frames, 3);
}

TEST_F(Video, AChunkMustBeAFile) {
    const auto chunks = abandon_video(file("a.mp4"), small_video(), 130);
    const std::string& second = chunks[1].path;
    const std::string parts = file("a.mp4.parts");
    fs::rename(second, file("second.mp4"));
    for (const char* const kind : {"pipe", "link"}) {
        if (kind == std::string("pipe"))
            ASSERT_EQ(::mkfifo(second.c_str(), 0600), 0);
        else
            fs::create_symlink(file("second.mp4"), second);
        const Recovered recovered = recover(parts, file("a.mp4"), {.force = true});
        EXPECT_EQ(recovered.gap, "chunk 1 (frames 60..119) is missing") << kind;
        EXPECT_EQ(recovered.left_out, 1) << kind;  // the third
        EXPECT_NO_THROW(check_chunks_in_child(parts, read_manifest(parts).value())) << kind;
        fs::remove(second);
    }
}

/// Two whole chunks and a short one, of a video of one ending.
class ChunksOf : public Video, public testing::WithParamInterface<const char*> {
  protected:
    ChunksOf() {
        VideoWriter writer(path_, def_, {"A swing", "{}"}, {});
        chunk_ = writer.manifest().per_chunk;
        write(writer, 0, 2 * chunk_ + chunk_ / 2);
        EXPECT_EQ(writer.abandon(), parts_path(path_));
        files_ = chunk_files(parts_path(path_));
    }

    static void write(VideoWriter& writer, std::int64_t first, std::int64_t end) {
        for (std::int64_t k = first; k < end; ++k) {
            const Image image = frame_image(k);
            writer.write(image, {image.rect()});
        }
    }

    VideoDef def_ = small_video({2, 1});
    std::string path_ = file(std::string("a") + GetParam());
    std::int64_t chunk_ = 0;
    std::vector<ChunkFile> files_;
};

TEST_P(ChunksOf, PlayByThemselves) {
    const std::vector<std::int64_t> frames{chunk_, chunk_, chunk_ / 2};
    for (std::size_t i = 0; i < files_.size(); ++i) {
        EXPECT_EQ(files_[i].frames, frames[i]);
        EXPECT_EQ(verify(files_[i].path).frames, frames[i]) << files_[i].path;
    }
}

TEST_P(ChunksOf, AnyChangedOrMissingByteIsFound) {
    const std::string bytes = test::read_file(files_[1].path);
    const std::string video = file(std::string("b") + GetParam());
    for (std::size_t i = 0; i < 8; ++i) {
        std::string changed = bytes;
        if (i == 0) changed.pop_back();
        if (i > 0) changed[(2 * i - 1) * bytes.size() / 16] ^= 1;
        test::write_file(files_[1].path, changed);
        const Recovered recovered = recover(parts_path(path_), video, {.force = true});
        EXPECT_EQ(recovered.frames, chunk_);
        EXPECT_TRUE(recovered.is_damaged);
    }
}

TEST_P(ChunksOf, AreGoneOnWithAndDamagedOnesMadeAgain) {
    const std::int64_t all = 3 * chunk_;
    const std::string whole = file(std::string("whole") + GetParam());
    VideoWriter uninterrupted(check_video_output({.path = whole, .def = def_, .end = all}),
                              {"A swing", "{}"});
    write(uninterrupted, 0, all);
    uninterrupted.finish();
    fs::remove_all(parts_path(path_));
    const CheckedVideo video = check_video_output({.path = path_, .def = def_, .end = all, .resume = true});
    {
        VideoWriter writer(video, {"A swing", "{}"});
        write(writer, 0, all);
    }
    const std::string second = chunk_files(parts_path(path_))[1].path;
    // A damaged copy of a sound chunk does no harm, whatever their order.
    for (const char* const checksum : {"00000000", "ffffffff"}) {
        const std::string copy = std::string(second).replace(second.rfind('-') + 1, 8, checksum);
        test::write_file(copy, "damaged");
        EXPECT_THAT(VideoWriter(video, {"A swing", "{}"}).damaged_chunks(), IsEmpty());
    }
    damage(second, 500);
    VideoWriter writer(video, {"A swing", "{}"});
    EXPECT_EQ(writer.frames(), 2 * chunk_);
    EXPECT_THAT(writer.damaged_chunks(), ElementsAre(1));
    EXPECT_THAT(writer.lacking_chunks(), ElementsAre(1));
    write(writer, chunk_, 2 * chunk_);
    writer.finish();
    EXPECT_TRUE(test::read_file(path_) == test::read_file(whole));
    EXPECT_FALSE(fs::exists(parts_path(path_)));
}

INSTANTIATE_TEST_SUITE_P(All, ChunksOf, testing::Values(".mp4", ".mov", ".webm", ".mkv", ".gif"),
                         [](const auto& each) { return std::string(each.param + 1); });

}  // namespace
}  // namespace corda::media
