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

/// Expects the files of the report in `folder`, and no others.
void expect_files_of(const json& report, const std::string& folder) {
    std::size_t expected = 3;
    for (const json& chapter : report["chapters"]) {
        EXPECT_FALSE(chapter["title"].get<std::string>().empty());
        for (const json& table : chapter["tables"]) {
            EXPECT_TRUE(fs::exists(folder + "/" + table["id"].get<std::string>() + ".csv"));
            EXPECT_FALSE(table["rows"].empty()) << table["id"];
            ++expected;
        }
        for (const json& plot : chapter["plots"]) {
            for (const char* ending : {".png", ".svg", ".pdf"})
                EXPECT_TRUE(fs::exists(folder + "/" + plot["id"].get<std::string>() + ending));
            expected += 3;
        }
    }
    const auto begin = fs::directory_iterator(folder);
    EXPECT_EQ(static_cast<std::size_t>(std::distance(begin, fs::directory_iterator{})), expected);
}

TEST_F(Study, QuickRunWritesAWholeReport) {
    const auto result = run_corda({"study", "-o", out_, "--quick", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json answer = json::parse(result.out);
    EXPECT_EQ(answer["schema"], 1);
    EXPECT_EQ(answer["folder"], out_);
    EXPECT_EQ(answer["files"][0], out_ + "/report.html");
    for (const json& file : answer["files"]) EXPECT_GT(fs::file_size(file.get<std::string>()), 0U) << file;
    const json report = json::parse(test::read_file(out_ + "/report.json"));
    EXPECT_EQ(report["schema"], 1);
    EXPECT_GE(report["setting"].size(), 6U);
    EXPECT_EQ(report["chapters"].size(), 5U);
    expect_files_of(report, out_);
    const auto lint = run_shell("xmllint --noout --nonet --dropdtd " + test::quoted(out_ + "/report.html"));
    EXPECT_EQ(lint.exit_code, 0) << lint.err;
    const auto svgs = run_shell("xmllint --noout --nonet " + test::quoted(out_) + "/*.svg");
    EXPECT_EQ(svgs.exit_code, 0) << svgs.err;
}

TEST_F(Study, PicturesHaveTheirErrorsAndTimes) {
    const auto result = run_corda({"study", "-o", out_, "--quick", "--chapter", "picture"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr(out_ + "/report.html\n"));
    const json report = json::parse(test::read_file(out_ + "/report.json"));
    ASSERT_EQ(report["chapters"].size(), 1U);
    const json& chapter = report["chapters"][0];
    const json& solvers = chapter["tables"][0]["rows"];
    ASSERT_EQ(solvers.size(), 12U);
    for (const json& row : solvers) {
        EXPECT_TRUE(row["failure"].is_null()) << row;
        EXPECT_GT(row["whole_ms"], 0.0) << row;
        EXPECT_LT(row["simulate_ms"], row["whole_ms"]) << row;
    }
    // Half a second of the swing at 7.6 pixels per metre. Errors are the same on every machine.
    EXPECT_GT(solvers[0]["error_px"], 0.1);     // the report's relaxation: measured 0.251
    EXPECT_LT(solvers[10]["error_px"], 1e-10);  // exact at 1e-8: measured 2.5e-12
    EXPECT_LT(solvers[11]["error_px"], 0.1);    // auto: measured 7.7e-9
    EXPECT_EQ(solvers[11]["setting"], "exact at tolerance 0.0001");
    expect_files_of(report, out_);
}

TEST_F(Study, PicturesShowTheMethodsThatCannotRunAScene) {
    const std::string ring = folder_.write("ring.toml", R"(schema = 1
[world]
duration = 0.1
[[rope]]
points = [[0.0, 0.0], [1.0, 0.0], [1.0, -1.0], [0.0, -1.0]]
closed = true
)");
    const auto result = run_corda({"study", ring, "-o", out_, "--quick", "--chapter", "picture"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json report = json::parse(test::read_file(out_ + "/report.json"));
    for (const json& row : report["chapters"][0]["tables"][0]["rows"]) {
        EXPECT_EQ(row["failure"].is_null(), row["solver"] != "exact") << row;
        EXPECT_EQ(row["error_px"].is_null(), row["solver"] == "exact") << row;
    }
}

TEST_F(Study, AcceptsAScene) {
    const std::string scene = folder_.write("My rope-1.toml", R"(schema = 1
[world]
duration = 0.2
[[rope]]
hang = { links = 5, length = 1.0, angle_deg = 30.0 }
)");
    const auto result = run_corda({"study", scene, "-o", out_, "--quick", "--set", "video.fps=30"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json report = json::parse(test::read_file(out_ + "/report.json"));
    EXPECT_THAT(report["title"].get<std::string>(), HasSubstr("My rope-1"));
    EXPECT_THAT(report["chapters"].back()["paragraphs"][0].get<std::string>(),
                testing::StartsWith("6 frames of 640x360 at 30 per second, drawn by "));
    expect_files_of(report, out_);
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
        {{"-o", out_, "--backend", "none"}, 2, "backend \"none\" is unknown"},
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

TEST_F(Study, ForceKeepsOtherFiles) {
    const std::string file = folder_.write("file", "text");
    const auto result =
        run_corda({"study", "-o", folder_.path(), "--quick", "--force", "--chapter", "picture", "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(test::read_file(file), "text");
    EXPECT_TRUE(fs::exists(folder_.file("report.html")));
}

TEST_F(Study, MissingGnuplotIsReportedAtOnce) {
    const auto result = run_corda({"study", "-o", out_, "--quick"}, "PATH=" + test::quoted(folder_.path()));
    EXPECT_EQ(result.exit_code, 6);
    EXPECT_THAT(result.err, HasSubstr("apt-get install gnuplot-nox"));
}

TEST_F(Study, StopsAtASignalAndWritesNoFile) {
    // timeout(1) signals its child twice: directly, and with its process group.
    const auto result =
        run_shell("timeout -s INT 1 " + test::quoted(CORDA_PROGRAM) + " study -o " + test::quoted(out_));
    EXPECT_EQ(result.exit_code, 124) << result.err;  // the exit code of timeout: the signal was sent
    EXPECT_THAT(result.err, HasSubstr("interrupted; nothing was written"));
    EXPECT_TRUE(fs::is_empty(out_));
}

/// A study of two chapters, with a scene for which each chapter is short.
std::string study_of(const std::string& scene, const std::string& folder) {
    return test::quoted(CORDA_PROGRAM) + " study " + scene + " -o " + folder +
           " --quick --chapter speed,picture";
}

const char* const kSmallScene =
    "schema = 1\n[world]\nduration = 0.1\n[[rope]]\nhang = { links = 3, length = 1.0, angle_deg = 9.0 }\n";

TEST_F(Study, EndsItsReportAtASignal) {
    const std::string scene = folder_.write("scene.toml", kSmallScene);
    // The last file of the first chapter exists while the others are measured.
    const auto result =
        run_shell(study_of(scene, out_) + " & pid=$!; for i in $(seq 1000); do [ -e " + out_ +
                  "/speed_scene.pdf ] && break; sleep 0.05; done; kill -TERM $pid; wait $pid");
    EXPECT_EQ(result.exit_code, 143) << result.err;
    EXPECT_THAT(result.err, HasSubstr("error: interrupted; 9 files are written, the last of them is " + out_ +
                                      "/report.html"));
    const json report = json::parse(test::read_file(out_ + "/report.json"));
    ASSERT_EQ(report["chapters"].size(), 1U);
    EXPECT_EQ(report["setting"].back(), json({{"name", "Not measured"}, {"value", "picture"}}));
    expect_files_of(report, out_);
}

TEST_F(Study, KeepsItsTablesOnAFullDisk) {
    const std::string scene = folder_.write("scene.toml", kSmallScene);
    // Files may have 24 KiB: more than any table (at most 16) and less than any plot (at least 44). A program
    // sees this as a full disk.
    const auto result = run_shell("trap '' XFSZ; ulimit -f 24; " + study_of(scene, out_));
    EXPECT_EQ(result.exit_code, 6) << result.err;
    EXPECT_THAT(result.err, HasSubstr("files are written, the last of them is " + out_));
    for (const char* name : {"fastest_scene.csv", "slopes_scene.csv", "speed_scene.csv", "report.md"})
        EXPECT_GT(test::read_file(out_ + "/" + name).size(), 100U) << name;
}

}  // namespace
}  // namespace corda
