// Paths that not even root can examine, like a folder without permissions for other users: an input/output
// error, never an internal one.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "support/command.hpp"

namespace corda {
namespace {

using test::run_corda;
using testing::HasSubstr;

const char* const kSceneOfUnreachable = R"(schema = 1
[world]
duration = 0.1
[[rope]]
hang = { links = 3, length = 1.0, angle_deg = 30.0 }
[video]
size = [64, 64]
fps = 30
[golden]
at = [0.0]
)";

class Unreachable : public testing::Test {
  protected:
    Unreachable() { std::filesystem::create_symlink("loop", folder_.file("loop")); }

    void expect_refusal(const std::vector<std::string>& command, const std::string& place) {
        const auto result = run_corda(command);
        EXPECT_EQ(result.exit_code, 6) << testing::PrintToString(command) << result.err;
        EXPECT_THAT(result.err, HasSubstr(place)) << testing::PrintToString(command);
        EXPECT_THAT(result.err, testing::Not(HasSubstr("internal"))) << testing::PrintToString(command);
    }

    test::ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kSceneOfUnreachable);
    std::string loop_ = folder_.file("loop");
};

TEST_F(Unreachable, OutputsAreNamed) {
    const std::vector<std::pair<std::vector<std::string>, std::string>> commands{
        {{"still", scene_, "--at", "0", "-o"}, "/a.png"},
        {{"still", scene_, "--at", "0", "-o"}, "/a"},
        {{"still", scene_, "--at", "0", "--dry-run", "-o"}, "/a.png"},
        {{"still", scene_, "--at", "0", "--dry-run", "-o"}, "/a"},
        {{"strobe", scene_, "--at", "0", "-o"}, "/a.svg"},
        {{"sheet", scene_, "--at", "0", "-o"}, "/a.png"},
        {{"simulate", scene_, "-o"}, "/a.csv"},
        {{"render", scene_, "-o"}, "/a.mp4"},
        {{"render", scene_, "--dry-run", "-o"}, "/%04d.png"},
        {{"golden", scene_, "--update", "--dir"}, "/a"},
        {{"init"}, "/a.toml"},
    };
    const std::string long_name = folder_.file(std::string(300, 'x'));
    for (const std::string& place : {loop_, long_name}) {
        for (auto [command, name] : commands) {
            command.push_back(place + name);
            expect_refusal(command, place);
        }
    }
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"loop", "scene.toml"}));
}

TEST_F(Unreachable, InputsAreNamed) {
    expect_refusal({"render", loop_ + "/a.toml", "-o", folder_.file("a.mp4")}, loop_);
    expect_refusal({"render", "--from", loop_ + "/a.mp4", "-o", folder_.file("a.mp4")}, loop_);
    expect_refusal({"compare", loop_ + "/a.png", scene_}, "cannot read '" + loop_ + "/a.png'");
    expect_refusal({"golden", scene_, "--dir", loop_ + "/a"}, loop_);
    expect_refusal({"golden", loop_ + "/a", "--dir", folder_.path()}, loop_);
}

}  // namespace
}  // namespace corda
