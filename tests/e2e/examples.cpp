// The gallery: the program contains the examples, and each has a picture and an entry.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/command.hpp"
#include "support/files.hpp"

namespace corda {
namespace {

using test::run_corda;
using testing::HasSubstr;

const std::string kFolder = CORDA_EXAMPLES "/";

/// Runs "init" in the scratch folder.
test::CommandResult init_in(const test::ScratchFolder& folder, const std::string& arguments) {
    return test::run_shell("cd " + test::quoted(folder.path()) + " && " + test::quoted(CORDA_PROGRAM) +
                           " init " + arguments);
}

TEST(Gallery, ListsEveryExampleAndWritesIt) {
    const auto listed = nlohmann::json::parse(run_corda({"examples", "--json"}).out)["examples"];
    ASSERT_EQ(listed.size(), test::list_files(CORDA_EXAMPLES, ".toml").size() +
                                 test::list_files(kFolder + "sweep", ".toml").size());
    const test::ScratchFolder folder;
    const std::string plain = run_corda({"examples"}).out;
    for (const auto& example : listed) {
        const auto name = example["name"].get<std::string>();
        ASSERT_EQ(init_in(folder, name + " --force").exit_code, 0) << name;
        const bool is_scene = std::filesystem::exists(kFolder + name + ".toml");
        EXPECT_EQ(test::read_file(folder.file(name + ".toml")),
                  test::read_file(kFolder + (is_scene ? "" : "sweep/") + name + ".toml"));
        EXPECT_THAT(example["summary"].get<std::string>(), testing::SizeIs(testing::Gt(5U))) << name;
        EXPECT_THAT(plain, HasSubstr(name + " "));
    }
}

TEST(Gallery, EveryExampleHasItsPictureAndItsEntry) {
    const std::string page = test::read_file(kFolder + "README.md");
    const std::string script = test::read_file(kFolder + "gallery.sh");
    std::size_t count = 0;
    for (const std::string& scene : test::list_files(CORDA_EXAMPLES, ".toml")) {
        const std::string name = std::filesystem::path(scene).stem().string();
        const std::string picture = "pictures/" + name + ".png";
        EXPECT_THAT(page, HasSubstr("## " + name + "\n\n![" + name + "](" + picture + ")\n"));
        EXPECT_THAT(script, HasSubstr("\n" + name + " "));
        const std::size_t bytes = test::read_file(kFolder + picture).size();
        EXPECT_GT(bytes, 5000U) << name;
        EXPECT_LT(bytes, 60000U) << name;  // 52'121 measured
        ++count;
    }
    EXPECT_EQ(test::list_files(kFolder + "pictures", ".png").size(),
              count + 1);  // methods.png is of a folder
}

TEST(Gallery, AnimationOfTheReadmeIsSmallAndRepeats) {
    const std::string name = "pictures/fifty_pendulums.gif";
    EXPECT_THAT(test::read_file(kFolder + "../README.md"), HasSubstr("(examples/" + name + ")"));
    EXPECT_THAT(test::read_file(kFolder + "gallery.sh"), HasSubstr("-o " + name));
    const std::string animation = test::read_file(kFolder + name);
    const std::string forever("NETSCAPE2.0\x03\x01\0\0", 15);
    EXPECT_THAT(animation.substr(0, 1000), HasSubstr(forever));
    EXPECT_LT(animation.size(), 1'000'000U);  // 804'425 measured
}

TEST(Init, WritesASceneThatDrawsSomething) {
    const test::ScratchFolder folder;
    EXPECT_EQ(init_in(folder, "").out, "scene.toml\n");
    const auto planned = run_corda({"plan", folder.file("scene.toml"), "--json"});
    EXPECT_EQ(planned.exit_code, 0) << planned.err;
    const auto drawn = run_corda({"still", folder.file("scene.toml"), "--at", "0.3", "--size", "320x180",
                                  "--fail-empty", "-o", folder.file("scene.svg")});
    EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
}

TEST(Init, WritesASweepAndItsScene) {
    const test::ScratchFolder folder;
    const auto written = init_in(folder, "clips");
    EXPECT_EQ(written.out, "clips.toml\nclip.toml\n");
    EXPECT_THAT(written.err, HasSubstr("python3 -m corda sweep clips.toml -o clips"));
    EXPECT_EQ(init_in(folder, "clips").exit_code, 6);
    EXPECT_EQ(nlohmann::json::parse(init_in(folder, "clips --force --json").out)["outputs"],
              nlohmann::json::parse(R"([{"path": "clips.toml"}, {"path": "clip.toml"}])"));
    EXPECT_EQ(init_in(folder, "sweep").out, "sweep.toml\npendulum.toml\n");
}

TEST(Init, TakesANewNameAndReplacesNothing) {
    const test::ScratchFolder folder;
    EXPECT_EQ(init_in(folder, "mine.toml").out, "mine.toml\n");
    EXPECT_EQ(test::read_file(folder.file("mine.toml")), test::read_file(kFolder + "start.toml"));
    EXPECT_THAT(init_in(folder, "mine.toml --force").err, testing::Not(HasSubstr("no example")));
    EXPECT_THAT(init_in(folder, "mine --force").err, HasSubstr("there is no example mine, and mine.toml is"));
    const auto misspelt = init_in(folder, "hamock");
    EXPECT_EQ(misspelt.exit_code, 2);
    EXPECT_THAT(misspelt.err,
                HasSubstr("for the example hammock: corda init hammock; for a scene of this name: corda init "
                          "hamock.toml"));
    EXPECT_FALSE(std::filesystem::exists(folder.file("hamock.toml")));
    const std::string own = folder.write("whip.toml", "schema = 1\n");
    const auto refused = init_in(folder, "whip");
    EXPECT_EQ(refused.exit_code, 6);
    EXPECT_THAT(refused.err, HasSubstr("--force"));
    EXPECT_EQ(test::read_file(own), "schema = 1\n");
    EXPECT_EQ(init_in(folder, "whip --force").exit_code, 0);
    EXPECT_EQ(test::read_file(own), test::read_file(kFolder + "whip.toml"));
}

}  // namespace
}  // namespace corda
