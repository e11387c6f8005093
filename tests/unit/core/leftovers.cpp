#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "corda/core/output_file.hpp"
#include "support/command.hpp"

namespace corda {
namespace {

class Leftovers : public testing::Test {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

    test::ScratchFolder folder_;
};

TEST_F(Leftovers, OfKilledProcessesAloneAreRemoved) {
    const auto leave_one = [this] {
        if (::fork() == 0) {
            OutputFile output(file("a"));
            output.write(std::string(100'000, 'x'));
            ::_exit(0);  // no destructor runs, as after SIGKILL
        }
        int status = 0;
        ::wait(&status);
    };
    leave_one();
    leave_one();
    EXPECT_EQ(folder_.files().size(), 2U);
    OutputFile living(file("a"));
    const std::vector<std::string> others{"a.12g4.tmp", "a..tmp", "a.tmp", "b.1234.tmp", "a.1234.tmp.png"};
    for (const std::string& name : others) test::write_file(file(name), "precious");
    std::filesystem::create_symlink("b.1234.tmp", file("a.77.tmp"));
    remove_leftovers(file("a"));
    std::vector<std::string> kept = others;
    kept.emplace_back("a.77.tmp");
    kept.push_back(std::filesystem::path(living.temporary_path()).filename().string());
    EXPECT_THAT(folder_.files(), testing::UnorderedElementsAreArray(kept));
    remove_leftovers(file("no/such/folder/a"));
}

TEST_F(Leftovers, OfManyOutputsAreRemovedAtOnce) {
    for (const char* const name : {"0001.png.12ab.tmp", "0002.png.ff.tmp", "0003.jpg.ff.tmp", "0004.png",
                                   "0005.png.xyz.tmp", "0006.png..tmp", "7.tmp"})
        test::write_file(file(name), "text");
    remove_leftovers(folder_.path(), [](const std::string& name) { return name.ends_with(".png"); });
    EXPECT_THAT(folder_.files(), testing::ElementsAre("0003.jpg.ff.tmp", "0004.png", "0005.png.xyz.tmp",
                                                      "0006.png..tmp", "7.tmp"));
}

}  // namespace
}  // namespace corda
