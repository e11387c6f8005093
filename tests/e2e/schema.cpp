// `corda schema` against another implementation of JSON Schema, and `corda completion` in the shells.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "support/command.hpp"

namespace corda {
namespace {

using test::run_corda;
using testing::HasSubstr;

/// The verdict of python3-jsonschema on each of these scenes: "ok", or the problem.
std::vector<std::string> judge(const test::ScratchFolder& folder, const std::vector<std::string>& scenes) {
    test::write_file(folder.file("schema.json"), run_corda({"schema"}).out);
    test::write_file(folder.file("judge.py"), R"(import json, sys, tomllib
from jsonschema import Draft7Validator
schema = json.load(open(sys.argv[1]))
Draft7Validator.check_schema(schema)
validator = Draft7Validator(schema)
for path in sys.argv[2:]:
    errors = [error.message for error in validator.iter_errors(tomllib.load(open(path, "rb")))]
    print(errors[0].replace("\n", " ") if errors else "ok")
)");
    std::string command = "/usr/bin/python3 " + folder.file("judge.py") + " " + folder.file("schema.json");
    for (const std::string& scene : scenes) command += " " + test::quoted(scene);
    const auto result = test::run_shell(command);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::vector<std::string> verdicts;
    std::istringstream lines(result.out);
    for (std::string line; std::getline(lines, line);) verdicts.push_back(line);
    EXPECT_EQ(verdicts.size(), scenes.size());
    return verdicts;
}

std::vector<std::string> scenes_in(const std::filesystem::path& folder) {
    std::vector<std::string> scenes;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".toml") scenes.push_back(entry.path().string());
    return scenes;
}

TEST(Schema, AcceptsEveryExampleAndGolden) {
    const test::ScratchFolder folder;
    std::vector<std::string> scenes = scenes_in(CORDA_EXAMPLES);
    const std::vector<std::string> goldens = scenes_in(std::string(CORDA_GOLDENS) + "/scenes");
    scenes.insert(scenes.end(), goldens.begin(), goldens.end());
    ASSERT_GE(scenes.size(), 40U);
    const std::vector<std::string> verdicts = judge(folder, scenes);
    for (std::size_t i = 0; i < scenes.size(); ++i) EXPECT_EQ(verdicts[i], "ok") << scenes[i];
}

TEST(Schema, RejectsTheScenesThatCordaRejects) {
    const test::ScratchFolder folder;
    const std::string head = "schema = 1\n";
    const std::string rope = "[[rope]]\npoints = [[0, 0], [1, 0]]\n";
    const std::vector<std::string> broken{
        rope,                                                        // no schema
        "schema = 2\n" + rope,                                       // another schema
        head,                                                        // no body
        head + "[world]\ngravty = 9.81\n" + rope,                    // an unknown key
        head + "[world]\nduration = 0\n" + rope,                     // out of range
        head + "[world]\nduration = \"long\"\n" + rope,              // not a number
        head + "[[rope]]\nmass = 1.0\n",                             // no shape
        head + rope + "hang = { links = 3, length = 1.0 }\n",        // two shapes
        head + "[[rope]]\nhang = { links = 3 }\n",                   // no length
        head + "[[rope]]\npoints = [[0, 0]]\n",                      // one particle
        head + rope + "color = \"#12345\"\n",                        // not a colour
        head + "[[net]]\ngrid = { columns = 3, rows = 2 }\n",        // no spacing
        head + rope + "[solver]\nmethod = \"euler\"\n",              // no method
        head + rope + "[solver]\nmethod = \"rattle\"\norder = 5\n",  // no order
        head + rope + "[video]\nsize = [640]\n",                     // one side
        head + rope + "[video]\nfps = \"fast\"\n",                   // not a rate
        head + rope + "[video]\nsubframes = 1\n",                    // out of range
        head + rope + "[style]\ntheme = \"light\"\n",                // not a theme
        head + rope + "[overlay]\ntime = 1\n",                       // not a boolean
        head + rope + "[camera]\ncenter = [0, 0, 0]\n",              // three coordinates
        head + rope + "[[solver.bodies]]\nropes = [0]\n",            // no method
    };
    std::vector<std::string> scenes;
    for (std::size_t i = 0; i < broken.size(); ++i) {
        scenes.push_back(folder.write("broken" + std::to_string(i) + ".toml", broken[i]));
        EXPECT_EQ(run_corda({"simulate", scenes.back()}).exit_code, 3) << broken[i];
    }
    const std::vector<std::string> verdicts = judge(folder, scenes);
    for (std::size_t i = 0; i < broken.size(); ++i) EXPECT_NE(verdicts[i], "ok") << broken[i];
}

TEST(Completion, ParsesInItsShells) {
    const test::ScratchFolder folder;
    for (const std::string shell : {"bash", "zsh", "fish"}) {
        const auto completion = run_corda({"completion", shell});
        EXPECT_EQ(completion.exit_code, 0);
        const auto checked = test::run_shell(shell + " -n " + folder.write("corda." + shell, completion.out));
        EXPECT_EQ(checked.exit_code, 0) << checked.err;
    }
    const std::string bash = "source " + folder.file("corda.bash") + "; COMP_WORDS=(corda ";
    EXPECT_EQ(test::run_shell(bash + "st); COMP_CWORD=1; _corda; echo ${COMPREPLY[@]}").out,
              "still strobe\n");
    EXPECT_EQ(test::run_shell(bash + "render --cr); COMP_CWORD=2; _corda; echo ${COMPREPLY[@]}").out,
              "--crf\n");
    const std::string fish = "source " + folder.file("corda.fish") + "; complete -C 'corda still --fram'";
    EXPECT_THAT(test::run_shell("fish -c " + test::quoted(fish)).out,
                HasSubstr("--frame\tframes of the video from 0"));
    EXPECT_EQ(run_corda({"completion", "tcsh"}).exit_code, 2);
}

}  // namespace
}  // namespace corda
