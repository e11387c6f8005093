// A host that starts no further threads.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "support/command.hpp"

namespace corda {
namespace {

using test::run_corda;
using testing::HasSubstr;

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

TEST_F(Scarcity, AnEncoderWithoutItsThreadsIsATemporaryFailure) {
    for (const char* const codec : {"libx265", "libsvtav1"}) {
        const auto result =
            run_corda({"render", scene_, "-o", video_, "--codec", codec}, kFaults + "THREADS_TO_START=0");
        EXPECT_EQ(result.exit_code, 75) << codec << result.err;
        EXPECT_THAT(result.err, HasSubstr("ulimit -u")) << codec;
    }
}

#endif

}  // namespace
}  // namespace corda
