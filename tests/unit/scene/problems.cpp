// All mistakes of a file are reported at once, and each of them once.
#include "corda/scene/problems.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <sstream>

#include "unit/scene/support.hpp"

namespace corda::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

std::vector<std::string> problems_of(const std::string& toml, const std::vector<Setting>& settings = {}) {
    const SceneError error = error_of(toml, settings);
    EXPECT_EQ(error.code, ExitCode::kInvalidScene);
    std::istringstream lines(error.message);
    std::vector<std::string> problems;
    for (std::string line; std::getline(lines, line);) problems.push_back(line);
    return problems;
}

TEST(SceneProblems, AreReportedTogetherInTheOrderOfTheFile) {
    EXPECT_THAT(
        problems_of(R"(schema = 1
[video]
size = [0, 3, 4]
fps = 29.97
[[rope]]
line = { particles = 3, step = [0, -1] }
pinned = [7]
masss = 2
color = "redd"
velocity = [[0, 0]]
[[rope]]
[world]
gravty = 1
duration = -1
[solver]
method = "exact"
order = 4
tolerance = "small"
[[net]]
grid = { columns = 2, rows = 2 }
width_px = 0
string = true
)"),
        ElementsAre(StartsWith("swing.toml:3:8: video.size: "), StartsWith("swing.toml:4:7: video.fps: "),
                    StartsWith("swing.toml:7:11: rope[0].pinned[0]: 7 is out of range"),
                    StartsWith("swing.toml:8:1: rope[0].masss: unknown key"),
                    StartsWith("swing.toml:9:9: rope[0].color: "),
                    StartsWith("swing.toml:10:12: rope[0].velocity: 1 values for 3 particles"),
                    StartsWith("swing.toml:11:1: rope[1]: the rope has no shape"),
                    StartsWith("swing.toml:13:1: world.gravty: unknown key"),
                    StartsWith("swing.toml:14:12: world.duration: -1 is not > 0"),
                    StartsWith("swing.toml:17:9: solver.order: method \"exact\" does not use it"),
                    StartsWith("swing.toml:18:13: solver.tolerance: \"small\" is a string"),
                    StartsWith("swing.toml:20:8: net[0].grid.spacing: missing"),
                    StartsWith("swing.toml:21:12: net[0].width_px: 0 is not >= 0.1"),
                    StartsWith("swing.toml:22:10: net[0].string: ")));
}

TEST(SceneProblems, OfAListAreReportedPerEntry) {
    EXPECT_THAT(problems_of(graph_with("[[0, 9], [1], [1, 1], [0, 1]]", "mass = [1, 0, -1, 1]\n")),
                ElementsAre(StartsWith("swing.toml:4:17: net[0].bars[1]: this is a list of 1"),
                            StartsWith("swing.toml:5:12: net[0].mass[1]: 0 is not"),
                            StartsWith("swing.toml:5:15: net[0].mass[2]: -1 is not")));
    EXPECT_THAT(problems_of(graph_with("[[0, 9], [1, 1], [0, 1]]", "pinned = [0, 4, 0]\n")),
                ElementsAre(StartsWith("swing.toml:4:13: net[0].bars[0][1]: 9 is out of range"),
                            StartsWith("swing.toml:4:17: net[0].bars[1]: a bar from particle 1 to itself"),
                            StartsWith("swing.toml:5:14: net[0].pinned[1]: 4 is out of range"),
                            StartsWith("swing.toml:5:17: net[0].pinned[2]: particle 0 is given twice")));
}

TEST(SceneProblems, AreAtMostTwentyAndACount) {
    const auto unknown = [](int count) {
        std::string toml = with("");
        for (int i = 0; i < count; ++i) toml += "zzzz" + std::to_string(100 + i) + " = 1\n";
        return problems_of(toml);
    };
    EXPECT_THAT(unknown(20), SizeIs(20));
    const auto many = unknown(25);
    ASSERT_THAT(many, SizeIs(21));
    EXPECT_THAT(many[0], StartsWith("swing.toml:3:1: zzzz100: "));
    EXPECT_THAT(many[19], StartsWith("swing.toml:22:1: zzzz119: "));
    EXPECT_EQ(many[20], "and 5 more");
}

