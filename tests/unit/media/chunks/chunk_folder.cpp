#include "corda/media/chunks/chunk_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <thread>
#include <vector>

#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda::media {
namespace {

namespace fs = std::filesystem;
using Use = ChunkFolder::Use;
using test::failure_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Frames 7 <= k < 25 in chunks of 10.
Manifest small_manifest(const std::string& scene = "a") {
    return {.made_from = {{"scene", scene}},
            .fps = {10, 1},
            .first = 7,
            .end = 25,
            .per_chunk = 10,
            .title = "A swing",
            .comment = R"({"a":1})"};
}

class ChunkFolders : public testing::Test {
  protected:
    [[nodiscard]] ChunkFolder open(Use use) const { return {path_, use, small_manifest()}; }
    static void add(ChunkFolder& folder, std::int64_t number, std::int64_t frames,
                    const std::string& bytes = "text") {
        folder.add(number, frames, ".mp4", [&](OutputFile& file) {
            file.write(bytes);
            file.flush();
        });
    }

    test::ScratchFolder folder_;
    std::string path_ = folder_.file("a.mp4.parts");
};

TEST_F(ChunkFolders, HaveTheChunksOfAManifest) {
    const Manifest manifest = small_manifest();
    EXPECT_EQ(manifest.first_chunk(), 0);
    EXPECT_EQ(manifest.end_chunk(), 3);
    EXPECT_EQ(manifest.frames_of(0), 3);
    EXPECT_EQ(manifest.frames_of(1), 10);
    EXPECT_EQ(manifest.frames_of(2), 5);
    static_cast<void>(open(Use::kNew));
    const auto found = read_manifest(path_);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->made_from, manifest.made_from);
    EXPECT_EQ(found->fps, manifest.fps);
    EXPECT_EQ(found->end, 25);
    EXPECT_EQ(found->title, "A swing");
    EXPECT_EQ(found->comment, manifest.comment);
}

TEST_F(ChunkFolders, RunFromTheFirstChunkToTheFirstGap) {
    ChunkFolder folder = open(Use::kNew);
    EXPECT_EQ(folder.run().gap, 0);
    add(folder, 0, 3);
    add(folder, 2, 5);
    ChunkRun run = folder.run();
    EXPECT_EQ(run.frames, 3);
    EXPECT_EQ(run.gap, 1);
    EXPECT_EQ(run.left_out, 1);
    EXPECT_FALSE(run.is_damaged);
    add(folder, 1, 4);  // short
    run = folder.run();
    EXPECT_EQ(run.frames, 7);
    EXPECT_EQ(run.gap, 1);
    add(folder, 1, 10);
    run = folder.run();
    EXPECT_EQ(run.frames, 18);
    EXPECT_EQ(run.gap, std::nullopt);
    EXPECT_EQ(run.left_out, 1);  // the short one
    test::write_file(run.chunks[1].path, "tExt");
    fs::remove(path_ + "/" + fs::path(chunk_files(path_)[2].path).filename().string());
    run = folder.run();
    EXPECT_EQ(run.frames, 3);
    EXPECT_EQ(run.gap, 1);
    EXPECT_TRUE(run.is_damaged);
    folder.remove();
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(ChunkFolders, TakeNoChunkOfAnotherVideo) {
    std::string name;
    {
        ChunkFolder other(path_, Use::kNew, small_manifest("b"));
        add(other, 0, 3);
        name = chunk_files(path_)[0].path;
        EXPECT_EQ(failure_of([&] { static_cast<void>(open(Use::kContinue)); }).message,
                  "another render is writing '" + path_ + "'; wait for its end, or choose another name");
    }
    EXPECT_THAT(failure_of([&] { static_cast<void>(open(Use::kContinue)); }).message,
                HasSubstr("has chunks of another render"));
    test::write_file(path_ + "/corda.json", "");
    EXPECT_THAT(failure_of([&] { static_cast<void>(open(Use::kContinue)); }).message,
                HasSubstr("is damaged"));
    fs::remove(path_ + "/corda.json");
    ChunkFolder folder = open(Use::kContinue);
    EXPECT_TRUE(fs::exists(name));
    EXPECT_TRUE(folder.run().is_damaged);
}

TEST_F(ChunkFolders, KeepEqualChunksOnce) {
    ChunkFolder one = open(Use::kShare);
    ChunkFolder two = open(Use::kShare);
    add(one, 1, 10);
    add(two, 1, 10);
    EXPECT_EQ(chunk_files(path_).size(), 1U);
    EXPECT_THAT(failure_of([&] { static_cast<void>(open(Use::kContinue)); }).message,
                HasSubstr("another render is writing"));
}

TEST_F(ChunkFolders, OldOnesAreReplacedOnlyWithForce) {
    {
        ChunkFolder folder = open(Use::kNew);
        add(folder, 0, 3);
    }
    for (const auto& work : std::vector<std::function<void()>>{[&] { ChunkFolder::check(path_, Use::kNew); },
                                                               [&] { static_cast<void>(open(Use::kNew)); }}) {
        const test::Failure failure = failure_of(work);
        EXPECT_EQ(failure.code, ExitCode::kIo);
        EXPECT_THAT(failure.message, HasSubstr("holds an interrupted render"));
    }
    EXPECT_EQ(chunk_files(path_).size(), 1U);
    EXPECT_EQ(open(Use::kContinue).run().frames, 3);
    ChunkFolder::check(path_, Use::kReplace);
    static_cast<void>(open(Use::kReplace));
    EXPECT_THAT(chunk_files(path_), IsEmpty());
    ChunkFolder::check(path_, Use::kNew);  // one without a chunk has nothing to lose
}

TEST_F(ChunkFolders, ThatCordaHasNotMadeStay) {
    fs::create_directory(path_);
    test::write_file(path_ + "/thesis.tex", "precious");
    for (const Use use : {Use::kNew, Use::kReplace, Use::kContinue, Use::kShare}) {
        for (const auto& work : std::vector<std::function<void()>>{[&] { ChunkFolder::check(path_, use); },
                                                                   [&] { static_cast<void>(open(use)); }}) {
            const test::Failure failure = failure_of(work);
            EXPECT_EQ(failure.code, ExitCode::kIo);
            EXPECT_THAT(failure.message, HasSubstr("holds other files"));
        }
    }
    EXPECT_EQ(test::read_file(path_ + "/thesis.tex"), "precious");
    // A foreign file among the chunks stays, too.
    fs::rename(path_ + "/thesis.tex", folder_.file("thesis.tex"));
    ChunkFolder folder = open(Use::kNew);
    add(folder, 0, 3);
    fs::rename(folder_.file("thesis.tex"), path_ + "/thesis.tex");
    folder.remove();
    EXPECT_EQ(fs::directory_entry(path_ + "/thesis.tex").file_size(), 8U);
    EXPECT_THAT(chunk_files(path_), IsEmpty());
}

TEST_F(ChunkFolders, OtherThingsOfThatNameAreErrorsAndStay) {
    fs::create_directory(folder_.file("victim"));
    for (const char* const kind : {"file", "pipe", "link"}) {
        if (kind == std::string("file")) test::write_file(path_, "precious");
        const bool is_pipe = kind == std::string("pipe");
        ASSERT_TRUE(!is_pipe || ::mkfifo(path_.c_str(), 0600) == 0);
        const bool is_link = kind == std::string("link");
        if (is_link) fs::create_symlink("victim", path_);
        for (const auto& work :
             std::vector<std::function<void()>>{[&] { ChunkFolder::check(path_, Use::kReplace); },
                                                [&] { static_cast<void>(open(Use::kReplace)); }}) {
            const test::Failure failure = failure_of(work);
            EXPECT_EQ(failure.code, ExitCode::kIo) << kind;
            EXPECT_THAT(failure.message, HasSubstr(is_link ? "is a symbolic link" : "is no folder"));
        }
        fs::remove(path_);
    }
    const std::string path = parts_path(path_ + std::string(250, 'a'));
    EXPECT_THAT(failure_of([&] { ChunkFolder::check(path, Use::kNew); }).message,
                HasSubstr("File name too long"));
    EXPECT_THAT(folder_.files(), ElementsAre("victim"));
}

TEST_F(ChunkFolders, AreUsedByOneOfManyThatStartAtOnce) {
    std::atomic<int> holders{0};
    std::atomic<int> most{0};
    std::atomic<int> started{0};
    const auto work = [&] {
        for (int round = 0; round < 30; ++round) {
            try {
                ChunkFolder folder = open(Use::kReplace);
                most = std::max(most.load(), ++holders);
                ++started;
                EXPECT_TRUE(folder.is_named());
                --holders;
                if (round % 2 == 0) folder.remove();
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ExitCode::kIo) << error.what();
            }
        }
    };
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) threads.emplace_back(work);
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(most, 1);
    EXPECT_GT(started, 0);
}

