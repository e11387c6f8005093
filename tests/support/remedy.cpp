#include "support/remedy.hpp"

#include <gmock/gmock.h>

#include <sstream>

#include "support/command.hpp"

namespace corda::test {
namespace {

void replace_all(std::string& text, const std::string& was, const std::string& is) {
    for (std::size_t at = text.find(was); at != std::string::npos; at = text.find(was, at + is.size()))
        text.replace(at, was.size(), is);
}

CommandResult run(const std::string& scene, const std::string& command) {
    const ScratchFolder folder;
    write_file(folder.file("scene.toml"), scene);
    std::istringstream words(command);
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) {
        // In this order, because the random name of a scratch folder may contain "DIR".
        replace_all(word, "SCENE", "DIR/scene.toml");
        replace_all(word, "DIR", folder.path());
        arguments.push_back(word == "EMPTY" ? "" : word);
    }
    return run_corda(arguments);
}

/// True if there was something to change.
bool apply(const Edit& edit, std::string& text) {
    const std::size_t at = text.find(edit.was);
    if (at == std::string::npos) return false;
    text.replace(at, edit.was.size(), edit.is);
    return true;
}

}  // namespace

void expect_to_work(const Remedy& remedy) {
    const CommandResult failed = run(remedy.scene, remedy.command);
    EXPECT_NE(failed.exit_code, 0);
    EXPECT_THAT(failed.err, testing::HasSubstr(remedy.says));
    EXPECT_FALSE(remedy.remedies.empty());
    for (const std::vector<Edit>& edits : remedy.remedies) {
        std::string scene = remedy.scene;
        std::string command = remedy.command;
        for (const Edit& edit : edits)
            EXPECT_TRUE(apply(edit, scene) || apply(edit, command)) << edit.was << " is nowhere";
        const CommandResult result = run(scene, command);
        if (remedy.then.empty()) {
            EXPECT_EQ(result.exit_code, 0) << scene << command << '\n' << failed.err << result.err;
        } else {
            EXPECT_THAT(result.err, testing::HasSubstr(remedy.then));
            EXPECT_THAT(result.err, testing::Not(testing::HasSubstr(remedy.says)));
        }
    }
}

}  // namespace corda::test
