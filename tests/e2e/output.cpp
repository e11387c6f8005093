// The content, stream and form of the output.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/command.hpp"

namespace corda {
namespace {

using nlohmann::json;
using test::run_corda;
using test::ScratchFolder;
using testing::HasSubstr;
using testing::Not;

const char* const kSceneOfOutput = R"(schema = 1
[world]
duration = 1.0
[[rope]]
line = { particles = 40, from = [0.0, 50.0], step = [0.1, -1.0] }
[solver]
method = "relaxation"
[video]
size = [64, 64]
fps = 20
)";

class Output : public testing::Test {
  protected:
    ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kSceneOfOutput);
    std::string video_ = folder_.file("out.mp4");
};

TEST_F(Output, SimulateWritesARowPerFrameTimeWithSeventeenDigits) {
    const std::string csv = folder_.file("out.csv");
    const auto result = run_corda({"simulate", scene_, "-o", csv});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, csv + "\n");
    EXPECT_THAT(result.err, HasSubstr("40 particles, 252 bars (39 real)"));
    std::istringstream lines(test::read_file(csv));
    std::string line;
    std::getline(lines, line);
    EXPECT_THAT(line, testing::StartsWith("t,x0,y0,x1,y1,"));
    EXPECT_THAT(line, testing::EndsWith(",x39,y39"));
    std::vector<std::string> rows;
    while (std::getline(lines, line)) rows.push_back(line);
    ASSERT_EQ(rows.size(), 21U);  // both ends: t = 0 and t = 1
    EXPECT_THAT(rows[0], testing::StartsWith("0,0,50,0.10000000000000001,49,0.20000000000000001,48,"));
    EXPECT_THAT(rows[1], testing::StartsWith("0.050000000000000003,0,50,"));
    EXPECT_THAT(rows[20], testing::StartsWith("1,0,50,"));
    EXPECT_EQ(std::count(rows[20].begin(), rows[20].end(), ','), 80);
}

TEST_F(Output, SimulateToStandardOutputIsTheSameText) {
    ASSERT_EQ(run_corda({"simulate", scene_, "-o", folder_.file("out.csv")}).exit_code, 0);
    EXPECT_EQ(run_corda({"simulate", scene_, "-o", "-"}).out, test::read_file(folder_.file("out.csv")));
    EXPECT_EQ(run_corda({"simulate", scene_, "-o", "-", "--json"}).exit_code, 2);
}

TEST_F(Output, SimulateWritesToDevicesAndPipes) {
    const std::string csv = run_corda({"simulate", scene_, "-o", "-"}).out;
    EXPECT_EQ(run_corda({"simulate", scene_, "-o", "/dev/stdout"}).out, csv);
    const auto null = run_corda({"simulate", scene_, "-o", "/dev/null"});
    EXPECT_EQ(null.exit_code, 0) << null.err;
    EXPECT_EQ(run_corda({"simulate", scene_, "-o", "/dev/full"}).exit_code, 6);
    const std::string pipe = test::quoted(folder_.file("pipe"));
    const auto piped =
        test::run_shell("mkfifo " + pipe + "; cat " + pipe + " & " + test::quoted(CORDA_PROGRAM) +
                        " simulate -q " + scene_ + " -o " + pipe + " > /dev/null; wait");
    EXPECT_EQ(piped.out, csv);
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"pipe", "scene.toml"}));
}

