// The libraries of videos, which the program loads only to encode or decode.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/command.hpp"

namespace corda {
namespace {

using test::run_corda;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

const char* const kSceneOfLibraries =
    "schema = 1\n[[rope]]\nhang = { links = 4, length = 1.0, angle_deg = 30.0 }\n"
    "[world]\nduration = 0.1\n[video]\nsize = [64, 64]\nfps = 30\n";

class Libraries : public testing::Test {
  protected:
    /// Output of the dynamic loader about the files that a command loads.
    std::string loaded_by(const std::vector<std::string>& command) {
        const auto result = run_corda(command, "LD_DEBUG=files");
        EXPECT_EQ(result.exit_code, 0) << command.front();
        return result.err;
    }

    test::ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kSceneOfLibraries);
    std::string picture_ = folder_.file("a.png");
    std::string video_ = folder_.file("a.mp4");
};

TEST_F(Libraries, OfVideosAreLoadedToEncodeAndDecode) {
    for (const std::vector<std::string>& command : {std::vector<std::string>{"--version"},
                                                    {"--help"},
                                                    {"help", "scene"},
                                                    {"examples"},
                                                    {"plan", scene_},
                                                    {"simulate", scene_},
                                                    {"still", scene_, "--at", "0.1", "-o", picture_},
                                                    {"golden", "--help"}}) {
        EXPECT_THAT(loaded_by(command), AllOf(HasSubstr("calling init: /"), Not(HasSubstr("libavcodec.so"))))
            << command.front();
    }
    EXPECT_THAT(loaded_by({"render", scene_, "-o", video_}), HasSubstr("libavcodec.so"));
}

TEST_F(Libraries, OfVideosThatAreMissingAreNamedWithTheirPackages) {
    ASSERT_EQ(run_corda({"render", scene_, "-o", video_}).exit_code, 0);
    const std::string hidden = "LD_PRELOAD=" HIDDEN_LIBRARIES " CORDA_TEST_HIDES=" LIBAVFORMAT;
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"render", scene_, "-o", folder_.file("b.mp4")},
          {"still", "--from", video_, "--at", "0", "-o", folder_.file("b.png")}}) {
        const auto result = run_corda(command, hidden);
        EXPECT_EQ(result.exit_code, 5) << command.front() << result.err;
        EXPECT_THAT(result.err, AllOf(HasSubstr("cannot be loaded"),
                                      ContainsRegex("apt-get install libavcodec[0-9]+ libavformat[0-9]+")))
            << command.front();
    }
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"a.mp4", "scene.toml"}));
    EXPECT_EQ(run_corda({"still", scene_, "--at", "0", "-o", picture_}, hidden).exit_code, 0);
    const auto doctor = run_corda({"doctor"}, hidden);
    EXPECT_EQ(doctor.exit_code, 5);
    EXPECT_THAT(doctor.out,
                AllOf(HasSubstr("This machine can draw."), HasSubstr("no   .mp4"), HasSubstr("libavformat")));
}

}  // namespace
}  // namespace corda
