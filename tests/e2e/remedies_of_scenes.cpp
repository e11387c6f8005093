// Like remedies.cpp, for messages about shapes, materials and keys of a scene.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/command.hpp"
#include "support/files.hpp"
#include "support/remedy.hpp"

namespace corda {
namespace {

using namespace test;

class SceneRemedies : public testing::TestWithParam<Remedy> {};

TEST_P(SceneRemedies, Work) {
    expect_to_work(GetParam());
}

// Shapes and materials of a rope.
INSTANTIATE_TEST_SUITE_P(
    OfRopes, SceneRemedies,
    testing::Values(
        Remedy{"no_body",
               scene_of(""),
               "plan SCENE",
               "give one or more [[rope]] or [[net]]",
               {{{"schema = 1\n", "schema = 1\n[[rope]]\n" + kHang}},
                {{"schema = 1\n", "schema = 1\n[[net]]\n" + kGrid}}}},
        Remedy{"no_shape",
               rope_scene("mass = 1"),
               "plan SCENE",
               "give one of: line, hang, points",
               {{{"mass", kHang + "mass"}},
                {{"mass", "line = { particles = 4, step = [0.1, -0.1] }\nmass"}},
                {{"mass", "points = [[0, 0], [1, 0]]\nmass"}}}},
        Remedy{"two_shapes",
               rope_scene(kHang + "points = [[0, 0], [1, 0]]"),
               "plan SCENE",
               "the rope has 2 shapes (hang, points); keep one of them",
               {{{kHang, ""}}, {{"points = [[0, 0], [1, 0]]", ""}}}},
        Remedy{"angle_without_a_pin",
               rope_scene("points = [[0, 0], [1, 0]]\npinned = []\n[overlay]\nplots = [\"angle\"]"),
               "plan SCENE",
               "pin one particle of an open rope, or remove this plot",
               {{{"pinned = []", "pinned = [0]"}}, {{"\"angle\"", ""}}}},
        Remedy{
            "divergence_of_one_rope",
            rope_scene(kHang + "[overlay]\nplots = [\"divergence\"]"),
            "plan SCENE",
            "give another [[rope]] or rope.copies, or remove this plot",
            {{{"[overlay]", "copies = { count = 2, angle_deg = 1 }\n[overlay]"}}, {{"\"divergence\"", ""}}}},
        Remedy{"trail_of_no_particle",
               rope_scene(kHang + "[style]\ntrail_s = 1\ntrail_of = [-1, 900]"),
               "plan SCENE",
               "900 is out of range; the particles of the longest rope or net are 0 .. ",
               {{{", 900", ", 1"}}}},
        Remedy{"trail_without_a_length",
               rope_scene(kHang + "[style]\ntrail_of = [-1]"),
               "plan SCENE",
               "no trail without a length; give style.trail_s, or remove trail_of",
               {{{"[style]", "[style]\ntrail_s = 1"}}, {{"trail_of = [-1]", ""}}}},
        Remedy{"plot_twice",
               rope_scene(kHang + "[overlay]\nplots = [\"tip\", \"tip\"]"),
               "plan SCENE",
               "the same plot twice; remove one",
               {{{", \"tip\"", ""}}}},
        Remedy{"net_beyond_the_memory",
               scene_of("[[net]]\ngrid = { columns = 1000, rows = 900, spacing = 0.1, diagonals = true "
                        "}\npinned = []\n"
                        "[solver]\nmethod = \"rattle\""),
               "plan SCENE",
               "give fewer particles, or method relaxation",
               {{{"1000, rows = 900", "20, rows = 10"}}}},
        Remedy{"rope_beyond_the_limit",
               rope_scene("hang = { links = 4, length = 2e9 }"),
               "plan SCENE",
               "make the rope shorter",
               {{{"2e9", "1e9"}}}},
        Remedy{"step_of_no_length",
               rope_scene("line = { particles = 4, step = [0, 0] }"),
               "plan SCENE --set world.gravity=0",
               "give a step of at least 1e-12 m",
               {{{"[0, 0]", "[1e-12, 0]"}}}},
        Remedy{"short_links",
               rope_scene("hang = { links = 4, length = 1e-12, angle_deg = 30 }"),
               "plan SCENE --set world.gravity=0",
               "are less than 1e-12 m per link; make the rope longer",
               {{{"1e-12", "4e-12"}}}},
        Remedy{"coinciding_points",
               rope_scene("points = [[0, 0], [1, 0], [1, 0]]"),
               "plan SCENE",
               "points 1 and 2 coincide, and a link without length has no direction; move one",
               {{{"[1, 0]]", "[1, 1]]"}}}},
        Remedy{
            "coinciding_points_within_reach",
            rope_scene("points = [[0, 0], [1, 0], [0, 0], [0, -1]]", method_of("relaxation") + "reach = 2\n"),
            "plan SCENE",
            "move one, or give a reach below 2",
            {{{"[1, 0], [0, 0]", "[1, 0], [0, -0.5]"}}, {{"reach = 2", "reach = 1"}}}},
        Remedy{"ring_with_its_first_point_again",
               rope_scene("points = [[0, 0], [1, 0], [0.5, 1], [0, 0]]\nclosed = true"),
               "plan SCENE",
               "leave this one out, because closed = true ties the last point to the first",
               {{{", [0, 0]]", "]"}}}},
        Remedy{"straight_ring",
               rope_scene(kHang + "closed = true"),
               "plan SCENE",
               "give points, or remove it",
               {{{kHang, "points = [[0, 0], [0.4, -0.3], [0.1, -0.6]]\n"}}, {{"closed = true", ""}}}},
        Remedy{"ring_of_two",
               rope_scene("points = [[0, 0], [1, 0]]\nclosed = true"),
               "plan SCENE",
               "give at least 3, or remove it",
               {{{"[1, 0]", "[1, 0], [0.5, -1]"}}, {{"closed = true", ""}}}},
        Remedy{"bending_string",
               rope_scene(kHang + "string = true\nbending = 1.0"),
               "plan SCENE",
               "remove bending or string",
               {{{"bending = 1.0", ""}}, {{"string = true", ""}}}},
        Remedy{"closed_string",
               rope_scene(kRing + "string = true"),
               "plan SCENE",
               "give a compliance, or remove string or closed",
               {{{"string", "compliance = 1e-3\nstring"}}, {{"string = true", ""}}, {{"closed = true", ""}}}},
        Remedy{"short_string",
               rope_scene("points = [[0, 0], [0.3, -0.4], [0.6, 0]]\npinned = [0, -1]\n"
                          "string = true\nlink_length = 0.2"),
               "plan SCENE",
               "0.2 m are less than the 0.5 m between particles 0 and 1, which lie between pins, and which "
               "a string that does not stretch cannot span; give at least that, or a compliance",
               {{{"0.2\n", "0.5\n"}}, {{"string", "compliance = 1e-3\nstring"}}}},
        Remedy{"rigid_link_length",
               rope_scene(kHang + "link_length = 0.3"),
               "plan SCENE",
               "give compliance or string = true, or remove it",
               {{{"link_length = 0.3", "link_length = 0.3\ncompliance = 1e-3"}},
                {{"link_length = 0.3", "link_length = 0.3\nstring = true"}},
                {{"link_length = 0.3", ""}}}},
        Remedy{"link_lengths",
               rope_scene(kHang + "compliance = 1e-3\nlink_length = [0.3, 0.3]"),
               "plan SCENE",
               "2 values for 4 links; give one per link",
               {{{"[0.3, 0.3]", "[0.3, 0.3, 0.3, 0.3]"}}}},
        Remedy{"masses",
               rope_scene(kHang + "mass = [1, 2]"),
               "plan SCENE",
               "2 values for 5 particles; give one per particle",
               {{{"[1, 2]", "[1, 2, 3, 4, 5]"}}}},
        Remedy{"pin_out_of_range",
               rope_scene(kHang + "pinned = [5]"),
               "plan SCENE",
               "the rope has particles 0 .. 4, or -1 .. -5 from the end",
               {{{"[5]", "[0]"}}, {{"[5]", "[4]"}}, {{"[5]", "[-1]"}}, {{"[5]", "[-5]"}}}},
        Remedy{"pin_given_twice",
               rope_scene(kHang + "pinned = [0, 0]"),
               "plan SCENE",
               "particle 0 is given twice; remove one",
               {{{"[0, 0]", "[0]"}}}}),
    test::kNameOfCase);

// Shapes and materials of a net.
INSTANTIATE_TEST_SUITE_P(
    OfNets, SceneRemedies,
    testing::Values(Remedy{"small_grid",
                           net_scene("grid = { columns = 1, rows = 1, spacing = 0.1 }"),
                           "plan SCENE",
                           "give more columns or rows",
                           {{{"columns = 1", "columns = 2"}}, {{"rows = 1", "rows = 2"}}}},
                    Remedy{"grid_beyond_the_limit",
                           net_scene("grid = { columns = 3, rows = 3, spacing = 1e9, diagonals = false }"),
                           "plan SCENE",
                           "make the grid smaller",
                           {{{"1e9", "1e8"}}}},
                    Remedy{"column_of_points",
                           net_scene(kSquare + kSides + "pinned = [[0, 0]]"),
                           "plan SCENE",
                           "only a grid has columns and rows; give the index of a particle",
                           {{{"[[0, 0]]", "[0]"}}}},
                    Remedy{"bar_to_itself",
                           net_scene(kSquare + "bars = [[0, 0], [1, 2]]"),
                           "plan SCENE",
                           "a bar from particle 0 to itself; join two different ones",
                           {{{"[0, 0], [1, 2]", "[0, 1], [1, 2]"}}}},
                    Remedy{"bar_without_length",
                           net_scene("points = [[0, 0], [0, 0], [1, 0]]\nbars = [[0, 1], [1, 2]]"),
                           "plan SCENE",
                           "a bar without length has no direction; move one",
                           {{{"[0, 0], [0, 0]", "[0, 0], [0, 1]"}}}},
                    Remedy{"bar_given_twice",
                           net_scene(kSquare + "bars = [[0, 1], [1, 0], [1, 2]]"),
                           "plan SCENE",
                           "particles 0 and 1 are joined already, by bars[0]; remove one",
                           {{{"[1, 0], [1, 2]", "[1, 2]"}}, {{"[0, 1], ", ""}}}},
                    Remedy{"net_without_shape",
                           net_scene("mass = 1"),
                           "plan SCENE",
                           "give grid, or points and bars",
                           {{{"mass = 1", kGrid}}, {{"mass = 1", kSquare + kSides}}}},
                    Remedy{"net_of_two_shapes",
                           net_scene(kGrid + "points = [[0, 0], [1, 0]]"),
                           "plan SCENE",
                           "the net has 2 shapes (grid, points); keep one of them",
                           {{{"points = [[0, 0], [1, 0]]", ""}}}},
                    Remedy{"grid_with_bars",
                           net_scene(kGrid + "bars = [[0, 1]]"),
                           "plan SCENE",
                           "a grid has bars of its own; remove them, or give points in place of the grid",
                           {{{"bars = [[0, 1]]", ""}}, {{kGrid, kSquare}}}},
                    Remedy{"points_without_bars",
                           net_scene(kSquare),
                           "plan SCENE",
                           "give the particles that each bar joins, as a list of [a, b], at least 1",
                           {{{kSquare, kSquare + kSides}}}},
                    Remedy{"slack_net",
                           net_scene(kSquare + kSides + "string = true"),
                           "plan SCENE",
                           "give a compliance, or remove string",
                           {{{"string", "compliance = 1e-3\nstring"}}, {{"string = true", ""}}}}),
    test::kNameOfCase);

// Keys and values.
INSTANTIATE_TEST_SUITE_P(
    OfKeys, SceneRemedies,
    testing::Values(
        Remedy{"misspelt_key",
               rope_scene(kHang + "masss = 2"),
               "plan SCENE",
               "did you mean \"mass\"?",
               {{{"masss", "mass"}}}},
        Remedy{"key_of_another_table",
               rope_scene(kHang + "codec = \"h264\""),
               "plan SCENE",
               "it is a key of video",
               {{{"codec = \"h264\"", ""}, {"fps", "codec = \"libx264\"\nfps"}}}},
        Remedy{"unknown_key",
               rope_scene(kHang + "zzzzzz = 1"),
               "plan SCENE",
               "valid keys: ",
               {{{"zzzzzz", "mass"}}}},
        Remedy{"misspelt_method",
               rope_scene(kHang, method_of("exat")),
               "plan SCENE",
               "did you mean \"exact\"?",
               {{{"exat", "exact"}}}},
        Remedy{"unknown_method",
               rope_scene(kHang, method_of("zzzzzz")),
               "plan SCENE",
               "give one of: auto, exact, rattle, relaxation",
               {{{"zzzzzz", "auto"}},
                {{"zzzzzz", "exact"}},
                {{"zzzzzz", "rattle"}},
                {{"zzzzzz", "relaxation"}}}},
        Remedy{"short_word",
               rope_scene(kHang + "[overlay]\nlanguage = \"it\""),
               "plan SCENE",
               "\"it\" is unknown; give one of: ",
               {{{"\"it\"", "\"pt\""}}}},
        Remedy{"word_in_place_of_a_list",
               rope_scene(kHang + "[overlay]\nplots = \"energy\""),
               "plan SCENE",
               "\"energy\" is a string, not a list; write [\"energy\"]",
               {{{"\"energy\"", "[\"energy\"]"}}}},
        Remedy{"schema_is_missing",
               "[[rope]]\n" + kHang,
               "plan SCENE",
               "give schema = 1",
               {{{"[[rope]]", "schema = 1\n[[rope]]"}}}},
        Remedy{"schema_is_another",
               "schema = 2\n[[rope]]\n" + kHang,
               "plan SCENE",
               "this program reads schema = 1",
               {{{"schema = 2", "schema = 1"}}}},
        Remedy{"order",
               rope_scene(kHang, method_of("rattle") + "order = 3\n"),
               "plan SCENE",
               "give one of: 2, 4, 6, 8",
               {{{"order = 3", "order = 2"}},
                {{"order = 3", "order = 4"}},
                {{"order = 3", "order = 6"}},
                {{"order = 3", "order = 8"}}}},
        Remedy{"reach_of_auto",
               rope_scene(kHang, "[solver]\nreach = 7\n"),
               "plan SCENE",
               "method \"auto\" does not use it, only relaxation; remove it",
               {{{"reach = 7\n", ""}}, {{"reach = 7", "reach = 7\nmethod = \"relaxation\""}}}},
        Remedy{"delta_of_exact",
               rope_scene(kHang, method_of("exact") + "delta = 0.1\n"),
               "plan SCENE",
               "remove it, or give world.drag",
               {{{"delta = 0.1\n", ""}}, {{"delta = 0.1\n", ""}, {"duration", "drag = 0.1\nduration"}}}},
        Remedy{"force_of_exact",
               rope_scene(kHang, method_of("exact") + "force = [0, -1]\n"),
               "plan SCENE",
               "remove it, or give world.gravity",
               {{{"force = [0, -1]\n", ""}},
                {{"force = [0, -1]\n", ""}, {"duration", "gravity = [0, -1]\nduration"}}}},
        Remedy{"rate_with_a_fraction",
               rope_scene(kHang),
               "plan SCENE --set video.fps=29.97",
               "29.97 is not exact; write \"30000/1001\"",
               {{{"29.97", "\"30000/1001\""}}, {{"29.97", "30000/1001"}}}},
        Remedy{"rate_that_is_none",
               rope_scene(kHang),
               "plan SCENE --set video.fps=many",
               "0.001 .. 100000, as a number of up to three decimals or as a fraction in quotes such as "
               "\"30000/1001\"",
               {{{"many", "12.5"}}, {{"many", "\"30000/1001\""}}}},
        Remedy{"colour",
               rope_scene(kHang + "color = \"redd\""),
               "plan SCENE",
               R"(such as "tomato", "#e8c07d", "#e8c07d80" (with alpha) or "transparent")",
               {{{"redd", "tomato"}},
                {{"redd", "#e8c07d"}},
                {{"redd", "#e8c07d80"}},
                {{"redd", "transparent"}}}},
        Remedy{
            "transparent_video",
            rope_scene(kHang, "[style]\nbackground = \"transparent\"\n"),
            "render SCENE -o DIR/x.mp4 --size 64x64 --duration 0.1",
            "style.background: \"#00000000\" is transparent, and H.264 in MP4 cannot be; give an opaque "
            "colour (--set style.background=#ffffff), draw stills as .png, or a video as .webm, .mov, .mkv, "
            ".gif",
            {{{"--duration 0.1", "--duration 0.1 --set style.background=#ffffff"}},
             {{"render SCENE -o DIR/x.mp4 --size 64x64 --duration 0.1", "still SCENE -o DIR/x.png --at 0"}},
             {{"x.mp4", "x.webm"}},
             {{"x.mp4", "x.mov"}},
             {{"x.mp4", "x.mkv"}},
             {{"x.mp4", "x.gif"}, {"--duration 0.1", "--duration 0.1 --fps 50"}}}},
        Remedy{"transparent_video_of_another_codec",
               rope_scene(kHang, "[style]\nbackground = \"transparent\"\n"),
               "render SCENE -o DIR/x.webm --size 64x64 --duration 0.1 --codec av1",
               "AV1 in WebM cannot be; give an opaque colour (--set style.background=#ffffff), or leave out "
               "video.codec and video.pix, as another encoder can",
               {{{"--codec av1", "--set style.background=#ffffff"}}, {{" --codec av1", ""}}}},
        Remedy{"ending_in_capitals",
               rope_scene(kHang),
               "render SCENE -o DIR/x.MP4 --size 64x64 --duration 0.1",
               "write it in lower case: .mp4",
               {{{".MP4", ".mp4"}}}},
        Remedy{"empty_palette",
               rope_scene(kHang, "[style]\npalette = []\n"),
               "plan SCENE",
               "colours such as",
               {{{"[]", "[\"#e8c07d\"]"}}}},
        Remedy{"empty_list",
               scene_of("", "rope = []\n"),
               "plan SCENE",
               "give one or more [[rope]]",
               {{{"rope = []\n", "[[rope]]\n" + kHang}}}},
        Remedy{"table",
               scene_of("camera = 1\n[[rope]]\n" + kHang),
               "plan SCENE",
               "write [camera]",
               {{{"camera = 1\n", "[camera]\n"}}}},
        Remedy{"boolean",
               rope_scene(kHang + "closed = 0"),
               "plan SCENE",
               "give true or false",
               {{{"= 0\n", "= false\n"}}}},
        Remedy{"number_out_of_range",
               rope_scene(kHang + "mass = -1"),
               "plan SCENE",
               "give the mass",
               {{{"-1", "1e-9"}}}},
        Remedy{"too_large_a_picture",
               rope_scene(kHang),
               "plan SCENE --set video.size=[16384,16384]",
               "give a smaller size",
               {{{"[16384,16384]", "[2000,2000]"}}}},
        Remedy{"syntax",
               rope_scene(kHang + "mass ="),
               "plan SCENE",
               "see https://toml.io for the syntax",
               {{{"mass =", "mass = 1"}}}},
        Remedy{"long_key",
               rope_scene(kHang + "a.b.c.d.e.f.g.h.a.b.c.d.e.f.g.h.a.b.c.d.e.f.g.h.a.b.c.d.e.f.g.h.a = 1"),
               "plan SCENE",
               "give a key of the scene format",
               {{{"a.b.c.d.e.f.g.h.a.b.c.d.e.f.g.h.a.b.c.d.e.f.g.h.a.b.c.d.e.f.g.h.a", "mass"}}}}),
    test::kNameOfCase);

const std::string kByTension = "[style]\ncolor_by = \"tension\"\n";

INSTANTIATE_TEST_SUITE_P(
    OfColours, SceneRemedies,
    testing::Values(
        Remedy{
            "colours_of_links",
            rope_scene(kHang + "color = [\"red\", \"blue\"]\n"),
            "plan SCENE",
            "set style.color_by = \"link\", or give one colour",
            {{{"[\"red\", \"blue\"]", "\"red\""}}, {{"[world]", "[style]\ncolor_by = \"link\"\n[world]"}}}},
        Remedy{"tensions_by_relaxation",
               rope_scene(kHang, method_of("relaxation") + kByTension),
               "plan SCENE",
               "give \"speed\" or \"strain\", or another solver.method",
               {{{"\"tension\"", "\"speed\""}},
                {{"\"tension\"", "\"strain\""}},
                {{"\"relaxation\"", "\"exact\""}}}},
        Remedy{"tensions_of_dependent_bars",
               net_scene(kGrid, kByTension),
               "plan SCENE",
               "set style.color_by = \"strain\" or \"speed\", style.arrows = \"velocity\" or \"weight\", "
               "or let the bars stretch by a compliance",
               {{{"\"tension\"", "\"speed\""}},
                {{"\"tension\"", "\"strain\""}},
                {{kGrid, kGrid + "compliance = 1e-4\n"}}}},
        Remedy{"tension_arrows_of_dependent_bars",
               net_scene(kGrid, "[style]\narrows = \"tension\"\n"),
               "plan SCENE",
               "scene.toml:6:10: style.arrows: tensions are asked for, which the method does not know",
               {{{"\"tension\"", "\"velocity\""}},
                {{"\"tension\"", "\"weight\""}},
                {{kGrid, kGrid + "compliance = 1e-4\n"}}}}),
    test::kNameOfCase);

TEST(UnknownTensions, HaveACauseAndARemedyThatHelps) {
    const ScratchFolder folder;
    const std::string plate =
        folder.write("plate.toml",
                     "schema = 1\n[world]\nduration = 0.1\n[[net]]\npinned = [0]\n"
                     "grid = { columns = 3, rows = 3, spacing = 0.1, diagonals = true }\n");
    const auto warning = [&](const std::string& setting) {
        return run_corda({"simulate", plate, "-o", "-", "--tension", "--set", setting}).err;
    };
    EXPECT_THAT(warning("solver.method=auto"),
                testing::AllOf(testing::HasSubstr("bars that depend on each other"),
                               testing::Not(testing::HasSubstr("relaxation"))));
    EXPECT_THAT(warning("net[0].compliance=1e-3"), testing::Not(testing::HasSubstr("--tension")));
    const std::string relaxed = warning("solver.method=relaxation");
    EXPECT_THAT(relaxed, testing::AllOf(testing::HasSubstr("another solver.method gives them"),
                                        testing::Not(testing::HasSubstr("compliance"))));
}

TEST(ImmobileNets, AreReportedUntilTheAdviceIsFollowed) {
    using testing::HasSubstr;
    using testing::Not;
    const ScratchFolder folder;
    const std::string plate = folder.write("plate.toml",
                                           "schema = 1\n[[net]]\ngrid = { columns = 5, rows = 4, spacing = "
                                           "0.1, diagonals = true }\n[world]\nduration = 0.2\n");
    EXPECT_THAT(run_corda({"plan", plate}).err, HasSubstr("net 0 stands still: its bars make it a plate"));
    for (const char* advice : {"net[0].pinned=[0]", "net[0].compliance=1e-3", "solver.method=relaxation"}) {
        const auto result = run_corda({"plan", plate, "--set", advice});
        EXPECT_EQ(result.exit_code, 0) << result.err;
        EXPECT_THAT(result.err, Not(HasSubstr("stands still"))) << advice;
    }
    // A curtain whose top row is straight between its pins.
    const auto curtain = [&](const std::string& advice) {
        return run_corda({"plan", plate, "--set", "net[0].grid.diagonals=false", "--set", advice}).err;
    };
    EXPECT_THAT(curtain("net[0].pinned=[0, 4]"),
                HasSubstr("net 0 stands still: it hangs from a straight row"));
    for (const char* advice :
         {"net[0].pinned=[0]", "net[0].compliance=1e-3", "net[0].pinned=[0, 1, 2, 3, 4]"})
        EXPECT_THAT(curtain(advice), Not(HasSubstr("stands still"))) << advice;
    // With a string, which relaxation cannot move.
    const std::string scene =
        test::read_file(plate) + "[[rope]]\nhang = { links = 2, length = 1.0 }\nstring = true\n";
    const std::string both = folder.write("both.toml", scene);
    EXPECT_THAT(run_corda({"plan", both}).err,
                HasSubstr("or give it method relaxation in [[solver.bodies]]"));
    const std::string mixed =
        folder.write("mixed.toml", scene + "[[solver.bodies]]\nnets = [0]\nmethod = 'relaxation'\n");
    const auto result = run_corda({"plan", mixed});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("stands still")));
}

}  // namespace
}  // namespace corda