TEST_F(Output, SimulateJsonDescribesTheRun) {
    const auto result = run_corda({"simulate", scene_, "--json", "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const json figures = json::parse(result.out);
    EXPECT_EQ(figures["schema"], 1);
    EXPECT_EQ(figures["method"], "relaxation");
    EXPECT_EQ(figures["particles"], 40);
    EXPECT_EQ(figures["bars"], 252);
    EXPECT_EQ(figures["links"], 39);
    EXPECT_EQ(figures["steps"], 20);
    EXPECT_GT(figures["wall_s"], 0.0);
    EXPECT_GT(figures["max_strain"], 0.0);
    EXPECT_TRUE(figures["energy_error"].is_number());
    for (const char* key : {"error_estimate_m", "error_estimate_px", "horizon_s"})
        EXPECT_TRUE(figures.at(key).is_null()) << key;
}

TEST_F(Output, SimulateAddsDiagnosticsToEveryRow) {
    const std::vector<std::string> exact{"--set", "solver={ method = \"exact\" }"};
    std::vector<std::string> arguments{"simulate", scene_, "-o", "-", "--diagnostics"};
    const auto relaxed = run_corda(arguments);
    EXPECT_THAT(relaxed.out, HasSubstr(",x39,y39,energy_error,strain,pin_force_n,largest_tension_n\n"));
    EXPECT_THAT(relaxed.out, testing::EndsWith(",,\n"));  // relaxation has no loads
    arguments.insert(arguments.end(), exact.begin(), exact.end());
    const std::string rows = run_corda(arguments).out;
    const std::string last = rows.substr(rows.rfind("\n1,"));
    const double tension_n = std::stod(last.substr(last.rfind(',') + 1));
    // A rope that hangs almost straight carries its weight: 39 free masses of 1 kg.
    EXPECT_NEAR(tension_n, 39 * 9.81, 1.0);  // measured 382.62; the weight is 382.59
}

/// The numbers of a line of CSV.
std::vector<double> numbers_of(const std::string& line) {
    std::vector<double> numbers;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) numbers.push_back(std::stod(cell));
    return numbers;
}

TEST_F(Output, ColumnsHaveTheLabelsOfTheirBodies) {
    const std::string rope = "[[rope]]\nhang = { links = 1, length = 2.0 }\n";
    const std::string scene =
        folder_.write("labels.toml", "schema = 1\n[world]\nduration = 0.1\n" + rope + "label = \"8 kg\"\n" +
                                         rope + rope + "label = '8 kg'\n" + rope + "label = 'a,\"b\"'\n");
    const std::vector<std::string> arguments{"simulate", scene, "-o", "-", "--tension"};
    EXPECT_THAT(run_corda(arguments).out,
                testing::StartsWith(
                    "t,8_kg_x0,8_kg_y0,8_kg_x1,8_kg_y1,x2,y2,x3,y3,8_kg_2_x4,8_kg_2_y4,8_kg_2_x5,8_kg_2_y5,"
                    "\"a,\"\"b\"\"_x6\",\"a,\"\"b\"\"_y6\",\"a,\"\"b\"\"_x7\",\"a,\"\"b\"\"_y7\","
                    "8_kg_tension0_n,tension1_n,8_kg_2_tension2_n,\"a,\"\"b\"\"_tension3_n\"\n"));
    EXPECT_THAT(run_corda({"simulate", scene, "-o", "-", "--velocity", "--decimal", "comma"}).out,
                HasSubstr(";8_kg_2_vy5_m_s;"));
    const std::string copies =
        folder_.write("copies.toml", "schema = 1\n[world]\nduration = 0.1\n" + rope +
                                         "label = \"P\"\ncopies = { count = 2, angle_deg = 1 }\n" + rope);
    const auto named = run_corda({"simulate", copies, "-o", "-"});
    EXPECT_THAT(named.out, testing::StartsWith("t,P_x0,P_y0,P_x1,P_y1,P_2_x2,P_2_y2,P_2_x3,P_2_y3,x4,"));
    EXPECT_THAT(named.err, HasSubstr("P: P_x0 .. P_y1; P 2: P_2_x2 .. P_2_y3; rope 2: x4 .. y5"));
}

TEST_F(Output, SimulateAddsVelocitiesTensionsAndEnergy) {
    const std::string pendulum = folder_.write(
        "pendulum.toml",
        "schema = 1\n[world]\nduration = 1\n[[rope]]\nhang = { links = 1, length = 2.0, angle_deg = 60.0 }\n"
        "mass = 3.0\n[solver]\nmethod = \"exact\"\ntolerance = 1e-12\n");
    std::istringstream lines(
        run_corda({"simulate", pendulum, "-o", "-", "--velocity", "--tension", "--energy"}).out);
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line,
              "t,x0,y0,x1,y1,vx0_m_s,vy0_m_s,vx1_m_s,vy1_m_s,tension0_n,energy_change_j,"
              "kinetic_j,potential_j");
    int rows = 0;
    for (; std::getline(lines, line); ++rows) {
        const std::vector<double> cells = numbers_of(line);
        ASSERT_EQ(cells.size(), 13U);
        // v^2 = 2 g (h0 - h) and T = m (g cos + v^2 / L), with errors of at most 1e-10.
        const double height_m = cells[4];
        const double speed_square = cells[7] * cells[7] + cells[8] * cells[8];
        EXPECT_NEAR(speed_square, 2.0 * 9.81 * (-1.0 - height_m), 1e-9);
        EXPECT_NEAR(cells[9], 3.0 * (9.81 * -height_m + speed_square) / 2.0, 1e-8);
        EXPECT_NEAR(cells[10], 0.0, 1e-9);
        EXPECT_NEAR(cells[11], 0.5 * 3.0 * speed_square, 1e-12);
        EXPECT_NEAR(cells[11] + cells[12], 0.0, 1e-8);
        EXPECT_EQ(cells[5], 0.0);  // that of the pin
    }
    EXPECT_EQ(rows, 61);
    // Drag dissipates the energy that the column shows.
    const std::string dragged =
        run_corda({"simulate", pendulum, "-o", "-", "--energy", "--set", "world.drag=1.0"}).out;
    EXPECT_LT(numbers_of(dragged.substr(dragged.rfind('\n', dragged.size() - 2) + 1))[5], -1.0);
}

