#include "corda/core/file.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <functional>
#include <vector>

#include "corda/core/output_file.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

namespace fs = std::filesystem;
using test::failure_of;
using testing::HasSubstr;

TEST(Files, AreOpenedForReading) {
    const test::ScratchFolder folder;
    const FileHandle file = open_for_reading(folder.write("a", "text"));
    std::array<char, 8> bytes{};
    EXPECT_EQ(std::fread(bytes.data(), 1, bytes.size(), file.get()), 4U);
    EXPECT_STREQ(bytes.data(), "text");
    const int flags = ::fcntl(::fileno(file.get()), F_GETFD);
    EXPECT_EQ(flags & FD_CLOEXEC, FD_CLOEXEC);
}

TEST(Files, UnreadableOnesAreErrors) {
    const test::ScratchFolder folder;
    for (const std::string& path : {folder.file("missing"), folder.path(), folder.path() + "/no/such"}) {
        const test::Failure failure = failure_of([&] { static_cast<void>(open_for_reading(path)); });
        EXPECT_EQ(failure.code, ExitCode::kIo);
        EXPECT_THAT(failure.message, HasSubstr("cannot read '" + path + "'"));
    }
}

TEST(Files, HaveNamesWithoutNul) {
    const test::ScratchFolder folder;
    const std::string name = folder.file("a") + std::string("\0.png", 5);
    const std::vector<std::function<void()>> uses{
        [&] { static_cast<void>(open_for_reading(name)); }, [&] { make_folder(name); },
        [&] { check_output(name, "", true); }, [&] { const OutputFile file(name, {.force = true}); }};
    for (const auto& use : uses) {
        const test::Failure failure = failure_of(use);
        EXPECT_EQ(failure.code, ExitCode::kUsage);
        EXPECT_THAT(failure.message, HasSubstr("a\\x00.png' holds a NUL character"));
    }
    EXPECT_TRUE(folder.files().empty());
}

TEST(Files, HaveTheirSizes) {
    const test::ScratchFolder folder;
    EXPECT_EQ(file_size(folder.write("a", "text")), 4U);
    const test::Failure failure = failure_of([&] { static_cast<void>(file_size(folder.file("missing"))); });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, HasSubstr("cannot read '" + folder.file("missing") + "'"));
}

