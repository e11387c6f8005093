#include "corda/core/output_file.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <utility>

#include "support/command.hpp"
#include "support/failure.hpp"
#include "support/file_size_limit.hpp"

namespace {

int renameat2_errno = 0;  // that the call below returns; 0: it does its work

}  // namespace

// Replaces the C library's function, so that a test can imitate a file system without it.
extern "C" int renameat2(int from_folder, const char* from, int to_folder, const char* to,
                         unsigned flags) noexcept {
    errno = renameat2_errno;
    if (renameat2_errno != 0) return -1;
    return static_cast<int>(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}

namespace corda {
namespace {

namespace fs = std::filesystem;
using test::Failure;
using test::failure_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class OutputFiles : public testing::Test {
  protected:
    ~OutputFiles() override { renameat2_errno = 0; }

    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

    test::ScratchFolder folder_;
};

/// Writes `text` to a new file or, with `force`, to any file.
void save(const std::string& path, const std::string& text, bool force = false) {
    OutputFile file(path, {.force = force});
    file.write(text);
    file.commit();
}

void expect_io_error(const std::function<void()>& work, const std::string& words) {
    const Failure failure = failure_of(work);
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, HasSubstr(words));
}

unsigned mode_of(const std::string& path) {
    struct stat status {};
    EXPECT_EQ(::stat(path.c_str(), &status), 0);
    return status.st_mode & 07777U;
}

TEST_F(OutputFiles, GetTheirNameWhenTheyAreComplete) {
    OutputFile output(file("a.csv"));
    output.write("one\n");
    EXPECT_THAT(folder_.files(), ElementsAre(StartsWith("a.csv.")));
    output.write("two\n");
    output.commit();
    EXPECT_THAT(folder_.files(), ElementsAre("a.csv"));
    EXPECT_EQ(test::read_file(file("a.csv")), "one\ntwo\n");
}

TEST_F(OutputFiles, KeepTheOrderOfShortAndLongWrites) {
    std::string expected;
    OutputFile output(file("a"));
    for (const std::size_t length : {1, 70'000, 5, 65'536, 65'535, 3, 40'000, 40'000, 0}) {
        const std::string text(length, static_cast<char>('a' + expected.size() % 26));
        output.write(text);
        expected += text;
    }
    output.commit();
    EXPECT_EQ(test::read_file(file("a")), expected);
}

TEST_F(OutputFiles, InMemoryHaveWhatWasWritten) {
    OutputFile output{OutputFile::InMemory()};
    EXPECT_EQ(output.bytes(), "");
    output.write("short");
    EXPECT_EQ(output.bytes(), "short");
    const std::string text(70'000, 'x');
    output.write(text);
    output.write("end");
    EXPECT_EQ(output.bytes(), "short" + text + "end");
    EXPECT_EQ(test::read_file(output.temporary_path()), output.bytes());
}

TEST_F(OutputFiles, HaveThePermissionsOfNewFiles) {
    const mode_t old_mask = ::umask(027);
    save(file("a"), "text");
    ::umask(old_mask);
    EXPECT_EQ(mode_of(file("a")), 0640U);
}

TEST_F(OutputFiles, AreRemovedWithoutCommit) {
    {
        OutputFile output(file("a"));
        output.write(std::string(100'000, 'x'));
    }
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(OutputFiles, NamesOfAnyLengthWork) {
    const std::string name(255, 'n');
    save(file(name), "text");
    EXPECT_THAT(folder_.files(), ElementsAre(name));
}

TEST_F(OutputFiles, TemporaryNamesAreUnique) {
    const OutputFile a(file("a"));
    const OutputFile b(file("a"));
    EXPECT_NE(a.temporary_path(), b.temporary_path());
}

TEST_F(OutputFiles, AnExistingFileIsNotReplacedWithoutForce) {
    test::write_file(file("a"), "precious");
    expect_io_error([&] { save(file("a"), "new"); }, "--force");
    EXPECT_EQ(test::read_file(file("a")), "precious");
    save(file("a"), "new", true);
    EXPECT_EQ(test::read_file(file("a")), "new");
    EXPECT_THAT(folder_.files(), ElementsAre("a"));
}

/// An error number of renameat2.
class Renames : public OutputFiles, public testing::WithParamInterface<int> {
  protected:
    Renames() { renameat2_errno = GetParam(); }
};

TEST_P(Renames, GiveTheName) {
    save(file("a"), "new");
    EXPECT_EQ(test::read_file(file("a")), "new");
    EXPECT_THAT(folder_.files(), ElementsAre("a"));
}

TEST_P(Renames, DoNotReplaceAFileThatAppearedMeanwhile) {
    OutputFile output(file("a"));
    output.write("new");
    test::write_file(file("a"), "precious");
    expect_io_error([&] { output.commit(); }, "the new file is '" + file("a.part") + "'");
    EXPECT_EQ(test::read_file(file("a")), "precious");
    EXPECT_EQ(test::read_file(file("a.part")), "new");
    EXPECT_THAT(folder_.files(), ElementsAre("a", "a.part"));
}

TEST_P(Renames, DoNotReplaceALinkThatAppearedMeanwhile) {
    test::write_file(file("victim"), "precious");
    OutputFile output(file("a"));
    output.write("new");
    fs::create_symlink("victim", file("a"));
    expect_io_error([&] { output.commit(); }, "--force");
    EXPECT_EQ(test::read_file(file("victim")), "precious");
}

INSTANTIATE_TEST_SUITE_P(FileSystems, Renames, testing::Values(0, EINVAL));

TEST_F(OutputFiles, OtherFailuresOfTheRenameAreReportedAndLeaveNoFile) {
    renameat2_errno = EIO;
    expect_io_error([&] { save(file("a"), "new"); }, "cannot rename");
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(OutputFiles, WithForceReplaceAFileThatAppearedMeanwhile) {
    OutputFile output(file("a"), {.force = true});
    output.write("new");
    test::write_file(file("a"), "old");
    output.commit();
    EXPECT_EQ(test::read_file(file("a")), "new");
}

TEST_F(OutputFiles, OfTwoWritersToOneNameTheFirstWins) {
    OutputFile first(file("a"));
    OutputFile second(file("a"));
    first.write("first");
    second.write("second");
    first.commit();
    expect_io_error([&] { second.commit(); }, "appeared");
    EXPECT_EQ(test::read_file(file("a")), "first");
    EXPECT_EQ(test::read_file(file("a.part")), "second");
}

/// Runs `work` as an unprivileged user, if the test is privileged.
void as_nobody(const std::string& folder, const std::function<void()>& work) {
    constexpr uid_t kNobody = 65'534;
    const bool is_root = ::geteuid() == 0;
    if (is_root) {
        ASSERT_EQ(::chown(folder.c_str(), kNobody, kNobody), 0);
        ASSERT_EQ(::setegid(kNobody), 0);
        ASSERT_EQ(::seteuid(kNobody), 0);
    }
    work();
    if (is_root) {
        ASSERT_EQ(::seteuid(0), 0);
        ASSERT_EQ(::setegid(0), 0);
    }
}

TEST_F(OutputFiles, ForceReplacesASymbolicLinkAndNotItsTarget) {
    test::write_file(file("real"), "old");
    fs::create_symlink("real", file("a"));
    save(file("a"), "new", true);
    EXPECT_FALSE(fs::is_symlink(file("a")));
    EXPECT_EQ(test::read_file(file("a")), "new");
    EXPECT_EQ(test::read_file(file("real")), "old");
}

TEST_F(OutputFiles, ALinkToAMissingFileCountsAsExisting) {
    fs::create_symlink("missing", file("a"));
    expect_io_error([&] { save(file("a"), "new"); }, "--force");
    expect_io_error([&] { check_output(file("a"), "", false); }, "--force");
    save(file("a"), "new", true);
    EXPECT_EQ(test::read_file(file("a")), "new");
}

TEST_F(OutputFiles, ALinkToItselfIsAnError) {
    fs::create_symlink("a", file("a"));
    expect_io_error([&] { save(file("a"), "new", true); }, "symbolic links");
}

TEST_F(OutputFiles, AFullDiskIsReported) {
    // /dev/full accepts no byte.
    expect_io_error([&] { save("/dev/full", "text"); }, "free some space");
    expect_io_error([&] { save("/dev/full", std::string(1'000'000, 'x')); }, "No space left");
    // A limit on the size of files stops a write to an ordinary one.
    const Failure failure = failure_of([&] {
        const test::FileSizeLimit limit(4096);
        save(file("a"), std::string(5000, 'x'));
    });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, HasSubstr("ulimit"));
    EXPECT_THAT(folder_.files(), IsEmpty());
}

TEST_F(OutputFiles, ADeviceIsWrittenDirectly) {
    OutputFile output("/dev/null");
    EXPECT_EQ(output.temporary_path(), "");
    output.write("text");
    output.commit();
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    check_output("/dev/null", "", false, OutputKind::kStream);
    expect_io_error([] { check_output("/dev/null", "", true); }, "ordinary file");
}

TEST_F(OutputFiles, APipeIsWrittenDirectlyAndStays) {
    ASSERT_EQ(::mkfifo(file("pipe").c_str(), 0600), 0);
    std::string received;
    std::thread reader([&] { received = test::read_file(file("pipe")); });
    check_output(file("pipe"), "", false, OutputKind::kStream);
    save(file("pipe"), "text");
    reader.join();
    EXPECT_EQ(received, "text");
    EXPECT_TRUE(fs::is_fifo(file("pipe")));
    EXPECT_THAT(folder_.files(), ElementsAre("pipe"));
}

TEST_F(OutputFiles, StandardOutputIsWrittenDirectly) {
    for (const char* const name : {"-", "/dev/stdout"}) {
        check_output(name, "", false, OutputKind::kStream);
        testing::internal::CaptureStdout();
        save(name, "text");
        EXPECT_EQ(testing::internal::GetCapturedStdout(), "text") << name;
    }
}

TEST_F(OutputFiles, AnUnfinishedFileCanBeKept) {
    for (const std::string text : {"first", "second", "third"}) {
        OutputFile output(file("a"), {.force = text == "third"});
        output.write(text);
        const std::string kept = output.keep();
        // The second one must not replace the first.
        EXPECT_EQ(kept == file("a.part"), text != "second") << kept;
        EXPECT_EQ(test::read_file(kept), text);
    }
    EXPECT_EQ(test::read_file(file("a.part")), "third");
    EXPECT_EQ(folder_.files().size(), 2U);
}

TEST_F(OutputFiles, APredictableNameOfAnotherUserIsNotFollowed) {
    test::write_file(file("victim"), "precious");
    for (const char* const name : {"a.part", "a.tmp"}) fs::create_symlink("victim", file(name));
    save(file("a"), "new");
    OutputFile unfinished(file("a"), {.force = true});
    unfinished.write("unfinished");
    EXPECT_EQ(unfinished.keep(), file("a.part"));
    EXPECT_FALSE(fs::is_symlink(file("a.part")));
    EXPECT_EQ(test::read_file(file("victim")), "precious");
}

TEST_F(OutputFiles, AMissingFolderIsReported) {
    expect_io_error([&] { save(file("no/such/folder/a"), "new"); }, "the folder must exist");
    expect_io_error([&] { check_output(file("no/such/folder/a"), "", true); }, "no/such/folder");
}

TEST_F(OutputFiles, AFolderThatCannotBeEnteredIsReportedAsSuch) {
    fs::create_directory(file("closed"));
    fs::create_directory(file("closed/inner"));
    ASSERT_EQ(::chmod(file("closed").c_str(), 0), 0);
    as_nobody(folder_.path(), [&] {
        expect_io_error([&] { check_output(file("closed/inner/a"), "", true); }, "Permission denied");
    });
    ASSERT_EQ(::chmod(file("closed").c_str(), 0700), 0);
    test::write_file(file("text"), "");
    expect_io_error([&] { check_output(file("text/a"), "", true); }, "Not a directory");
    expect_io_error([&] { check_output(file("text/folder/a"), "", true); }, "Not a directory");
    expect_io_error([&] { check_output(file("none/a"), "", true); }, "does not exist; make it first");
}

TEST_F(OutputFiles, AFolderIsRefused) {
    expect_io_error([&] { save(folder_.path(), "new", true); }, "not of a folder");
    expect_io_error([&] { check_output(folder_.path(), "", true); }, "not of a folder");
    EXPECT_EQ(failure_of([&] { check_output(folder_.path() + "/", "", true); }).code, ExitCode::kUsage);
    EXPECT_EQ(failure_of([&] { check_output("", "", true); }).code, ExitCode::kUsage);
}

TEST_F(OutputFiles, AFolderThatCannotBeWrittenToIsRefusedEarly) {
    as_nobody(folder_.path(), [&] {
        ASSERT_EQ(::chmod(folder_.path().c_str(), 0500), 0);
        EXPECT_EQ(failure_of([&] { check_output(file("a"), "", false); }).code, ExitCode::kIo);
    });
    ASSERT_EQ(::chmod(folder_.path().c_str(), 0700), 0);
}

TEST_F(OutputFiles, AFolderThatMayBeWrittenAndNotReadIsWrittenTo) {
    as_nobody(folder_.path(), [&] {
        ASSERT_EQ(::chmod(folder_.path().c_str(), 01333), 0);
        check_output(file("a"), "", false);
        EXPECT_EQ(failure_of([&] { save(file("a"), "new", false); }).message, "");
        EXPECT_EQ(failure_of([&] { save(file("a"), "newer", true); }).message, "");
    });
    ASSERT_EQ(::chmod(folder_.path().c_str(), 0700), 0);
    EXPECT_EQ(test::read_file(file("a")), "newer");
    EXPECT_EQ(folder_.files().size(), 1U);
}

TEST_F(OutputFiles, TheInputIsNeverReplaced) {
    const std::string input = folder_.write("scene.toml", "scene");
    fs::create_hard_link(input, file("alias"));
    for (const std::string& path : {input, file("alias"), file("./scene.toml")}) {
        const Failure failure = failure_of([&] { check_output(path, input, true); });
        EXPECT_EQ(failure.code, ExitCode::kUsage) << path;
        EXPECT_THAT(failure.message, HasSubstr("input"));
    }
    check_output(file("other"), input, false);
    check_output(file("other"), file("missing input"), false);
}

}  // namespace
}  // namespace corda
