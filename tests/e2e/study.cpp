// `corda study`: its files, refusals and early ends.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include <nlohmann/json.hpp>

#include "support/command.hpp"

namespace corda {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::run_corda;
using test::run_shell;
using testing::HasSubstr;

class Study : public testing::Test {
  protected:
    test::ScratchFolder folder_;
    std::string out_ = folder_.file("report");
};

TEST_F(Study, QuickRunWritesAWholeReport) {
    const auto result = run_corda({"study", "-o", out_, "--quick", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json answer = json::parse(result.out);
    EXPECT_EQ(answer["schema"], 1);
    EXPECT_EQ(answer["folder"], out_);
    EXPECT_EQ(answer["files"][0], out_ + "/report.html");
    for (const json& file : answer["files"]) EXPECT_GT(fs::file_size(file.get<std::string>()), 0U) << file;
    for (const char* name : {"setting.csv", "fastest_report_swing.csv", "speed_report_swing.png",
                             "bars_strain.svg", "reference_numbers.csv", "hard_cases.csv"})
        EXPECT_TRUE(fs::exists(out_ + "/" + name)) << name;
    const auto lint = run_shell("xmllint --noout --nonet --dropdtd " + test::quoted(out_ + "/report.html"));
    EXPECT_EQ(lint.exit_code, 0) << lint.err;
    const auto svgs = run_shell("xmllint --noout --nonet " + test::quoted(out_) + "/*.svg");
    EXPECT_EQ(svgs.exit_code, 0) << svgs.err;
}

TEST_F(Study, AcceptsAScene) {
    const std::string scene = folder_.write("My rope-1.toml", R"(schema = 1
[world]
duration = 0.2
[[rope]]
hang = { links = 5, length = 1.0, angle_deg = 30.0 }
)");
    const auto result = run_corda({"study", scene, "-o", out_, "--quick", "--set", "video.fps=30", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(test::read_file(out_ + "/report.html"), HasSubstr("study of My rope-1"));
    // The speed of its methods, in three plots and two tables, the setting and the page.
    EXPECT_EQ(json::parse(result.out)["files"].size(), 3U + 2U + 2U);
}

TEST_F(Study, RefusesBeforeItMeasures) {
    const std::string scene =
        folder_.write("scene.toml", "schema = 1\n[[rope]]\npoints = [[0.0, 0.0], [1.0, 0.0]]\n");
    struct Case {
        std::vector<std::string> arguments;
        int exit_code;
        const char* message;
    };
    const std::vector<Case> cases{
        {{"--quick"}, 2, "--output"},
        {{"-o", ""}, 2, "--output: the value is empty"},
        {{"-o", out_, "--chapter", "speeds"}, 2, "there is no chapter \"speeds\"; known are speed, findings"},
        {{"-o", out_, "--chapter", ""}, 2, "--chapter: the value is empty"},
        {{scene, "-o", out_, "--chapter", "findings"}, 2, "chapter \"findings\" is about built-in problems"},
        {{"-o", out_, "--set", "video.fps=30"}, 2, "--set changes a scene; name its file"},
        {{"", "-o", out_}, 2, "SCENE: the value is empty"},
        {{folder_.file("missing.toml"), "-o", out_}, 6, "missing.toml: cannot read the scene file"},
        {{"-o", scene}, 6, "scene.toml: exists and is not a folder"},
        {{"-o", folder_.path()}, 6, "is not empty; give --force"},
    };
    for (const Case& refused : cases) {
        std::vector<std::string> arguments = refused.arguments;
        arguments.insert(arguments.begin(), "study");
        const auto result = run_corda(arguments);
        EXPECT_EQ(result.exit_code, refused.exit_code) << refused.message;
        EXPECT_THAT(result.err, HasSubstr(refused.message));
        EXPECT_THAT(folder_.files(), testing::ElementsAre("scene.toml")) << refused.message;
    }
}

TEST_F(Study, StopsAtASignalAndWritesNoFile) {
    // timeout(1) signals its child twice: directly, and with its process group.
    const auto result =
        run_shell("timeout -s INT 1 " + test::quoted(CORDA_PROGRAM) + " study -o " + test::quoted(out_));
    EXPECT_EQ(result.exit_code, 124) << result.err;  // the exit code of timeout: the signal was sent
    EXPECT_THAT(result.err, HasSubstr("interrupted; nothing was written"));
    EXPECT_TRUE(fs::is_empty(out_));
}

const char* const kSmallScene =
    "schema = 1\n[world]\nduration = 0.1\n[[rope]]\nhang = { links = 3, length = 1.0, angle_deg = 9.0 }\n";

TEST_F(Study, ForceKeepsOtherFiles) {
    const std::string scene = folder_.write("scene.toml", kSmallScene);
    const auto result = run_corda({"study", scene, "-o", folder_.path(), "--quick", "--force", "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(test::read_file(scene), kSmallScene);
    EXPECT_TRUE(fs::exists(folder_.file("report.html")));
}

TEST_F(Study, EndsItsReportAtASignal) {
    // The last file of the first chapter exists while the next one is measured.
    const auto result =
        run_shell(test::quoted(CORDA_PROGRAM) + " study -o " + out_ +
                  " --quick --chapter speed,hard_cases & pid=$!; for i in $(seq 3000); do [ -e " + out_ +
                  "/speed_spinning_chain.pdf ] && break; sleep 0.05; done; kill -TERM $pid; wait $pid");
    EXPECT_EQ(result.exit_code, 143) << result.err;
    EXPECT_THAT(result.err, HasSubstr("error: interrupted; 22 files are written, the last of them is " +
                                      out_ + "/report.html"));
    EXPECT_THAT(test::read_file(out_ + "/setting.csv"), testing::EndsWith("\nNot measured,hard_cases\n"));
}

TEST_F(Study, KeepsItsTablesOnAFullDisk) {
    const std::string scene = folder_.write("scene.toml", kSmallScene);
    // Files may have 24 KiB: more than any table (at most 16) and less than a plot. A program sees this as a
    // full disk.
    const auto result = run_shell("trap '' XFSZ; ulimit -f 24; " + test::quoted(CORDA_PROGRAM) + " study " +
                                  scene + " -o " + out_ + " --quick");
    EXPECT_EQ(result.exit_code, 6) << result.err;
    EXPECT_THAT(result.err, HasSubstr("files are written, the last of them is " + out_));
    for (const char* name : {"fastest_scene.csv", "speed_scene.csv", "setting.csv"})
        EXPECT_GT(test::read_file(out_ + "/" + name).size(), 100U) << name;
}

}  // namespace
}  // namespace corda
