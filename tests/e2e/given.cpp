// Positions that a file gives in place of a simulation: --positions.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/command.hpp"

namespace corda {
namespace {

using test::quoted;
using test::run_corda;
using test::run_shell;
using test::ScratchFolder;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kGivenScene = R"(schema = 1
world.duration = 0.5
[[rope]]
hang = { lengths = [1.0, 0.6], angles_deg = [100.0, -20.0], rates_deg_s = [0.0, 90.0], from = [0.3, 2.0] }
label = "a"
[video]
size = [128, 96]
fps = 30
)";

/// The pixels of a video of a scene, without what a file says about them.
std::string pixels_of(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "render");
    arguments.insert(arguments.end(), {"--pix", "rgba", "-o", "-"});
    const auto result = run_corda(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
}

TEST(GivenPositions, OfSimulateAreTheSceneItself) {
    const ScratchFolder folder;
    const std::string scene = folder.write("swing.toml", kGivenScene);
    const std::string own = pixels_of({scene});
    ASSERT_EQ(own.size(), 15U * 128 * 96 * 4);
    for (const std::vector<std::string>& options :
         {std::vector<std::string>{}, {"--decimal", "comma"}, {"--velocity", "--energy", "--tension"}}) {
        const std::string csv = folder.file("m.csv");
        std::vector<std::string> simulate{"simulate", scene, "-o", csv, "--force"};
        simulate.insert(simulate.end(), options.begin(), options.end());
        ASSERT_EQ(run_corda(simulate).exit_code, 0);
        EXPECT_EQ(pixels_of({scene, "--positions", csv}), own);
        // The solver does not matter, not even one that is worse.
        EXPECT_EQ(pixels_of({scene, "--positions", csv, "--set", "solver.method=relaxation", "--set",
                             "world.gravity=3"}),
                  own);
    }
}

TEST(GivenPositions, AreThoseOfAllPicturesAndOfThePlan) {
    const ScratchFolder folder;
    const std::string scene = folder.write("swing.toml", kGivenScene);
    const std::string csv = folder.file("m.csv");
    ASSERT_EQ(run_corda({"simulate", scene, "-o", csv}).exit_code, 0);
    for (const std::string command : {"still", "strobe", "sheet"}) {
        const std::string own = folder.file("own.png");
        const std::string given = folder.file("given.png");
        const std::vector<std::string> options{command,   scene, "--frame", command == "still" ? "7" : "0,7",
                                               "--force", "-o"};
        auto first = options;
        first.push_back(own);
        ASSERT_EQ(run_corda(first).exit_code, 0);
        auto second = options;
        second.insert(second.end(), {given, "--positions", csv, "--json"});
        const auto result = run_corda(second);
        ASSERT_EQ(result.exit_code, 0) << result.err;
        EXPECT_EQ(nlohmann::json::parse(result.out)["method"], "given");
        EXPECT_EQ(run_corda({"compare", own, given}).exit_code, 0) << command;
    }
    const auto plan = run_corda({"plan", scene, "--positions", csv, "--json"});
    const nlohmann::json told = nlohmann::json::parse(plan.out);
    EXPECT_EQ(told["method"], "given");
    EXPECT_EQ(told["bodies"][0]["solver"], "given");
    EXPECT_TRUE(told["error_estimate_m"].is_null());
    EXPECT_TRUE(told["steps"].is_null());
    EXPECT_EQ(told["simulation_passes"], 0);
    const auto words = run_corda({"plan", scene, "--positions", csv});
    EXPECT_THAT(words.out, HasSubstr("solver: given, because its positions are given and not simulated\n"));
    EXPECT_THAT(words.out, HasSubstr("error estimate: none; the positions are those of " + csv + "\n"));
    EXPECT_THAT(words.err, IsEmpty());
}

TEST(GivenPositions, CannotBeRepeatedFromAFileAlone) {
    const ScratchFolder folder;
    const std::string scene = folder.write("swing.toml", kGivenScene);
    const std::string csv = folder.file("m.csv");
    ASSERT_EQ(run_corda({"simulate", scene, "-o", csv}).exit_code, 0);
    const std::string pictures = folder.file("%02d.png");
    const auto render = run_corda({"render", scene, "--positions", csv, "-o", pictures, "--frames", "0:3"});
    EXPECT_EQ(render.exit_code, 0);
    EXPECT_THAT(
        render.err,
        HasSubstr("--from cannot repeat the output, because its positions were given and not simulated "));
    const auto again = run_corda({"still", "--from", folder.file("00.png"), "-o", folder.file("again.png")});
    EXPECT_EQ(again.exit_code, 2);
    EXPECT_THAT(again.err, HasSubstr("does not carry its scene, because its positions were given"));
    // Pictures of other positions are told apart.
    const std::string other = folder.file("other.csv");
    ASSERT_EQ(run_corda({"simulate", scene, "--set", "world.gravity=5", "-o", other}).exit_code, 0);
    EXPECT_EQ(run_corda({"render", scene, "--positions", csv, "-o", pictures, "--resume"}).exit_code, 0);
    EXPECT_EQ(run_corda({"render", scene, "--positions", other, "-o", pictures, "--resume"}).exit_code, 2);
    EXPECT_EQ(run_corda({"render", scene, "-o", pictures, "--resume"}).exit_code, 2);
    // And those of another scene.
    const auto styled = run_corda(
        {"render", scene, "--positions", csv, "-o", pictures, "--resume", "--set", "style.theme=paper"});
    EXPECT_EQ(styled.exit_code, 2);
    EXPECT_THAT(styled.err, HasSubstr("it is of another frame or scene, or of other positions"));
}

TEST(GivenPositions, ComeFromStandardInput) {
    const ScratchFolder folder;
    const std::string scene = folder.write("swing.toml", kGivenScene);
    const auto plan = [](const std::string& input, const std::string& file) {
        return run_shell(input + " | " + quoted(CORDA_PROGRAM) + " plan " + quoted(file) + " --positions -");
    };
    const std::string simulate = quoted(CORDA_PROGRAM) + " simulate " + quoted(scene) + " -o -";
    const auto given = plan(simulate, scene);
    EXPECT_EQ(given.exit_code, 0) << given.err;
    EXPECT_THAT(given.out, HasSubstr("error estimate: none; the positions are those of stdin\n"));
    EXPECT_THAT(plan("printf 't,x0,y0\\n0,0,0\\n1,0\\n'", scene).err, HasSubstr("stdin:3:1: 2 of 3 cells"));
    const auto arrays = plan("printf 'PK'", scene);
    EXPECT_EQ(arrays.exit_code, 2);
    EXPECT_THAT(arrays.err, HasSubstr("stdin: an .npz cannot be read from standard input; give the path"));
    const auto both = plan(simulate, "-");
    EXPECT_EQ(both.exit_code, 2);
    EXPECT_THAT(both.err, HasSubstr("SCENE and --positions are both standard input"));
}

TEST(GivenPositions, ThatDoNotFitAreRefusedInJsonToo) {
    const ScratchFolder folder;
    const std::string scene = folder.write("swing.toml", kGivenScene);
    const std::string csv = folder.write("m.csv", "t,x0,y0\n0,0,0\n1,0,zero\n");
    const auto result =
        run_corda({"render", scene, "--positions", csv, "-o", folder.file("a.mp4"), "--json"});
    EXPECT_EQ(result.exit_code, 2);
    const nlohmann::json problem = nlohmann::json::parse(result.out)["error"]["problems"][0];
    EXPECT_EQ(problem["source"], csv);
    EXPECT_EQ(problem["line"], 3);
    EXPECT_EQ(problem["column"], 5);
    EXPECT_EQ(problem["key"], "y0");
    EXPECT_EQ(folder.files().size(), 2U);
    EXPECT_EQ(run_corda({"render", scene, "--positions", folder.file("no.csv"), "-o", folder.file("a.mp4")})
                  .exit_code,
              6);
}

}  // namespace
}  // namespace corda
