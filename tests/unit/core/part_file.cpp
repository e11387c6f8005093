#include "corda/core/part_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <optional>
#include <thread>
#include <vector>

#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

namespace fs = std::filesystem;
using test::failure_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class PartFiles : public testing::Test {
  protected:
    test::ScratchFolder folder_;
    std::string path_ = folder_.file("a.mp4.part");
};

TEST_F(PartFiles, StayUntilTheyAreRemoved) {
    {
        PartFile part = PartFile::create(path_, {});
        ASSERT_EQ(write_all(part.descriptor(), "text"), 0);
        part.sync();
    }
    EXPECT_EQ(test::read_file(path_), "text");
    PartFile::open(path_).remove();
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(PartFiles, AnOldOneIsReplacedOnlyWithForce) {
    test::write_file(path_, "old");
    for (const auto& work : std::vector<std::function<void()>>{
             [&] { PartFile::check(path_, {}); }, [&] { static_cast<void>(PartFile::create(path_, {})); }}) {
        const test::Failure failure = failure_of(work);
        EXPECT_EQ(failure.code, ExitCode::kIo);
        EXPECT_THAT(failure.message, HasSubstr("interrupted render"));
    }
    EXPECT_EQ(test::read_file(path_), "old");
    PartFile::check(path_, {.force = true});
    const PartFile part = PartFile::create(path_, {.force = true});
    EXPECT_EQ(test::read_file(path_), "");
}

TEST_F(PartFiles, AnEmptyUnlockedOneIsReplaced) {
    test::write_file(path_, "");
    PartFile::check(path_, {});
    const PartFile part = PartFile::create(path_, {});
    EXPECT_EQ(failure_of([&] { static_cast<void>(PartFile::create(path_, {})); }).code, ExitCode::kIo);
    EXPECT_TRUE(part.is_named());
}

TEST_F(PartFiles, AreLockedByOneAtATime) {
    std::optional<PartFile> part(PartFile::create(path_, {}));
    for (const auto& work : std::vector<std::function<void()>>{
             [&] { PartFile::check(path_, {}); }, [&] { PartFile::check(path_, {.force = true}); },
             [&] { static_cast<void>(PartFile::create(path_, {})); },
             [&] { static_cast<void>(PartFile::create(path_, {.force = true})); },
             [&] { static_cast<void>(PartFile::open(path_)); }}) {
        EXPECT_THAT(failure_of(work).message, HasSubstr("another render is writing"));
    }
    ASSERT_EQ(write_all(part->descriptor(), "text"), 0);
    EXPECT_EQ(test::read_file(path_), "text");
    part.reset();
    EXPECT_EQ(failure_of([&] { static_cast<void>(PartFile::open(path_)); }).code, ExitCode::kOk);
}

TEST_F(PartFiles, WithTooLongNamesDoNotExist) {
    const std::string path = part_path(path_ + std::string(250, 'a'));
    for (const bool force : {false, true}) {
        const test::Failure failure = failure_of([&] { PartFile::check(path, {.force = force}); });
        EXPECT_EQ(failure.code, ExitCode::kIo);
        EXPECT_THAT(failure.message, HasSubstr("File name too long; choose a shorter name"));
    }
}

TEST_F(PartFiles, AreLockedByOneOfManyThatStartAtOnce) {
    std::atomic<int> holders{0};
    std::atomic<int> most{0};
    std::atomic<int> started{0};
    const auto work = [&] {
        for (int round = 0; round < 300; ++round) {
            try {
                PartFile part = PartFile::create(path_, {.force = true});
                most = std::max(most.load(), ++holders);
                ++started;
                struct stat held {};
                struct stat named {};
                // The name refers to the locked file.
                EXPECT_EQ(::fstat(part.descriptor(), &held), 0);
                EXPECT_EQ(::stat(path_.c_str(), &named), 0);
                EXPECT_EQ(held.st_ino, named.st_ino);
                --holders;
                if (round % 2 == 0) part.remove();
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ExitCode::kIo);
            }
        }
    };
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) threads.emplace_back(work);
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(most, 1);
    EXPECT_GT(started, 0);
}

TEST_F(PartFiles, LinksAreNotFollowed) {
    test::write_file(folder_.file("victim"), "precious");
    fs::create_symlink("victim", path_);
    EXPECT_EQ(failure_of([&] { static_cast<void>(PartFile::open(path_)); }).code, ExitCode::kIo);
    EXPECT_EQ(failure_of([&] { static_cast<void>(PartFile::create(path_, {})); }).code, ExitCode::kIo);
    EXPECT_THAT(failure_of([&] { static_cast<void>(PartFile::create(path_, {.force = true})); }).message,
                HasSubstr("is a symbolic link"));
    EXPECT_TRUE(fs::is_symlink(path_));
    EXPECT_EQ(test::read_file(folder_.file("victim")), "precious");
}

TEST_F(PartFiles, ADanglingLinkIsNotFollowed) {
    fs::create_symlink("missing", path_);
    EXPECT_EQ(failure_of([&] { static_cast<void>(PartFile::create(path_, {})); }).code, ExitCode::kIo);
    EXPECT_THAT(folder_.files(), ElementsAre("a.mp4.part"));
}

TEST_F(PartFiles, AFolderOrAPipeOfThatNameIsNamedAndStays) {
    for (const char* const kind : {"a folder", "a pipe"}) {
        if (kind == std::string("a pipe"))
            ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
        else
            fs::create_directory(path_);
        for (const std::function<void()>& work :
             {std::function<void()>([&] { PartFile::check(path_, {.force = true}); }),
              std::function<void()>([&] { static_cast<void>(PartFile::create(path_, {.force = true})); }),
              std::function<void()>([&] { static_cast<void>(PartFile::open(path_)); })})
            EXPECT_THAT(failure_of(work).message, HasSubstr(std::string("is ") + kind));
        EXPECT_TRUE(fs::exists(path_));
        fs::remove(path_);
    }
}

TEST_F(PartFiles, OtherThingsOfThatNameAreErrors) {
    fs::create_directory(path_);
    EXPECT_EQ(failure_of([&] { static_cast<void>(PartFile::create(path_, {.force = true})); }).code,
              ExitCode::kIo);
    EXPECT_EQ(failure_of([&] { static_cast<void>(PartFile::open(folder_.file("missing"))); }).code,
              ExitCode::kIo);
    EXPECT_EQ(failure_of([&] { static_cast<void>(PartFile::create(folder_.file("no/a"), {})); }).code,
              ExitCode::kIo);
}

}  // namespace
}  // namespace corda
