// File names and other texts of the user that are not UTF-8 or that a terminal would interpret.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include <nlohmann/json.hpp>

#include "corda/media/defs.hpp"
#include "support/command.hpp"

namespace corda {
namespace {

using nlohmann::json;
using test::run_corda;
using test::run_shell;
using testing::HasSubstr;

const char* const kSceneOfNames = R"(schema = 1
[world]
duration = 0.1
[[rope]]
hang = { links = 3, length = 1.0, angle_deg = 30.0 }
[video]
size = [64, 64]
fps = 30
)";

class Names : public testing::Test {
  protected:
    test::ScratchFolder folder_;
};

TEST_F(Names, AreBytesAsFilesAndEscapedElsewhere) {
    const std::string scene = folder_.write("caf\xe9\x1b[31m.toml", kSceneOfNames);
    const std::string video = folder_.file("caf\xe9.mp4");
    const auto rendered = run_corda({"render", scene, "-o", video, "--json"});
    ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
    EXPECT_THAT(rendered.err, HasSubstr("corda: caf\\xe9\\x1b[31m: "));
    EXPECT_EQ(json::parse(rendered.out)["output"], folder_.file("caf\\xe9.mp4"));
    const auto title =
        run_shell("ffprobe -v error -show_entries format_tags=title -of csv=p=0 " + test::quoted(video));
    EXPECT_EQ(title.out, "caf\\xe9\\x1b[31m\n");

    const auto still = run_corda({"still", scene, "--at", "0", "-o", folder_.path()});
    const std::string picture = folder_.file("caf\xe9\x1b[31m_0.0s.png");
    EXPECT_EQ(still.out, picture + "\n");  // a script needs the unchanged name
    EXPECT_EQ(read_png_info(picture).text[1],
              std::pair(std::string("Title"), std::string("caf\\xe9\\x1b[31m")));
}

TEST_F(Names, NeverReachTheTerminalRaw) {
    const std::string nasty = "\x1b[31m\x07\xc2\x9b\x9b";
    const std::string scene = folder_.write(nasty + ".toml", kSceneOfNames);
    const std::string broken =
        folder_.write("broken.toml", "schema = 1\n\"" + std::string("a\\u001bb\" = 1\n[wor\x1b[ld]\n"));
    const std::vector<std::vector<std::string>> commands{
        {nasty},
        {"help", nasty},
        {"plan", nasty},
        {"plan", broken},
        {"plan", scene, "--" + nasty},
        {"plan", scene, "--set", nasty},
        {"plan", scene, "--set", "a" + nasty + "=1"},
        {"plan", scene, "--set", "video.fps=" + nasty},
        {"plan", scene, "--size", nasty},
        {"render", scene, "-o", nasty},
        {"render", scene, "-o", nasty + ".mp4", "--frames", nasty},
        {"render", scene, "-o", nasty + ".mp4", "--backend", nasty},
        {"still", scene, "--at", nasty, "-o", folder_.path()},
        {"still", scene, "--at", "0", "-o", nasty + ".eps"},
        {"compare", nasty, nasty, "--max", nasty},
        {"compare", nasty, nasty}};
    for (std::vector<std::string> command : commands) {
        const auto result = run_corda(command);
        EXPECT_NE(result.exit_code, 0);
        EXPECT_THAT(result.err, HasSubstr("corda: error: "));
        EXPECT_EQ(result.err.find_first_of("\x1b\x07\x9b"), std::string::npos) << result.err;
        command.emplace_back("--json");
        const auto as_json = run_corda(command);
        const std::string message = json::parse(as_json.out)["error"]["message"];
        EXPECT_EQ(message.find_first_of("\x1b\x07\x9b"), std::string::npos) << message;
    }
    EXPECT_THAT(run_corda({"plan", scene, "-q"}).out, HasSubstr(nasty));
    for (const char* option : {" -q", " -q --json"}) {
        const std::string inner = test::quoted(CORDA_PROGRAM) + " still " + test::quoted(scene) +
                                  " --at 0 --force -o " + folder_.path() + option;
        const auto terminal = run_shell("script -qec " + test::quoted(inner) + " /dev/null");
        EXPECT_EQ(terminal.exit_code, 0) << terminal.out;
        EXPECT_EQ(terminal.out.find_first_of("\x1b\x07\x9b"), std::string::npos) << terminal.out;
        EXPECT_THAT(terminal.out, HasSubstr("[31m"));
    }
}

}  // namespace
}  // namespace corda