TEST_F(ChunkFolders, OfUnsoundManifestsAreRefused) {
    static_cast<void>(open(Use::kNew));
    const std::string text = test::read_file(path_ + "/corda.json");
    for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
             {"\"first\": 7", "\"first\": -7"},
             {"\"first\": 7", "\"first\": 25"},
             {"\"end\": 25", "\"end\": 9223372036854775807"},
             {"\"per_chunk\": 10", "\"per_chunk\": 0"},
             {"\"per_chunk\": 10", "\"per_chunk\": 9223372036854775807"},
             {"\"den\": 1", "\"den\": 0"},
             {"\"title\"", "\"tilte\""},
             {"{", "[["}}) {
        std::string changed = text;
        ASSERT_NE(changed.find(from), std::string::npos) << from;
        changed.replace(changed.find(from), from.size(), to);
        test::write_file(path_ + "/corda.json", changed);
        const test::Failure failure = failure_of([&] { static_cast<void>(read_manifest(path_)); });
        EXPECT_EQ(failure.code, ExitCode::kMismatch) << to;
        EXPECT_THAT(failure.message, HasSubstr("is damaged")) << to;
    }
}

TEST_F(ChunkFolders, WhoseManifestIsNoFileAreRefused) {
    static_cast<void>(open(Use::kNew));
    const std::string manifest = path_ + "/corda.json";
    fs::rename(manifest, folder_.file("manifest"));
    for (const char* const kind : {"pipe", "link"}) {
        if (kind == std::string("pipe"))
            ASSERT_EQ(::mkfifo(manifest.c_str(), 0600), 0);
        else
            fs::create_symlink(folder_.file("manifest"), manifest);
        const test::Failure read = failure_of([&] { static_cast<void>(read_manifest(path_)); });
        EXPECT_EQ(read.code, ExitCode::kMismatch) << kind;
        EXPECT_THAT(read.message, HasSubstr("'" + manifest + "' is no ordinary file")) << kind;
        EXPECT_THAT(failure_of([&] { static_cast<void>(open(Use::kContinue)); }).message,
                    HasSubstr("holds other files"))
            << kind;
        fs::remove(manifest);
    }
}

}  // namespace
}  // namespace corda::media
