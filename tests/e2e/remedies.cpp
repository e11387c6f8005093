// Provokes every message that advises something, and follows the advice literally: it has to work.

#include <gtest/gtest.h>

#include "corda/pipeline/film.hpp"
#include "support/remedy.hpp"

namespace corda {
namespace {

using namespace test;

class Remedies : public testing::TestWithParam<Remedy> {};

TEST_P(Remedies, Work) {
    test::expect_to_work(GetParam());
}

const std::string kPicture = CORDA_GOLDENS "/stills/plain_t0000_700000.png";

const std::string kStringRope = "[[rope]]\n" + kHang + "string = true\n";

// Systems that a method cannot run.
INSTANTIATE_TEST_SUITE_P(
    OfMethods, Remedies,
    testing::Values(
        Remedy{"rigid_graph",
               rope_scene(kRing, method_of("exact")),
               "simulate SCENE",
               "use method auto, or let the bars stretch by a compliance",
               {{{"exact", "rattle"}},
                {{"exact", "auto"}},
                {{"closed = true", "closed = true\ncompliance = 1e-3"}}}},
        Remedy{"rigid_net",
               net_scene(kSquare + kSides, method_of("exact")),
               "simulate SCENE",
               "use method auto, or let the bars stretch by a compliance",
               {{{"exact", "rattle"}}, {{kSides, kSides + "compliance = 1e-3\n"}}}},
        Remedy{"rigid_string",
               rope_scene(kHang + "string = true\n", method_of("rattle")),
               "simulate SCENE",
               "use method auto, or let the string stretch by a compliance",
               {{{"rattle", "exact"}},
                {{"rattle", "auto"}},
                {{"string = true", "string = true\ncompliance = 1e-3"}}}},
        Remedy{
            "taut_between_pins",
            rope_scene("line = { particles = 5, from = [0, 0], step = [0.25, 0.0] }\npinned = [0, -1]\n"),
            "simulate SCENE",
            "let the rope sag between its pins (other points, or a string with a larger link_length), or pin "
            "the particles between them too",
            {{{"line = { particles = 5, from = [0, 0], step = [0.25, 0.0] }",
               "points = [[0, 0], [0.25, -0.1], [0.5, -0.15], [0.75, -0.1], [1, 0]]"}},
             {{"pinned", "string = true\nlink_length = 0.26\npinned"}},
             {{"[0, -1]", "[0, 1, 2, 3, 4]"}}}},
        Remedy{
            "taut_string_between_pins",
            rope_scene("points = [[0, 0], [0.5, 0], [1, 0]]\npinned = [0, -1]\nstring = true\n"),
            "simulate SCENE",
            "let the rope sag between its pins (other points, or a string with a larger link_length), or pin "
            "the particles between them too",
            {{{"[0.5, 0]", "[0.5, -0.1]"}},
             {{"string = true", "string = true\nlink_length = 0.6"}},
             {{"[0, -1]", "[0, 1, -1]"}}}},
        Remedy{"dependent_bars",
               net_scene("points = [[0, 0], [1, 0], [2, 0]]\nbars = [[0, 1], [1, 2], [0, 2]]\n"
                         "pinned = [0]\n",
                         method_of("rattle")),
               "simulate SCENE",
               "bend collinear bars a little, leave out bars that others imply, or use method relaxation",
               {{{"[1, 0]", "[1, -0.01]"}}, {{", [0, 2]", ""}}, {{"rattle", "relaxation"}}}},
        Remedy{
            "ring_and_string",
            rope_scene(kRing + "[[rope]]\npoints = [[2, 0], [2.3, 0.1]]\nstring = true\nlink_length = 0.5\n",
                       method_of("rattle")),
            "simulate SCENE",
            "use method auto, or let the string stretch by a compliance",
            {{{"method = \"rattle\"\n",
               "method = \"rattle\"\n[[solver.bodies]]\nropes = [1]\nmethod = \"exact\"\n"}},
             {{"string = true", "string = true\ncompliance = 1e-3"}},
             {{"rattle", "auto"}}}},
        Remedy{"material",
               rope_scene(kHang + "compliance = 1e-3\nbending = 1.0\n", method_of("relaxation")),
               "simulate SCENE",
               "remove compliance, string and bending, or use method auto",
               {{{"compliance = 1e-3\nbending = 1.0\n", ""}},
                {{"relaxation", "exact"}},
                {{"relaxation", "auto"}}}},
        Remedy{"material_of_a_string",
               rope_scene(kHang + "string = true\n", method_of("relaxation")),
               "simulate SCENE",
               "remove compliance, string and bending, or use method auto",
               {{{"string = true", ""}}, {{"relaxation", "exact"}}, {{"relaxation", "auto"}}}},
        Remedy{"material_of_a_net",
               net_scene(kGrid + "compliance = 1e-3\n", method_of("relaxation")),
               "simulate SCENE",
               "remove compliance, string and bending, or use method auto",
               {{{"compliance = 1e-3", ""}}, {{"relaxation", "exact"}}, {{"relaxation", "auto"}}}},
        Remedy{"net_beside_a_string_by_relaxation",
               net_scene(kGrid, method_of("relaxation")) + kStringRope,
               "simulate SCENE",
               "or use method auto",
               {{{"relaxation", "auto"}}}},
        Remedy{"net_beside_a_string_by_exact",
               net_scene(kSquare + kSides, method_of("exact")) + kStringRope,
               "simulate SCENE",
               "use method auto",
               {{{"exact", "auto"}}}},
        Remedy{"net_beside_a_string_by_rattle",
               net_scene(kGrid, method_of("rattle")) + kStringRope,
               "simulate SCENE",
               "use method auto",
               {{{"rattle", "auto"}}}},
        Remedy{"diverges",
               rope_scene(kHang + "velocity = [1e5, 0]\n",
                          method_of("relaxation") + "step = 0.03\nforce = [1e300, 0]\n"),
               "simulate SCENE",
               "less speed or force may help, or a smaller solver.step",
               {{{"force = [1e300, 0]", "force = [1, 0]"}}}},
        Remedy{"diverges_of_unequal_masses",
               rope_scene(kHang + "mass = [1, 1, 1, 1, 1e-12]\n",
                          method_of("relaxation") + "force = [0, -1e6]\n"),
               "simulate SCENE",
               "less unequal masses of free particles (they differ by a factor of 1e+12)",
               {{{"1e-12", "1"}}}},
        Remedy{"speed",
               rope_scene("hang = { links = 1, length = 1.0 }\nvelocity = [1e9, 0]\n"),
               "simulate SCENE",
               "2 times the limit; give less speed, longer links",
               {{{"1e9", "1e4"}}, {{"length = 1.0", "length = 1e5"}}}}),
    test::kNameOfCase);

// Limits of a scene.
INSTANTIATE_TEST_SUITE_P(
    OfLimits, Remedies,
    testing::Values(
        Remedy{"frames",
               rope_scene(kHang),
               "plan SCENE --set world.duration=1e6",
               "give a shorter duration or fewer frames per second",
               {{{"1e6", "1"}},
                {{"plan SCENE --set world.duration=1e6", "plan SCENE --fps 1/10 --set world.duration=10"}}}},
        Remedy{"no_frame",
               rope_scene(kHang),
               "plan SCENE --duration 1e-12",
               "hold no frame; give a longer duration",
               {{{"1e-12", "0.1"}}}},
        Remedy{
            "steps",
            rope_scene("hang = { links = 1, length = 1 }", method_of("rattle") + "order = 2\nstep = 9e-9\n"),
            "plan SCENE --duration 9.1",
            "give a longer step or a shorter duration",
            {{{"9e-9", "1e-3"}}, {{"--duration 9.1", "--duration 0.004"}}}},
        Remedy{"bar_updates",
               rope_scene("hang = { links = 1, length = 1 }",
                          method_of("relaxation") + "sweeps = 1000000\nstep = 5e-9\n"),
               "plan SCENE --duration 0.051",
               "give fewer of one of them",
               {{{"5e-9", "1e-2"}}, {{"0.051", "0.001"}, {"1000000", "1"}}}},
        Remedy{
            "particles",
            rope_scene("line = { particles = 1000000, step = [0.1, 0] }\n[[rope]]\n" + kHang),
            "plan SCENE",
            "the ropes and nets up to this one have 1000005 particles, over the limit of 1000000; give fewer",
            {{{"1000000", "10"}}}},
        Remedy{"bars",
               rope_scene("line = { particles = 100000, step = [0.1, -0.1] }",
                          method_of("relaxation") + "reach = 1000\n"),
               "plan SCENE",
               "give fewer particles, or the solver a smaller reach",
               {{{"100000", "100"}}, {{"1000\n", "1\n"}}}},
        Remedy{"stiffness",
               rope_scene(kHang + "mass = 0.1\ncompliance = 1e-25"),
               "plan SCENE --duration 0.1",
               "give more compliance, less bending or heavier particles",
               {{{"1e-25", "1e-3"}}}},
        Remedy{"stiff_bending",
               rope_scene("hang = { links = 4, length = 0.1 }\nmass = 1e-12\nbending = 1e12"),
               "plan SCENE --duration 0.1",
               "give more compliance, less bending or heavier particles",
               {{{"1e12", "1e-12"}}}},
        Remedy{"drag",
               rope_scene(kHang),
               "plan SCENE --set world.drag=1e14",
               "give less drag",
               {{{"1e14", "1"}}}},
        Remedy{"turns",
               rope_scene(kHang + "velocity = [[0, 0], [1e14, 0], [0, 0], [0, 0], [0, 0]]"),
               "plan SCENE",
               "give less speed or longer links",
               {{{"1e14", "1"}}}},
        Remedy{"swings",
               rope_scene(kHang),
               "plan SCENE --set world.gravity=1e26",
               "give less gravity or longer links",
               {{{"1e26", "1"}}}}),
    test::kNameOfCase);

// Options of commands.
INSTANTIATE_TEST_SUITE_P(
    OfCommands, Remedies,
    testing::Values(
        Remedy{"setting",
               rope_scene(kHang),
               "plan SCENE --set video.fps",
               "give --set key=value, e.g. --set video.fps=30 or --set rope[0].mass=2",
               {{{"video.fps", "video.fps=30"}}, {{"video.fps", "rope[0].mass=2"}}}},
        Remedy{"setting_of_a_list",
               rope_scene(kHang),
               "plan SCENE --set rope.mass=2",
               "give an index: rope[0]",
               {{{"rope.mass", "rope[0].mass"}}}},
        Remedy{"setting_out_of_range",
               rope_scene(kHang),
               "plan SCENE --set rope[1].mass=2",
               "index 1 is out of range; the list has 1",
               {{{"rope[1]", "rope[0]"}}}},
        Remedy{"size",
               rope_scene(kHang),
               "plan SCENE --size 64by64",
               "write e.g. 1920x1080",
               {{{"64by64", "1920x1080"}}}},
        Remedy{"duration_that_is_none",
               rope_scene(kHang),
               "plan SCENE --duration nan",
               "give the duration in s, > 0",
               {{{"nan", "0.1"}}}},
        Remedy{"scene_is_missing",
               rope_scene(kHang),
               "plan DIR/none.toml",
               "give the path of a TOML file",
               {{{"DIR/none.toml", "SCENE"}}}},
        Remedy{
            "misspelt_command", rope_scene(kHang), "pla SCENE", "did you mean plan?", {{{"pla ", "plan "}}}},
        Remedy{"unknown_command", rope_scene(kHang), "zzzzz SCENE", "known are", {{{"zzzzz", "plan"}}}},
        Remedy{"misspelt_option",
               rope_scene(kHang),
               "plan SCENE --duratin 0.1",
               "did you mean --duration?",
               {{{"duratin", "duration"}}}},
        Remedy{"misspelt_help", "", "help rendr", "did you mean render?", {{{"rendr", "render"}}}},
        Remedy{"usage",
               rope_scene(kHang),
               "plan",
               "see --help",
               {{{"plan", "plan --help"}}, {{"plan", "plan SCENE"}}}},
        Remedy{"empty_value",
               rope_scene(kHang),
               "plan SCENE --duration EMPTY",
               "give one, or leave it out",
               {{{"EMPTY", "0.1"}}, {{"--duration EMPTY", ""}}}},
        Remedy{"ending_of_states",
               rope_scene(kHang),
               "simulate SCENE -o DIR/a.npy",
               "give such a name, or - for CSV on standard output",
               {{{"DIR/a.npy", "DIR/a.csv"}}, {{"DIR/a.npy", "-"}}}},
        Remedy{"two_on_standard_output",
               rope_scene(kHang),
               "simulate SCENE -o - --json",
               "give the CSV a file name",
               {{{"-o -", "-o DIR/a.csv"}}}},
        Remedy{"ending_of_stills",
               rope_scene(kHang),
               "still SCENE --at 0 -o DIR/a.v2 --dry-run",
               "stills are written as .png, .svg or .pdf; give such a name, or a folder (ending with / if "
               "its name has a dot)",
               {{{"a.v2", "a.png"}},
                {{"a.v2", "a.svg"}},
                {{"a.v2", "a.pdf"}},
                {{"a.v2", "a"}},
                {{"a.v2", "a.v2/"}}}},
        Remedy{"time_of_a_still",
               rope_scene(kHang),
               "still SCENE --at 5 -o DIR/a.png --dry-run",
               "is not within 0 .. 0.1 s; world.duration sets the end",
               {{{"--at 5", "--at 0"}},
                {{"--at 5", "--at 0.1"}},
                {{"--at 5", "--at 5 --set world.duration=5"}}}},
        Remedy{"frame_of_a_still",
               rope_scene(kHang),
               "still SCENE --frame 99 -o DIR/a.png --dry-run",
               "the frames are 0 to 2, all of them the range 0:3; world.duration sets the end",
               {{{"--frame 99", "--frame 2"}},
                {{"--frame 99 -o DIR/a.png", "--frame 0:3 -o DIR/a"}},
                {{"--frame 99", "--frame 99 --set world.duration=5"}}}},
        Remedy{"same_still_twice",
               rope_scene(kHang),
               "still SCENE --at 0,0 -o DIR/a --dry-run",
               "ask for each time once",
               {{{"0,0", "0"}}}},
        Remedy{"one_file_for_two_stills",
               rope_scene(kHang),
               "still SCENE --at 0,0.1 -o DIR/a.png --dry-run",
               "give a folder",
               {{{"a.png", "a"}}}},
        Remedy{"cells_of_a_sheet",
               rope_scene(kHang),
               "sheet SCENE --frame 0:3 --size 100x64 -o DIR/a.png --dry-run",
               "(each takes 40 at least), 2 have; ask for fewer times or a larger size",
               {{{"0:3", "0:2"}}, {{"100x64", "200x100"}}}},
        Remedy{"odd_size",
               rope_scene(kHang),
               "render SCENE --size 65x64 -o DIR/a.mp4 --dry-run",
               "use a width of 64 or 66",
               {{{"65x64", "64x64"}}, {{"65x64", "66x64"}}}},
        Remedy{"ending_of_a_video",
               rope_scene(kHang),
               "render SCENE -o DIR/a.txt --dry-run",
               "use .mp4",
               {{{"a.txt", "a.mp4"}}}},
        Remedy{"unknown_preset",
               rope_scene(kHang),
               "render SCENE --preset slooow -o DIR/a.mp4 --dry-run",
               "medium, slow, slower",
               {{{"slooow", "slow"}}}},
        Remedy{"crf",
               rope_scene(kHang),
               "render SCENE --crf 0 -o DIR/a.mp4 --dry-run",
               "1 .. 63",
               {{{"--crf 0", "--crf 1"}}, {{"--crf 0", "--crf 51"}}}},
        Remedy{"crf_of_another_codec",
               rope_scene(kHang),
               "render SCENE --crf 52 -o DIR/a.mp4 --dry-run",
               "use 1 to 51 for libx264",
               {{{"--crf 52", "--crf 51"}}}},
        Remedy{"crf_of_pictures",
               rope_scene(kHang),
               "render SCENE --crf 20 -o DIR/a.mkv --dry-run",
               "has no rate factor; leave it out",
               {{{"--crf 20", ""}}}},
        Remedy{"preset_of_another_codec",
               rope_scene(kHang),
               "render SCENE --preset slow --codec av1 -o DIR/a.mp4 --dry-run",
               "unknown to libsvtav1; use one of 0, 1",
               {{{"--preset slow", "--preset 0"}}}},
        Remedy{"rate_of_a_gif",
               rope_scene(kHang),
               "render SCENE --fps 60 -o DIR/a.gif --dry-run",
               "use 50 (--fps 50)",
               {{{"--fps 60", "--fps 50"}}}},
        Remedy{"slow_rate_of_a_gif",
               rope_scene(kHang),
               "render SCENE --fps 1/1000 --duration 2000 -o DIR/a.gif --dry-run",
               "use 20/13107 (--fps 20/13107)",
               {{{"--fps 1/1000", "--fps 20/13107"}}}},
        Remedy{"pixels_of_pictures",
               rope_scene(kHang),
               "render SCENE --pix 420 -o DIR/a.mkv --dry-run",
               "use rgba, another codec, or leave it out",
               {{{"--pix 420", "--pix rgba"}}, {{"--pix 420", ""}}}},
        Remedy{"video_as_one_picture",
               rope_scene(kHang),
               "render SCENE -o DIR/a.png --dry-run",
               "use e.g. frames/%04d.png",
               {{{"a.png", "frames/%04d.png"}}}},
        Remedy{"codec_of_another_ending",
               rope_scene(kHang),
               "render SCENE --codec vp9 -o DIR/a.mp4 --dry-run",
               "use libx264, libsvtav1, libx265, libaom-av1, h264_nvenc",
               {{{"vp9", "libx264"}}, {{"vp9", "libsvtav1"}}, {{"vp9", "libx265"}}}},
        Remedy{"size_too_small_for_a_codec",
               rope_scene(kHang),
               "render SCENE --codec av1 --size 32x32 -o DIR/a.mp4 --dry-run",
               "use sides of 64 or more",
               {{{"32x32", "64x64"}}}},
        Remedy{"output_folder",
               rope_scene(kHang),
               "render SCENE -o DIR/none/a.mp4 --dry-run",
               "does not exist; make it first",
               {{{"none/", ""}}}},
        Remedy{"output_is_a_folder",
               rope_scene(kHang),
               "simulate SCENE -o DIR",
               "give the name of a file, not of a folder",
               {{{"-o DIR", "-o DIR/a.csv"}}}},
        Remedy{"backend",
               rope_scene(kHang),
               "render SCENE --backend magic -o DIR/a.mp4 --dry-run",
               "use auto, device, device:N, surfaceless or default",
               {{{"magic", "auto"}},
                {{"magic", "device"}},
                {{"magic", "device:0"}},
                {{"magic", "surfaceless"}},
                {{"magic", "default"}}}},
        Remedy{"difference_picture",
               rope_scene(kHang),
               "compare " + kPicture + " " + kPicture + " --diff DIR/c.jpg",
               "the picture is written as .png; give such a name",
               {{{"c.jpg", "c.png"}}}}),
    test::kNameOfCase);

/// The message with which a scene from code, which no file reader has checked, is refused.
void expect_refused(const Scene& scene, const std::string& advice) {
    try {
        Film film(scene);
        ADD_FAILURE() << "not refused: " << advice;
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(advice), std::string::npos) << error.what();
    }
}

void expect_to_run(const Scene& scene) {
    Film film(scene);
    EXPECT_NO_THROW(static_cast<void>(film.state(film.last_frame())));
}

Scene scene_in_code(const std::vector<Vec2>& points_m, const SolverDef& solver) {
    Scene scene;
    scene.ropes.resize(1);
    scene.ropes[0].points_m = points_m;
    scene.solver = solver;
    scene.world.duration_s = 0.1;
    return scene;
}

TEST(RemediesInCode, BarWithoutLength) {
    Scene scene = scene_in_code({{0.0, 0.0}, {0.5, 0.0}, {0.5, 0.0}}, AutoDef{});
    expect_refused(scene, "move one, or use method relaxation");
    scene.solver = RelaxationDef{};
    expect_to_run(scene);
    scene.solver = AutoDef{};
    scene.ropes[0].points_m[2].y = -0.5;
    expect_to_run(scene);
}

TEST(RemediesInCode, ImaginaryBars) {
    Scene scene = scene_in_code({{0.0, 0.0}, {0.5, 0.0}, {1.0, -0.1}}, ExactDef{});
    scene.ropes[0].reach = 2;
    expect_refused(scene,
                   "remove the imaginary bars (solver.reach, net.grid.diagonals) or use method relaxation");
    scene.solver = RelaxationDef{};
    expect_to_run(scene);
    scene.solver = ExactDef{};
    scene.ropes[0].reach = 1;
    expect_to_run(scene);
}

TEST(RemediesInCode, RigidStrings) {
    Scene scene = scene_in_code({{0.0, 0.0}, {0.5, 0.0}, {0.6, -0.4}}, AutoDef{});
    RopeDef& rope = scene.ropes[0];
    rope.material.is_string = true;
    const auto stretched = [&] {
        Scene stretching = scene;
        stretching.ropes[0].material.compliance_1_n = 1e-3;
        return stretching;
    };
    rope.closed = true;
    scene.solver = ExactDef{};  // auto would choose rattle, and the message would advise exact
    expect_refused(scene, "open it, or let it stretch by a compliance");
    expect_to_run(stretched());
    rope.closed = false;
    expect_to_run(scene);
    rope.bending_n_m2 = 1.0;
    expect_refused(scene, "remove bending, or let the string stretch by a compliance");
    expect_to_run(stretched());
    rope.bending_n_m2 = 0.0;
    rope.rest_m = {0.4, 0.4};
    expect_to_run(scene);  // it starts pulled in
    rope.pinned = {0, 2};
    expect_refused(scene, "give a larger link_length, or a compliance");
    expect_to_run(stretched());
    rope.pinned = {0};
    rope.rest_m = {0.5, 0.5};
    expect_to_run(scene);
}

}  // namespace
}  // namespace corda
