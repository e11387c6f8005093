// A host without free resources, and encoders that do not return.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "support/command.hpp"

namespace corda {
namespace {

using test::run_corda;
using test::run_shell;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

#ifndef CORDA_SANITIZE  // whose run time must be loaded first and takes terabytes of address space

const char* const kSceneOfScarcity = R"(schema = 1
[world]
duration = 1
[[rope]]
hang = { links = 6, length = 1.0, angle_deg = 30.0 }
[video]
size = [160, 90]
fps = 30
)";

const std::string kFaults = "LD_PRELOAD=" FOREIGN_FAULTS " ";

class Scarcity : public testing::Test {
  protected:
    test::ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kSceneOfScarcity);
    std::string video_ = folder_.file("a.mp4");
};

TEST_F(Scarcity, FoldersAreComparedWithoutMoreThreads) {
    ASSERT_EQ(run_corda({"still", scene_, "--at", "0,0.1,0.2", "-o", folder_.file("a")}).exit_code, 0);
    const auto result =
        run_corda({"compare", folder_.file("a"), folder_.file("a")}, kFaults + "THREADS_TO_START=0");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("3 pictures: all equal"));
}

TEST_F(Scarcity, AnEncoderThatNeverReturnsIsATemporaryFailure) {
    const std::string hangs = kFaults + "X264_HANGS_FROM_PX=0";
    const auto rendered = run_corda({"render", scene_, "-o", video_}, hangs);
    EXPECT_EQ(rendered.exit_code, 75) << rendered.err;
    EXPECT_THAT(rendered.err, HasSubstr("libx264 did not end within 5 s"));
    EXPECT_EQ(folder_.files(), std::vector<std::string>{"scene.toml"});
    const auto examined = run_corda({"doctor"}, hangs);
    EXPECT_EQ(examined.exit_code, 75) << examined.err;
    EXPECT_THAT(examined.out, HasSubstr("without libx264: libx264 did not end within 5 s"));
}

TEST_F(Scarcity, ASignalEndsTheTrialOfAnEncoder) {
    const auto result =
        run_shell(kFaults + "X264_HANGS_FROM_PX=0 " + test::quoted(CORDA_PROGRAM) + " render " + scene_ +
                  " -o " + video_ + " & pid=$!; sleep 2; kill -TERM $pid; wait $pid");
    EXPECT_EQ(result.exit_code, 143) << result.err;
    EXPECT_THAT(result.err, HasSubstr("interrupted; nothing was written"));
}

TEST_F(Scarcity, AnEncoderWithoutItsThreadsIsATemporaryFailure) {
    for (const char* const codec : {"libx265", "libsvtav1"}) {
        const auto result =
            run_corda({"render", scene_, "-o", video_, "--codec", codec}, kFaults + "THREADS_TO_START=0");
        EXPECT_EQ(result.exit_code, 75) << codec << result.err;
        EXPECT_THAT(result.err, HasSubstr("ulimit -u")) << codec;
        EXPECT_THAT(result.err, Not(HasSubstr("did not end"))) << codec;  // it is not started
    }
}

TEST_F(Scarcity, AnEncoderWithoutMemoryIsATemporaryFailure) {
    for (const char* const kib : {"200000", "400000", "600000", "700000"}) {
        for (const char* const codec : {"libx265", "libsvtav1"}) {
            const auto result = run_shell("ulimit -v " + std::string(kib) + "; exec timeout -s KILL 60 " +
                                          test::quoted(CORDA_PROGRAM) + " render " + scene_ + " --force -o " +
                                          video_ + " --jobs 1 --codec " + codec);
            EXPECT_TRUE(result.exit_code == 75 || result.exit_code == 0) << kib << codec << result.err;
            EXPECT_TRUE(result.exit_code == 0 || result.err.find("ulimit -v") != std::string::npos)
                << kib << codec << result.err;
        }
    }
}

#endif

}  // namespace
}  // namespace corda
