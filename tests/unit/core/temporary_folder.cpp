#include "corda/core/temporary_folder.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

namespace fs = std::filesystem;

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
