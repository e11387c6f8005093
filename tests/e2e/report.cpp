// `corda report`: its files, their validity for other programs, and early ends.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "corda/media/defs.hpp"
#include "support/command.hpp"

namespace corda {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::run_corda;
using test::run_shell;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

const char* const kPendulumOfReports = R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 4, length = 1.0, angle_deg = 40.0 }
[solver]
method = "exact"
[video]
size = [320, 180]
fps = 30
)";

class SceneReport : public testing::Test {
  protected:
    [[nodiscard]] std::string out(const std::string& name) const { return out_ + "/" + name; }
    [[nodiscard]] std::string read(const std::string& name) const { return test::read_file(out(name)); }

    test::ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kPendulumOfReports);
    std::string out_ = folder_.file("report");
};

/// The files of a folder: name and bytes.
std::map<std::string, std::string> bytes_of(const std::string& folder) {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::directory_iterator(folder))
        all[entry.path().filename().string()] = test::read_file(entry.path().string());
    return all;
}

TEST_F(SceneReport, WritesAllFormatsWithReproducibleBytes) {
    const auto result = run_corda({"report", scene_, "-o", out_, "--at", "0,0.4", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json answer = json::parse(result.out);
    EXPECT_EQ(answer["schema"], 1);
    EXPECT_EQ(answer["folder"], out_);
    EXPECT_EQ(answer["files"][0], out("report.html"));
    EXPECT_EQ(answer["simulation_passes"], 1);
    const auto files = bytes_of(out_);
    EXPECT_EQ(answer["files"].size(), files.size());
    for (const char* id :
         {"strobe", "still_1", "still_2", "path", "angle", "phase", "energy", "tension", "tension_along"}) {
        for (const char* width : {"85mm", "170mm"}) {
            for (const char* ending : {"svg", "pdf", "png"})
                EXPECT_TRUE(files.contains(std::string(id) + "_" + width + "." + ending)) << id;
        }
    }
    for (const char* name : {"tip.csv", "energy.csv", "tension.csv", "strain.csv"})
        EXPECT_EQ(std::count(files.at(name).begin(), files.at(name).end(), '\n'), 1 + 31) << name;
    const std::string again = folder_.file("again");
    ASSERT_EQ(run_corda({"report", scene_, "-o", again, "--at", "0,0.4"}).exit_code, 0);
    const auto others = bytes_of(again);
    ASSERT_EQ(others.size(), files.size());
    for (const auto& [name, bytes] : files) EXPECT_TRUE(others.at(name) == bytes) << name;
    const auto lint = run_shell(
        "cd " + out_ + " && xmllint --noout --nonet *.svg && xmllint --noout --nonet --dropdtd report.html");
    EXPECT_EQ(lint.exit_code, 0) << lint.err;
    const auto twice =
        run_shell("grep -oE '\\bid=.[A-Za-z0-9_-]+' " + out("report.html") + " | sort | uniq -d");
    EXPECT_EQ(twice.out, "");  // ids are unique over all figures
    EXPECT_THAT(read("report.html"), HasSubstr("href=\"tip.csv\">CSV</a>"));
}

TEST_F(SceneReport, CanBePrintedAtItsWidth) {
    ASSERT_EQ(run_corda({"report", scene_, "-o", out_, "--at", "0"}).exit_code, 0);
    EXPECT_FALSE(fs::exists(out("strobe_85mm.svg")));  // one pose is a still
    for (const char* id : {"still_1", "energy"}) {
        // 85 mm at 300 pixels per inch.
        const std::string stem = out(std::string(id) + "_85mm");
        const auto drawn = run_shell("rsvg-convert -d 300 -p 300 " + stem + ".svg -o " + out("svg.png") +
                                     " && pdftoppm -r 300 -png -singlefile " + stem + ".pdf " + out("pdf"));
        ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
        for (const std::string& png : {stem + ".png", out("svg.png"), out("pdf.png")}) {
            const Image image = read_png(png);
            EXPECT_NEAR(image.width(), 1004, 5)
                << png;  // the width of a PDF page is a whole number of points
            const auto darkest = [&] {
                int least = 255;
                for (int y = 0; y < image.height(); ++y)
                    for (int x = 0; x < image.width(); ++x)
                        least = std::min<int>(least, image.pixel(x, y)[1] | (255 - image.pixel(x, y)[3]));
                return least;
            };
            EXPECT_LT(darkest(), 120) << png;  // it is not blank
        }
        EXPECT_NEAR(read_png_info(stem + ".png").pixels_per_inch, 300.0, 0.5);
    }
}

TEST_F(SceneReport, SaysThatTensionsAreUnknownAndHasTheDecimalSignOfItsLanguage) {
    const std::string net =
        folder_.write("net.toml",
                      "schema = 1\n[world]\nduration = 0.2\n[[net]]\ngrid = { columns = 5, rows = 4, spacing "
                      "= 0.1 }\n[solver]\nmethod = \"relaxation\"\n[video]\nsize = [320, 180]\nfps = 20\n");
    const auto result =
        run_corda({"report", net, "-o", out_, "--at", "0.1", "-q", "--set", "overlay.language=de"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const std::string number = "<td class=\"number\" title=\"[0-9]+";
    EXPECT_THAT(read("report.html"), ContainsRegex(number + ",[0-9]+\">[0-9]+,[0-9]+<"));
    EXPECT_THAT(read("report.html"), Not(ContainsRegex(number + "\\.")));
    EXPECT_THAT(read("largest.csv"), ContainsRegex("\nspeed,[0-9]+\\.[0-9]+,m/s,"));
    EXPECT_FALSE(fs::exists(out("tension_85mm.svg")));
    EXPECT_TRUE(fs::exists(out("strain_85mm.svg")));
    EXPECT_THAT(read("report.html"), HasSubstr("Tensions of net 0 are not known: method relaxation"));
    EXPECT_THAT(read("tension.csv"), HasSubstr("\n0,,\n"));
}

TEST_F(SceneReport, CoversADivergingMotionUntilItDiverges) {
    const std::string wild = folder_.write(
        "wild.toml",
        "schema = 1\n[world]\nduration = 1.0\ngravity = [1e14, 0.0]\n[[rope]]\npoints = [[0.0, 0.0], [1.0, "
        "0.0]]\npinned = []\n[solver]\nmethod = \"relaxation\"\n[video]\nsize = [320, 180]\nfps = 50\n");
    const auto result = run_corda({"report", wild, "-o", out_, "--at", "0,0.5"});
    EXPECT_EQ(result.exit_code, 8) << result.err;
    EXPECT_THAT(result.err, HasSubstr("the simulation diverged before t = 0.1525 s"));
    EXPECT_THAT(result.err, HasSubstr("files are written, the last of them is " + out("report.html")));
    EXPECT_THAT(read("report.html"),
                HasSubstr("It diverges after 0.14 s; the figures show the motion before that."));
    EXPECT_TRUE(fs::exists(out("still_1_85mm.png")));
    EXPECT_FALSE(fs::exists(out("still_2_85mm.png")));  // at 0.5 s there is nothing
}

TEST_F(SceneReport, RefusesBeforeItSimulates) {
    struct Case {
        std::vector<std::string> arguments;
        int exit_code;
        const char* message;
    };
    const std::vector<Case> cases{
        {{scene_}, 2, "--output"},
        {{scene_, "-o", ""}, 2, "--output: the value is empty"},
        {{scene_, "-o", out_, "--at", "2"}, 2, "--at 2: is not within 0 .. 1 s"},
        {{scene_, "-o", out_, "--backend", "none"}, 2, "backend \"none\" is unknown"},
        {{folder_.file("missing.toml"), "-o", out_}, 6, "missing.toml: cannot read the scene file"},
        {{scene_, "-o", scene_}, 6, "scene.toml: exists and is not a folder"},
        {{scene_, "-o", folder_.path()}, 6, "is not empty; give --force"},
    };
    for (const Case& refused : cases) {
        std::vector<std::string> arguments = refused.arguments;
        arguments.insert(arguments.begin(), "report");
        const auto result = run_corda(arguments);
        EXPECT_EQ(result.exit_code, refused.exit_code) << refused.message;
        EXPECT_THAT(result.err, HasSubstr(refused.message));
        EXPECT_THAT(run_shell("cd " + folder_.path() + " && find . -type f").out, "./scene.toml\n");
    }
}

TEST_F(SceneReport, DryRunWritesNothing) {
    const auto result = run_corda({"report", scene_, "-o", out_, "--dry-run", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(json::parse(result.out)["method"], "exact");
    EXPECT_FALSE(fs::exists(out_));
}

TEST_F(SceneReport, KeepsAPageOfDrawnFiguresAtASignal) {
    // The first figure exists while the others are being drawn.
    const auto result = run_shell(test::quoted(CORDA_PROGRAM) + " report " + scene_ + " -o " + out_ +
                                  " & pid=$!; for i in $(seq 1000); do [ -e " + out("strobe_85mm.pdf") +
                                  " ] && break; sleep 0.01; done; kill -TERM $pid; wait $pid");
    EXPECT_EQ(result.exit_code, 143) << result.err;
    EXPECT_THAT(result.err, HasSubstr("interrupted; "));
    EXPECT_THAT(result.err, HasSubstr("the last of them is " + out("report.html")));
    EXPECT_TRUE(fs::exists(out("tip.csv")));
    EXPECT_FALSE(fs::exists(out("strain_170mm.pdf")));
}

}  // namespace
}  // namespace corda
