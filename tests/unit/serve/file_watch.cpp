#include "corda/serve/file_watch.hpp"

#include <gmock/gmock.h>
#include <sys/inotify.h>

#include <string>
#include <vector>

#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda::serve {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(FileWatch, NamesAMissingFolder) {
    const test::Failure failure = test::failure_of([] { const FileWatch file("/nowhere/a.toml"); });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message, AllOf(HasSubstr("'/nowhere/a.toml'"), HasSubstr("check the path"),
                                       Not(HasSubstr("inotify"))));
}

TEST(FileWatch, SeesOtherBytesAndAnotherFileUnderTheName) {
    const test::ScratchFolder folder;
    const std::string path = folder.write("a.toml", "1");
    FileWatch file(path);
    EXPECT_FALSE(file.wait(0));
    test::write_file(path, "12");
    EXPECT_TRUE(file.wait(0));
    EXPECT_FALSE(file.wait(0));
    static_cast<void>(test::run_shell("cd " + folder.path() + " && printf 12 >b && mv b a.toml"));
    EXPECT_TRUE(file.wait(0));
    static_cast<void>(folder.write("b.toml", "other"));
    EXPECT_FALSE(file.wait(0));
}

TEST(FileWatch, SeesASaveWithTheTimeAndSizeOfTheLast) {
    const test::ScratchFolder folder;
    const std::string path = folder.write("a.toml", "1");
    FileWatch file(path);
    const std::string save =
        "cd " + folder.path() + " && touch -r a.toml time && printf 2 >a.toml && touch -r time a.toml";
    static_cast<void>(test::run_shell(save));
    EXPECT_TRUE(file.wait(0));
    EXPECT_FALSE(file.wait(0));
}

TEST(FileWatch, LooksAtTheFileIfTheSystemReportsNothing) {
    const test::ScratchFolder folder;
    const std::string path = folder.write("a.toml", "1");
    EXPECT_EQ(FileWatch(path).warning(), "");
    std::vector<Descriptor> held;  // all that the system gives
    do held.emplace_back(::inotify_init1(IN_CLOEXEC));
    while (held.back());
    FileWatch file(path);
    EXPECT_THAT(file.warning(), AllOf(HasSubstr(path), HasSubstr("5 times a second"),
                                      HasSubstr("fs.inotify.max_user_instances")));
    EXPECT_FALSE(file.wait(0));
    test::write_file(path, "12");
    EXPECT_TRUE(file.wait(0));
}

}  // namespace
}  // namespace corda::serve