TEST_F(Output, SimulateAddsTheWorkOfPinsThatMove) {
    const std::string driven = folder_.write(
        "driven.toml",
        "schema = 1\n[world]\nduration = 1\n[[rope]]\nhang = { links = 5, length = 1.0, angle_deg = 30.0 }\n"
        "moves = [{ pin = 0, waves = [{ amplitude = [0.1, 0.0], frequency = 0.7 }] }]\n"
        "[solver]\nmethod = \"exact\"\ntolerance = 1e-12\n");
    std::istringstream lines(run_corda({"simulate", driven, "-o", "-", "--energy"}).out);
    std::string line;
    std::getline(lines, line);
    EXPECT_THAT(line, testing::EndsWith("energy_change_j,kinetic_j,potential_j,support_work_j"));
    double largest_j = 0.0;
    while (std::getline(lines, line)) {
        const std::vector<double> cells = numbers_of(line);
        ASSERT_EQ(cells.size(), 17U);
        EXPECT_NEAR(cells[16], cells[13], 1e-9);  // without loss; 1e-12
        largest_j = std::max(largest_j, std::abs(cells[16]));
    }
    EXPECT_GT(largest_j, 0.1);
}

TEST_F(Output, SimulateWritesTheTensionsThatAMethodKnowsAndWarnsOfTheRest) {
    const std::string mixed = folder_.write(
        "mixed.toml",
        "schema = 1\n[world]\nduration = 0.1\n"
        "[[rope]]\nhang = { links = 1, length = 1.0 }\n[[rope]]\nhang = { links = 1, length = 1.0 }\n"
        "[solver]\nmethod = \"relaxation\"\n[[solver.bodies]]\nropes = [1]\nmethod = \"exact\"\n");
    const auto result = run_corda({"simulate", mixed, "-o", "-", "--tension", "--decimal", "comma"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("--tension: the tensions of rope 0 are left empty: method relaxation"));
    EXPECT_THAT(result.out, testing::StartsWith("\xEF\xBB\xBF"
                                                "t;x0;y0;x1;y1;x2;y2;x3;y3;tension0_n;tension1_n\n"
                                                "0;0;0;0;-1;0;0;0;-1;;9,81"));
}

TEST_F(Output, AutoReportsItsBoundAndPlanSaysWhy) {
    const std::string chaotic = folder_.write(
        "chaotic.toml", "schema = 1\n[[rope]]\nhang = { links = 10, length = 1.0, angle_deg = 90.0 }\n");
    const json calm = json::parse(run_corda({"simulate", chaotic, "--duration", "1", "--json"}).out);
    EXPECT_EQ(calm["method"], "exact");
    EXPECT_GT(calm["error_estimate_m"], 0.0);
    EXPECT_LE(calm["error_estimate_px"], 0.1);
    EXPECT_TRUE(calm["horizon_s"].is_null());
    const auto result = run_corda({"plan", chaotic, "--json"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.err, HasSubstr("predictability ends at"));
    const json plan = json::parse(result.out);
    EXPECT_GT(plan["horizon_s"], 3.0);
    EXPECT_LT(plan["horizon_s"], 5.0);
    EXPECT_GE(plan["bodies"][0]["trials"].size(), 2U);
    EXPECT_THAT(run_corda({"plan", scene_}).out, HasSubstr("because the scene asks for relaxation"));
}

TEST_F(Output, EveryJsonPrintsSolverCameraAndPasses) {
    const std::string still = folder_.file("a.png");
    for (const auto& arguments :
         std::vector<std::vector<std::string>>{{"plan", scene_, "--json"},
                                               {"simulate", scene_, "--json"},
                                               {"still", scene_, "--at", "0", "-o", still, "--json"},
                                               {"render", scene_, "-o", video_, "--json"}}) {
        const json report = json::parse(run_corda(arguments).out);
        EXPECT_EQ(report["solver"], "relaxation with 1 sweep, step 0.05 s") << arguments[0];
        EXPECT_EQ(report["simulation_passes"], 1) << arguments[0];
        EXPECT_EQ(report["camera"]["center"].size(), 2U) << arguments[0];
        EXPECT_GT(report["camera"]["height"], 40.0) << arguments[0];
    }
    const json automatic =
        json::parse(run_corda({"plan", scene_, "--set", "solver={ method = \"auto\" }", "--json"}).out);
    EXPECT_EQ(automatic["simulation_passes"], 2);
}

TEST_F(Output, PlanTomlPastedIntoTheSceneGivesTheSameBytes) {
    const std::string scene =
        "schema = 1\n[[rope]]\nhang = { links = 9, length = 1.3, angle_deg = 70.0 }\n"
        "[world]\nduration = 2.0\n[video]\nsize = [160, 90]\n";
    const std::string chosen = folder_.write("chosen.toml", scene);
    const auto frozen_blocks = run_corda({"plan", chosen, "--toml", "-q"});
    ASSERT_EQ(frozen_blocks.exit_code, 0) << frozen_blocks.err;
    const std::string frozen = folder_.write("frozen.toml", scene + frozen_blocks.out);
    for (const auto& [file, name] : {std::pair{chosen, "chosen"}, {frozen, "frozen"}}) {
        ASSERT_EQ(run_corda({"still", file, "--at", "1.9", "-o", folder_.file(name) + std::string(".png")})
                      .exit_code,
                  0);
        ASSERT_EQ(run_corda({"simulate", file, "-o", folder_.file(name) + std::string(".csv")}).exit_code, 0);
    }
    EXPECT_EQ(test::read_file(folder_.file("chosen.csv")), test::read_file(folder_.file("frozen.csv")));
    EXPECT_EQ(run_corda({"compare", folder_.file("chosen.png"), folder_.file("frozen.png")}).exit_code, 0);
}

TEST_F(Output, ErrorsAreJsonWithJson) {
    const auto failure = [](const std::vector<std::string>& arguments, int code) {
        const auto result = run_corda(arguments);
        EXPECT_EQ(result.exit_code, code);
        const json report = json::parse(result.out);
        EXPECT_EQ(report["schema"], 1);
        EXPECT_EQ(report["error"]["code"], code);
        return report["error"]["message"].get<std::string>();
    };
    EXPECT_THAT(failure({"simulate", folder_.file("none.toml"), "--json"}, 6), HasSubstr("none.toml"));
    EXPECT_THAT(failure({"render", scene_, "--json", "--siz", "9x9"}, 2), HasSubstr("--size"));
    const auto negative = run_corda({"plan", scene_, "--json", "--set", "world.drag=-1"});
    const json problem = json::parse(negative.out)["error"]["problems"][0];
    EXPECT_EQ(problem["source"], "--set world.drag=-1");
    EXPECT_EQ(problem["key"], "world.drag");
    EXPECT_EQ(problem["value"], "-1");
    EXPECT_EQ(problem["what"], "-1 is not >= 0");
    EXPECT_THAT(problem["remedy"].get<std::string>(), HasSubstr("give "));
    EXPECT_THAT(failure({"rendr", scene_, "--json"}, 2), HasSubstr("render"));
    EXPECT_THAT(failure({"plan", "--json"}, 2), HasSubstr("SCENE"));
}

TEST_F(Output, PlanDoesNotPromiseThatRelaxationKeepsEnergy) {
    const auto plain = run_corda({"plan", scene_, "--set", "solver.method=relaxation"});
    EXPECT_THAT(plain.out, HasSubstr("modelled: no drag; the passes lose energy"));
    const auto damped =
        run_corda({"plan", scene_, "--set", "solver.method=relaxation", "--set", "solver.delta=0.01"});
    EXPECT_THAT(damped.out, HasSubstr("modelled: damping: a share of 0.01 of the velocity is lost per step"));
}

TEST_F(Output, PlanDescribesMaterials) {
    const std::string scene = folder_.write("bodies.toml", R"(schema = 1
[[rope]]
points = [[0, 0], [1, 0], [1, 1]]
closed = true
compliance = 0.25
bending = 2
[[rope]]
line = { particles = 3, step = [0, -1] }
string = true
[[net]]
grid = { columns = 3, rows = 2, spacing = 1, diagonals = true }
compliance = 0.5
[solver]
method = "exact"
)");
    const auto result = run_corda({"plan", scene});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("bodies: 2 ropes, 1 net: 12 particles, 16 bars (12 real)\n"));
    for (const char* term :
         {"no drag: energy is lost only when a string comes taut", "links that do not stretch",
          "links that stretch by 0.25 .. 0.5 of their length per newton",
          "strings: links that pull and never push", "bending stiffness of 2 N m2", "closed ropes: 1",
          "nets: 1, of 7 bars and 4 imaginary ones"}) {
        EXPECT_THAT(result.out, HasSubstr(std::string("modelled: ") + term + "\n"));
    }
    const auto plain = run_corda({"plan", scene_, "--set", "solver.method=exact"});
    EXPECT_THAT(plain.out, HasSubstr("modelled: no drag: energy is kept\n"));
    EXPECT_THAT(plain.out, Not(HasSubstr("strings")));
    EXPECT_THAT(plain.out, Not(HasSubstr("nets")));
}

TEST_F(Output, SimulateNeedsNoOpenGl) {
    EXPECT_EQ(
        run_corda({"simulate", scene_}, "CORDA_BACKEND=device:63 __EGL_VENDOR_LIBRARY_FILENAMES=/dev/null")
            .exit_code,
        0);
}

TEST_F(Output, RenderJsonDescribesTheRender) {
    const auto result = run_corda({"render", scene_, "-o", video_, "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json figures = json::parse(result.out);
    EXPECT_EQ(figures["schema"], 1);
    EXPECT_EQ(figures["output"], video_);
    EXPECT_EQ(figures["frames"], 20);
    EXPECT_GT(figures["wall_s"], 0.0);
    EXPECT_EQ(figures["fps"], 20.0);
    EXPECT_EQ(figures["method"], "relaxation");
    EXPECT_EQ(figures["encoder"], "libx264");
    EXPECT_EQ(figures["bars"], 252);
    EXPECT_FALSE(figures["gl_renderer"].get<std::string>().empty());
}

TEST_F(Output, ProgressIsALineEveryTwoSecondsWithoutATerminal) {
    EXPECT_THAT(run_corda({"simulate", scene_}).err, Not(HasSubstr(" % (")));  // takes 10 ms
    // The reader delays the rows by 1.5 s once and then takes all.
    const auto slow = test::run_shell(test::quoted(CORDA_PROGRAM) + " simulate " + scene_ +
                                      " --fps 2000 -o - | { sleep 1.5; cat > /dev/null; }");
    const std::size_t first = slow.err.find(" % (");
    EXPECT_NE(first, std::string::npos) << slow.err;
    EXPECT_EQ(slow.err.find(" % (", first + 1), std::string::npos) << slow.err;
    EXPECT_THAT(slow.err, Not(HasSubstr("\x1b")));
}

TEST_F(Output, EndsQuietlyIfItsReaderLeaves) {
    // The reader ends before it reads, as head(1) may before the end of a long text.
    const std::string left = " | true; echo ${PIPESTATUS[0]}";
    for (const std::string& arguments :
         {std::string("help scene"), std::string("examples"), "plan " + scene_,
          "simulate " + scene_ + " -o - -q", "simulate " + scene_ + " --json -q"}) {
        const auto result = test::run_shell("{ sleep 0.2; exec " + test::quoted(CORDA_PROGRAM) + " " +
                                            arguments + "; }" + left);
        EXPECT_EQ(result.out, "0\n") << arguments;
        EXPECT_THAT(result.err, Not(HasSubstr("pipe"))) << arguments;
    }
    const auto missing = test::run_shell("{ sleep 0.2; exec " + test::quoted(CORDA_PROGRAM) +
                                         " plan /dev/null/a --json; }" + left);
    EXPECT_EQ(missing.out, "6\n");  // a failure is not hidden
}

TEST_F(Output, ProgressIsABarOnATerminal) {
    const std::string inner = test::quoted(CORDA_PROGRAM) + " render " + scene_ + " -o " + video_;
    const auto result = test::run_shell("script -qec " + test::quoted(inner) + " /dev/null");
    EXPECT_EQ(result.exit_code, 0) << result.out;
    EXPECT_THAT(result.out, HasSubstr("[##############################] 100 % 20/20"));
}

TEST_F(Output, NoColorIsObeyed) {
    const std::string inner = test::quoted(CORDA_PROGRAM) + " simulate " + folder_.file("none.toml");
    const std::string script = "script -qec " + test::quoted(inner) + " /dev/null";
    EXPECT_THAT(test::run_shell("unset NO_COLOR; " + script).out, HasSubstr("\x1b[31merror"));
    EXPECT_THAT(test::run_shell("export NO_COLOR=1; " + script).out, Not(HasSubstr("\x1b[31m")));
}

TEST_F(Output, QuietPrintsOnlyErrors) {
    const auto result = run_corda({"render", scene_, "-o", video_, "-q"});
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(result.out, video_ + "\n");
    EXPECT_THAT(run_corda({"render", scene_, "-o", video_, "-q"}).err, HasSubstr("--force"));
}

TEST_F(Output, VerboseNamesTheRenderer) {
    EXPECT_THAT(run_corda({"still", scene_, "--at", "0", "-o", folder_.file("a.png"), "-v"}).err,
                HasSubstr("OpenGL"));
}

TEST_F(Output, DryRunWritesNothingAndNeedsNoOpenGl) {
    const auto result = run_corda({"render", scene_, "-o", video_, "--dry-run"}, "CORDA_BACKEND=device:63");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("20 frames of 64x64 at 20 per second"));
    EXPECT_EQ(run_corda({"simulate", scene_, "-o", folder_.file("out.csv"), "--dry-run"}).exit_code, 0);
    EXPECT_EQ(run_corda({"still", scene_, "--at", "0", "-o", folder_.file("stills"), "--dry-run"}).exit_code,
              0);
    EXPECT_EQ(folder_.files(), std::vector<std::string>{"scene.toml"});
}

TEST_F(Output, ComparePrintsTheDifference) {
    ASSERT_EQ(run_corda({"still", scene_, "--at", "0", "-o", folder_.file("a.png")}).exit_code, 0);
    ASSERT_EQ(run_corda({"still", scene_, "--at", "0", "-o", folder_.file("b.png"), "--set",
                         "style.rope_width_px=9"})
                  .exit_code,
              0);
    const auto same =
        json::parse(run_corda({"compare", folder_.file("a.png"), folder_.file("a.png"), "--json"}).out);
    EXPECT_EQ(same["equal"], true);
    EXPECT_EQ(same["max"], 0);
    EXPECT_EQ(same["share"], 0.0);
    const auto result = run_corda(
        {"compare", folder_.file("a.png"), folder_.file("b.png"), "--json", "--diff", folder_.file("d.png")});
    EXPECT_EQ(result.exit_code, 7);
    const json other = json::parse(result.out);
    EXPECT_EQ(other["equal"], false);
    EXPECT_GT(other["max"], 0);
    EXPECT_GT(other["mean"], 0.0);
    EXPECT_GT(other["share"], 0.0);
    EXPECT_LT(other["share"], 1.0);
    EXPECT_FALSE(test::read_file(folder_.file("d.png")).empty());
}

TEST_F(Output, CompareAcceptsFoldersAndAMask) {
    const std::string scene = CORDA_EXAMPLES "/first.toml";
    const auto draw = [&](const std::string& name, const std::string& folder, const std::string& times) {
        std::filesystem::create_directories(folder_.file(folder));
        ASSERT_EQ(run_corda({"still", scene, "--size", "96x54", "--at", times, "-o",
                             folder_.file(folder + "/" + name)})
                      .exit_code,
                  0);
    };
    draw("same.png", "a", "0.5");
    draw("same.png", "b", "0.5");
    const auto equal = run_corda({"compare", folder_.file("a"), folder_.file("b")});
    EXPECT_EQ(equal.exit_code, 0);
    EXPECT_EQ(equal.out, "1 picture: all equal\n");
    draw("moved.png", "a", "0.5");
    draw("moved.png", "b", "0.6");
    draw("gone.png", "a", "0");
    const std::string diff = folder_.file("diff");
    const auto result =
        run_corda({"compare", folder_.file("a"), folder_.file("b"), "--diff", diff, "--json"});
    EXPECT_EQ(result.exit_code, 7);
    const auto report = nlohmann::json::parse(result.out);
    EXPECT_FALSE(report.at("equal"));
    EXPECT_GT(report.at("max"), 0);
    ASSERT_EQ(report.at("files").size(), 3U);
    EXPECT_EQ(report["files"][0]["missing_in"], folder_.file("b"));
    EXPECT_FALSE(report["files"][1]["passed"]);
    EXPECT_TRUE(report["files"][2]["passed"]);
    EXPECT_FALSE(test::read_file(diff + "/moved.png").empty());
    EXPECT_TRUE(test::read_file(diff + "/same.png").empty());
    EXPECT_EQ(
        run_corda({"compare", folder_.file("a/moved.png"), folder_.file("b/moved.png"), "--share", "0.5"})
            .exit_code,
        0);
    EXPECT_EQ(run_corda({"compare", folder_.file("a"), folder_.file("a/same.png")}).exit_code, 2);
    EXPECT_EQ(
        run_corda({"compare", folder_.file("a/same.png"), folder_.file("b/same.png"), "--mask", "none.png"})
            .exit_code,
        6);
}

TEST_F(Output, DoctorReportsCapabilities) {
    const auto result = run_corda({"doctor", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json report = json::parse(result.out);
    EXPECT_EQ(report["can_draw"], true);
    EXPECT_EQ(report["can_write"], (json{".mp4", ".webm", ".mov", ".mkv", ".gif", "%04d.png", "-"}));
    ASSERT_FALSE(report["contexts"].empty());
    for (const json& context : report["contexts"]) {
        const char* key = context["usable"] == true ? "gl_renderer" : "reason";
        EXPECT_FALSE(context[key].get<std::string>().empty()) << context;
    }
    ASSERT_EQ(report["encoders"].size(), 13U);  // those that Corda supports
    for (const json& encoder : report["encoders"]) {
        EXPECT_EQ(encoder["usable"] == true, encoder["reason"].get<std::string>().empty()) << encoder;
    }
    EXPECT_THAT(run_corda({"doctor"}).out, HasSubstr("This machine can draw."));
}

TEST_F(Output, DoctorSaysWhyThereIsNoOpenGl) {
    const auto result = run_corda({"doctor"}, "__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null");
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_THAT(result.out, HasSubstr("  no   EGL"));
    EXPECT_THAT(result.out, HasSubstr("This machine cannot draw"));
}

}  // namespace
}  // namespace corda
