// `corda help`: the text of --help, and the keys of a scene file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "corda/scene/schema.hpp"
#include "support/command.hpp"

namespace corda {
namespace {

using test::run_corda;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(Help, EqualsTheHelpOption) {
    const auto general = run_corda({"help"});
    EXPECT_EQ(general.exit_code, 0);
    EXPECT_EQ(general.out, run_corda({"--help"}).out);
    EXPECT_THAT(general.out, AllOf(HasSubstr("corda help codes"), Not(HasSubstr("Exit codes:"))));
    const auto still = run_corda({"help", "still"});
    EXPECT_EQ(still.exit_code, 0);
    EXPECT_EQ(still.out, run_corda({"still", "--help"}).out);
    EXPECT_THAT(still.out, HasSubstr("--at"));
    EXPECT_THAT(run_corda({"help", "sheet"}).out, HasSubstr("draw a contact sheet"));
}

TEST(Help, ListsTheKeysOfAScene) {
    const auto scene = run_corda({"help", "scene"});
    EXPECT_EQ(scene.exit_code, 0);
    EXPECT_EQ(scene.out, scene::keys_text());
    for (const char* const table : {"style", "overlay.texts"})
        EXPECT_EQ(run_corda({"help", table}).out, scene::keys_text(table));
    EXPECT_EQ(run_corda({"help", "golden"}).out,
              run_corda({"golden", "--help"}).out + "\n" + scene::keys_text("golden"));
    EXPECT_THAT(scene::keys_text("overlay.texts"), AllOf(HasSubstr("from"), Not(HasSubstr("trail_s"))));
    const auto help = nlohmann::json::parse(run_corda({"help", "scene", "--json"}).out);
    EXPECT_EQ(help.at("help"), scene::keys_text());
}

TEST(Help, FindsKeysTablesOptionsAndTopics) {
    EXPECT_THAT(run_corda({"help", "codes"}).out, AllOf(HasSubstr("Exit codes:\n    0  "), HasSubstr("130")));
    EXPECT_THAT(
        run_corda({"help", "wind"}).out,
        AllOf(HasSubstr("world.wind: [vx, vy], m/s; the velocity of the air"), Not(HasSubstr("style."))));
    EXPECT_THAT(run_corda({"help", "trail_s"}).out, HasSubstr("style.trail_s: "));
    EXPECT_THAT(run_corda({"help", "style.trail_s"}).out, testing::StartsWith("style.trail_s: "));
    EXPECT_THAT(run_corda({"help", "Friction"}).exit_code, 2);
    EXPECT_THAT(run_corda({"help", "resume"}).out, HasSubstr("corda render --resume: "));
}

TEST(Help, HasTheCommandsAndOptionsOfTheReadme) {
    std::istringstream readme(test::read_file(CORDA_EXAMPLES "/../README.md"));
    int commands = 0;
    for (std::string line; std::getline(readme, line);) {
        if (!line.starts_with("corda ")) continue;
        std::istringstream words(line.substr(0, line.find(" #")));
        std::string program;
        std::string command;
        words >> program >> command;
        const std::string help = run_corda({"help", command}).out;
        EXPECT_THAT(help, HasSubstr("Usage:")) << line;
        for (std::string word; words >> word;) {
            if (word.starts_with("--")) {
                EXPECT_THAT(help, HasSubstr(word)) << line;
            }
        }
        ++commands;
    }
    EXPECT_GT(commands, 15);
}

TEST(Help, WritesAManualPageOfAllCommands) {
    const test::ScratchFolder folder;
    const std::string page = folder.write("corda.1", run_corda({"help", "man"}).out);
    const auto lint = test::run_shell("mandoc -T lint -W error " + page);
    EXPECT_EQ(lint.exit_code, 0) << lint.out;
    const std::string text = test::run_shell("mandoc -T ascii " + page + " | sed 's/.\x08//g'").out;
    for (const char* const words : {"corda render", "corda help", "--width-mm", "130", "CORDA_BACKEND"})
        EXPECT_THAT(text, HasSubstr(words));
}

TEST(Help, SuggestsTheNearestTopic) {
    const auto near = run_corda({"help", "scen"});
    EXPECT_EQ(near.exit_code, 2);
    EXPECT_THAT(near.err, HasSubstr("there is no help on \"scen\"; did you mean scene?"));
    EXPECT_THAT(run_corda({"help", "magic"}).err,
                HasSubstr("known are render, still, strobe, sheet, simulate"));
}

}  // namespace
}  // namespace corda