TEST(NewFiles, AreCreatedOnlyUnderFreeNames) {
    const test::ScratchFolder folder;
    const mode_t old_mask = ::umask(022);
    const Descriptor file = create_new(folder.file("a"), 0666);
    ::umask(old_mask);
    ASSERT_TRUE(file);
    struct stat status {};
    ASSERT_EQ(::fstat(file.get(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777U, 0644U);
    EXPECT_EQ(::fcntl(file.get(), F_GETFD) & FD_CLOEXEC, FD_CLOEXEC);
    fs::create_symlink("nowhere", folder.file("link"));
    for (const char* name : {"a", "link", "."}) {
        errno = 0;
        EXPECT_FALSE(create_new(folder.file(name), 0666)) << name;
        EXPECT_NE(errno, 0) << name;
    }
    EXPECT_FALSE(fs::exists(folder.file("nowhere")));
}

TEST(Descriptors, AreClosedOnceAndMove) {
    Descriptor a(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    const int number = a.get();
    Descriptor b(std::move(a));
    EXPECT_EQ(b.get(), number);
    EXPECT_EQ(b.close(), 0);
    EXPECT_FALSE(b);
    EXPECT_EQ(b.close(), 0);
    EXPECT_EQ(::fcntl(number, F_GETFD), -1);
}

TEST(Descriptors, WritingToABadOneIsReported) {
    EXPECT_EQ(write_all(-1, "text"), EBADF);
    EXPECT_EQ(write_all(-1, ""), 0);
}

TEST(Descriptors, OfPipesNeedNoSync) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    const Descriptor reader(ends[0]);
    const Descriptor writer(ends[1]);
    EXPECT_EQ(failure_of([&] { sync_file(writer, "a pipe"); }).code, ExitCode::kOk);
    const test::Failure failure = failure_of([] { sync_file(Descriptor(), "nothing"); });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, HasSubstr("cannot sync to disk 'nothing'"));
}

TEST(FileErrors, HaveAReasonAndARemedy) {
    const test::Failure failure = failure_of([] { fail_file("write", "a.mp4", ENOSPC); });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_EQ(
        failure.message,
        "cannot write 'a.mp4': No space left on device; free some space on that disk, or write to another "
        "one");
    EXPECT_EQ(failure_of([] { fail_file("write", "a.mp4", EPIPE); }).message,
              "cannot write 'a.mp4': Broken pipe");
}

TEST(FileErrors, GiveARemedyThatFitsTheAction) {
    EXPECT_EQ(failure_of([] { fail_file("write", "a.mp4", EACCES); }).message,
              "cannot write 'a.mp4': Permission denied; choose a place you may write to, or change the "
              "permissions");
    EXPECT_EQ(
        failure_of([] { fail_file("read", "a.mp4", EACCES); }).message,
        "cannot read 'a.mp4': Permission denied; change its permissions, or run corda as a user who may "
        "read it");
}

TEST(Folders, AreMadeWithTheirParents) {
    const test::ScratchFolder folder;
    make_folder(folder.file("a/b/c"));
    EXPECT_TRUE(fs::is_directory(folder.file("a/b/c")));
    make_folder(folder.file("a/b/c"));
    static_cast<void>(folder.write("file", ""));
    EXPECT_EQ(failure_of([&] { make_folder(folder.file("file/d")); }).code, ExitCode::kIo);
    EXPECT_EQ(failure_of([&] { check_folder(folder.file("file/d")); }).code, ExitCode::kIo);
    for (const std::string& name :
         {folder.file("a"), folder.file("a/new/one/"), std::string("new"), std::string()})
        EXPECT_EQ(failure_of([&] { check_folder(name); }).code, ExitCode::kOk) << name;
    sync_folder_of(folder.file("a/b"));
    sync_folder_of("a name in this folder");
    EXPECT_EQ(failure_of([&] { sync_folder_of(folder.file("no/a")); }).code, ExitCode::kIo);
}

}  // namespace

namespace {

/// Sets TMPDIR for one test.
class TemporaryFolders : public testing::Test {
  protected:
    TemporaryFolders() {
        if (const char* const value = std::getenv("TMPDIR")) old_ = value;
    }
    ~TemporaryFolders() override {
        if (old_.empty())
            unsetenv("TMPDIR");
        else
            setenv("TMPDIR", old_.c_str(), 1);
    }

    test::ScratchFolder scratch_;

  private:
    std::string old_;
};

TEST_F(TemporaryFolders, AreRemovedWithTheirContents) {
    setenv("TMPDIR", scratch_.path().c_str(), 1);
    {
        const TemporaryFolder a;
        const TemporaryFolder b;
        EXPECT_NE(a.file(""), b.file(""));
        test::write_file(a.file("video.mp4"), "frames");
        EXPECT_EQ(scratch_.files().size(), 2U);
    }
    EXPECT_TRUE(scratch_.files().empty());
}

TEST_F(TemporaryFolders, FailWithARemedyIfTheyCannotBeMade) {
    for (const std::string& place :
         {scratch_.file("missing"), scratch_.write("file", ""), std::string("/proc")}) {
        setenv("TMPDIR", place.c_str(), 1);
        const auto failure = test::failure_of([] { const TemporaryFolder folder; });
        EXPECT_EQ(failure.code, ExitCode::kIo) << place;
        EXPECT_THAT(failure.message, testing::HasSubstr("set TMPDIR to a folder")) << place;
    }
}

}  // namespace

}  // namespace corda