TEST(SceneProblems, WithoutNumberAreCountedToo) {
    std::string masses;
    for (int i = 0; i < 30'000; ++i) masses += "0,";
    EXPECT_EQ(problems_of(rope_with("mass = [" + masses + "]")).back(), "and 29980 more");
}

TEST(SceneProblems, DoNotCauseOthers) {
    const std::string rope = "schema = 1\n[[rope]]\n";
    const std::string lists = "mass = [1, 2, 3]\nvelocity = [[0, 0], [1, 1], [2, 2]]\npinned = [0, 2]\n";
    const std::vector<std::string> files{
        rope + "line = { particles = 0, step = [0, -1] }\nstring = true\nlink_length = [2, 2]\n" + lists,
        rope + "line = { particle = 3, step = [0, -1] }\n" + lists,
        rope + "line = 3\n" + lists,
        rope + "lin = { particles = 3, step = [0, -1] }\n" + lists,
        rope + "points = [[0, 0], [1, 0], [2]]\n" + lists,
        rope + "points = [[0, 0], [1, 0]]\nhang = { links = 2, length = 1 }\n" + lists,
        rope_with("complance = 1e-3\nlink_length = 2\n"),
        rope_with("compliance = -1\nlink_length = [2, 2]\n"),
        rope_with("closed = true\nstring = true\n"),
        square_with("closed = true\nstring = true\ncompliance = \"soft\"\n"),
        square_with("closed = 3\ncompliance = 1\nlink_length = [1, 1, 1]\n"),
        grid_with("string = true\ncompliance = -1\n"),
        "schema = 1\n[[net]]\ngrid = { columns = 0, rows = 2, spacing = 1 }\n" + lists,
        "schema = 1\n[[net]]\npoints = [[0, 0], [1, 0]]\nbar = [[0, 1]]\n",
        "schema = 1\n[[ropes]]\nline = 1\n",
        "schema = 2\nfoo = 1\nworld = 3\n",
        "shema = 1\n[[rope]]\nline = { particles = 3, step = [0, -1] }\n",
        with("world = 3"),
        with("[solver]\nmethod = \"rope\"\norder = 6\nstep = 0.01\n"),
        with("[solver]\nmethd = \"rattle\"\norder = 6\nstep = 0.01\n"),
        with("[solver]\nmethod = \"relaxation\"\nreach = 0\n"),
        with("[world]\nduration = 1e6\n[video]\nfps = \"1:1\"\n"),
        with("[world]\nduration = 1e12\n[solver]\nmethod = \"relaxation\"\nstep = 1e-9\nsweeps = 1000000\n")};
    for (const std::string& toml : files) {
        EXPECT_THAT(problems_of(toml), SizeIs(1)) << toml;
    }
}

TEST(SceneProblems, OfSettingsFollowThoseOfTheFile) {
    EXPECT_THAT(problems_of(rope_with("mass = 0\n"), {"video.fbs=3", "rope[5].mass=1", "world.drag=-1"}),
                testing::UnorderedElementsAre(
                    StartsWith("swing.toml:4:8: rope[0].mass: "),
                    StartsWith("--set video.fbs=3: video.fbs: unknown key \"fbs\"; did you mean \"fps\"?"),
                    StartsWith("--set rope[5].mass=1: rope: index 5 is out of range"),
                    StartsWith("--set world.drag=-1: world.drag: -1 is not >= 0")));
    EXPECT_THAT(problems_of(rope_with("mass = 0\n"), {"video.fbs=3"}).front(), StartsWith("swing.toml:4:8"));
}

TEST(SceneProblems, AreFieldsUntilTheyArePrinted) {
    const auto fields_of = [](const std::string& toml, const std::vector<Setting>& settings) {
        try {
            static_cast<void>(parse_scene(toml, "swing.toml", settings));
        } catch (const Error& error) {
            std::vector<std::string> fields;
            for (const auto& [place, what, remedy, value] : error.problems())
                fields.push_back(fmt::format("{}|{}|{}|{}|{}|{}|{}", place.source, place.line, place.column,
                                             place.key, value, what, remedy));
            return fields;
        }
        return std::vector<std::string>();
    };
    EXPECT_THAT(fields_of(rope_with("masss = 1\n"), {"rope[5].mass=1", "world.drag=-1"}),
                ElementsAre("swing.toml|4|1|rope[0].masss||unknown key \"masss\"|did you mean \"mass\"?",
                            "--set rope[5].mass=1|0|0|rope||index 5 is out of range; the list has 1|give 0",
                            StartsWith("--set world.drag=-1|0|0|world.drag|-1|-1 is not >= 0|give ")));
    EXPECT_THAT(fields_of(rope_with(""), {"video.fps=29.97", "style.theme=\"x\""}),
                testing::UnorderedElementsAre(
                    StartsWith("--set video.fps=29.97|0|0|video.fps|29.97|29.97 is not exact|write "
                               "\"30000/1001\"; give "),
                    StartsWith("--set style.theme=\"x\"|0|0|style.theme|\"x\"|")));
    EXPECT_THAT(fields_of(rope_with(""), {"overlay.title=\"\u6f22\""}),
                ElementsAre(StartsWith("--set overlay.title=\"\u6f22\"|0|0|overlay.title|\"\u6f22\"|"
                                       "DejaVu Sans has no U+6F22|name a font ")));
    EXPECT_THAT(fields_of("schema = = 1\n", {}), ElementsAre(StartsWith("swing.toml|1|")));
    EXPECT_THAT(fields_of(rope_with(""), {"mass"}),
                ElementsAre(StartsWith("--set mass|0|0|||there is no '='|")));
}

TEST(SceneProblems, OfSyntaxStandAlone) {
    EXPECT_THAT(problems_of("schema = 1\nfoo = 1\n[world]\nduration = = 3\nmasss = 1\n"),
                ElementsAre(StartsWith("swing.toml:4:")));
}

TEST(SceneProblems, NameTheFileAsItWasGiven) {
    try {
        static_cast<void>(parse_scene("schema = 1\n", "../some/where.toml"));
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), StartsWith("../some/where.toml:1:1: rope: missing"));
    }
}

TEST(Problems, MakeTheirKeyAndWhatHoldsItUnsound) {
    const toml::table document = toml::parse("a = 1", std::string_view("x.toml"));
    Problems problems("x.toml", document);
    EXPECT_TRUE(problems.empty());
    EXPECT_NO_THROW(problems.throw_if_any());
    problems.add(document.get("a")->source(), "rope[0].line.step[1]", "is wrong");
    for (const char* key : {"rope", "rope[0]", "rope[0].line", "rope[0].line.step", "rope[0].line.step[1]"})
        EXPECT_FALSE(problems.is_sound(key)) << key;
    for (const char* key : {"rope[1]", "rope[0].line.from", "rope[0].mass", "world"})
        EXPECT_TRUE(problems.is_sound(key)) << key;
    problems.add_misspelt("world.drag");
    EXPECT_FALSE(problems.is_sound("world.drag"));
    EXPECT_FALSE(problems.empty());
}

TEST(Problems, CountOncePerKey) {
    const toml::table document = toml::parse("a = 1", std::string_view("x.toml"));
    Problems problems("x.toml", document);
    for (const char* problem : {"is wrong", "is too large"})
        problems.add(document.get("a")->source(), "a", problem);
    try {
        problems.throw_if_any();
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "x.toml:1:5: a: is wrong");
    }
}

}  // namespace
}  // namespace corda::scene
