// What is written reads as the same scene, bit for bit.
#include "corda/scene/write_scene.hpp"

#include <gmock/gmock.h>

#include <filesystem>

#include "support.hpp"

namespace corda {
namespace {

/// Expects that `scene` is what its text says; returns the text.
std::string expect_round_trip(const Scene& scene) {
    const std::string toml = write_scene(scene);
    const Scene again = parse_scene(toml, "again.toml");
    EXPECT_THAT(differences(values_of(scene), values_of(again)), testing::IsEmpty());
    EXPECT_EQ(write_scene(again), toml);
    return toml;
}

TEST(WriteScene, EveryExampleAndGoldenComesBack) {
    int count = 0;
    for (const std::string folder : {CORDA_EXAMPLES, CORDA_GOLDENS "/scenes"}) {
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            if (entry.path().extension() != ".toml") continue;
            SCOPED_TRACE(entry.path().string());
            expect_round_trip(load_scene(entry.path().string()));
            ++count;
        }
    }
    EXPECT_GE(count, 40);  // measured: 46
}

TEST(WriteScene, EveryKeyComesBack) {
    for (const std::string& toml : {
             scene::rope_with(
                 "mass = [1, 2.5, 0.1]\nvelocity = [[0, 0], [1e-17, -3], [0.1, 0]]\npinned = [0, -1]\n"
                 "[solver]\nmethod = \"exact\"\ntolerance = 1e-12\n"),
             scene::square_with(
                 "closed = true\ncompliance = 1e-5\nlink_length = [1, 1.1, 1.2, 1.30000000001]\n"
                 "color = [\"#ff000080\", \"#00ff0080\"]\nwidth_px = 3.5\n"
                 "[style]\ncolor_by = \"link\"\n"),
             scene::rope_with(
                 "pinned = [0, -1]\nmoves = [{ pin = 0, waves = [{ amplitude = [0.1, 0], frequency = 1.2, "
                 "phase_deg = 90 }] }, { pin = -1, path = [{ t = 0.5, by = [0, 0] }, { t = 1, by = [0.1, 3] "
                 "}] }]\n[world]\ndrag = 0.5\nwind = [1, -2]\n"
                 "gusts = { amplitude = [2, 0.1], frequency = 0.4, phase_deg = 30 }\n"),
             scene::grid_with(
                 "moves = [{ pin = [2, 0], waves = [{ amplitude = [0, 1], frequency = 2 }] }]\n"),
             scene::rope_with("pinned = [0, -1]\nrelease = [{ pin = -1, t = 0.1 }, { pin = 0, t = 0 }]\n"
                              "cut = [{ link = -1, t = 1e-3 }]\n"),
             scene::grid_with("release = [{ pin = [2, 0], t = 2 }]\ncut = [{ link = 3, t = 1 }]\n"),
             scene::square_with("origin = [0.1, 1e8]\nbending = 1e-3\n"),
             std::string("schema = 1\n[[rope]]\nhang = { lengths = [1, 0.7], angles_deg = [120, -30], "
                         "rates_deg_s = [10, 0.1], from = [1, 2] }\n"),
             scene::grid_with(
                 "compliance = 1e-4\nstring = true\n[solver]\nmethod = \"relaxation\"\nreach = 3\n"),
             scene::graph_with("[[0, 1], [1, 2], [2, 3]]", "pinned = []\n"),
             scene::with(
                 "net = [{ points = [[0, 0], [1, 0]], bars = [[0, 1]] }]\n"
                 "[solver]\nmethod = \"rattle\"\norder = 6\nstep = 1e-3\n"
                 "[[solver.bodies]]\nnets = [0]\nmethod = \"relaxation\"\nforce = [0, -1]\n"
                 "[video]\nfps = \"30000/1001\"\nsize = [64, 36]\ncodec = \"h265\"\ncrf = 20\npix = \"444\"\n"
                 "[style]\nbackground = [\"#102030\", \"#405060\"]\npalette = [\"red\"]\ntheme = \"paper\"\n"
                 "[overlay]\ntitle = 'a \"quoted\" \\ title: Ä'\ntime = false\nplots = [\"tip\", "
                 "\"energy\"]\nlanguage = \"de\"\n"
                 "[camera]\ncenter = [0.1, -0.3]\nheight = 3.3\nmargin = 0.1\n"),
             scene::with("[style]\ncolor_by = \"speed\"\ncolor_range = [-0.1, 7]\narrows = \"weight\"\n"
                         "arrow_scale = 2.5\npayload_radius = 0.03\n"
                         "[overlay]\nplots = [\"phase\", \"energy\"]\nenergy_zero = \"lowest\"\n"
                         "plot_range = { angle = [-90, 90], phase = [-4, 4], energy = [0, 1e3] }\n"),
         }) {
        SCOPED_TRACE(toml);
        expect_round_trip(parse_scene(toml, "scene.toml"));
    }
}

TEST(WriteScene, KeepsATaperAndTheParticlesOfTrails) {
    const Scene scene =
        parse_scene(scene::rope_with(
                        "width_px = [9, 1.5]\n[style]\ntrail_s = 1\ntrail_of = [1, -1]\narrows = \"weight\""),
                    "a");
    EXPECT_EQ(scene.body_styles[0].width_px, 9.0);
    EXPECT_EQ(scene.body_styles[0].end_width_px, 1.5);
    EXPECT_EQ(scene.style.trail_of, (std::vector<int>{1, -1}));
    EXPECT_EQ(scene.style.arrows, Arrows::kWeight);
    const std::string toml = expect_round_trip(scene);
    EXPECT_THAT(toml, testing::HasSubstr("width_px = [9, 1.5]"));
    EXPECT_THAT(toml, testing::HasSubstr("trail_of = [1, -1]"));
}

TEST(WriteScene, KeepsPointsFarFromTheirOrigin) {
    // 100.1 + 0.1 and back is not 0.1: the offsets must stand in the file.
    const std::string toml =
        "schema = 1\n[[rope]]\nhang = { links = 7, length = 0.7, angle_deg = 33, "
        "from = [100.1, -1e6] }\n";
    expect_round_trip(parse_scene(toml, "scene.toml"));
}

TEST(WriteScene, StraightRopesAndGridsStayShort) {
    const Scene line = parse_scene(scene::rope_with(""), "scene.toml");
    EXPECT_THAT(write_scene(line), testing::HasSubstr("line = { particles = 3,"));
    const Scene grid = parse_scene(
        "schema = 1\n[[net]]\ngrid = { columns = 200, rows = 100, spacing = 0.1, "
        "from = [3, 0.1] }\npinned = [0]\n",
        "scene.toml");
    const std::string toml = expect_round_trip(grid);
    EXPECT_THAT(toml, testing::HasSubstr("grid = { columns = 200, rows = 100, from = [3, 0.1]"));
    EXPECT_LT(toml.size(), 1500U);  // measured: 760
}

TEST(WriteScene, KeepsTheShapesOfTheFile) {
    const Scene scene = parse_scene(
        "schema = 1\n[world]\ngravity = 1.62\n"
        "[[rope]]\nhang = { links = 20, length = 1.5, angle_deg = 45 }\nmass = 0.1\n"
        "[[net]]\ngrid = { columns = 3, rows = 1, spacing = 0.25, diagonals = false }\n",
        "scene.toml");
    const std::string toml = expect_round_trip(scene);
    EXPECT_THAT(toml, testing::HasSubstr("\ngravity = 1.62\n"));
    EXPECT_THAT(toml,
                testing::HasSubstr("\nhang = { links = 20, length = 1.5, angle_deg = 45, from = [0, 0] }\n"));
    EXPECT_THAT(toml, testing::HasSubstr("\nmass = 0.1\n"));
    EXPECT_THAT(toml, testing::HasSubstr("\ngrid = { columns = 3, rows = 1, from = [0, 0], spacing = 0.25, "
                                         "diagonals = false }\n"));
}

TEST(WriteScene, SceneFilledInCodeComesBack) {
    Scene scene;
    RopeDef& rope = scene.ropes.emplace_back();
    rope.origin_m = {0.3, 0.7};
    rope.points_m = {{0.1, -0.0}, {1.0 / 3.0, 1e-9}};
    const Scene again = parse_scene(write_scene(scene), "again.toml");
    EXPECT_EQ(again.ropes[0].origin_m, (Vec2{0.3, 0.7}));
    EXPECT_EQ(again.ropes[0].points_m, rope.points_m);
}

TEST(WriteScene, RefusesWhatAFileCannotSay) {
    const Scene sound = parse_scene(scene::rope_with("[solver]\nmethod = \"rattle\"\n"), "scene.toml");
    const auto refused = [](const Scene& scene) {
        try {
            return write_scene(scene).empty();
        } catch (const Error& error) {
            return error.code() == ExitCode::kUsage;
        }
    };
    EXPECT_FALSE(refused(sound));
    Scene scene = sound;
    std::get<RattleDef>(scene.solver).guard = 0.3;
    EXPECT_TRUE(refused(scene));
    scene = sound;
    scene.ropes[0].reach = 2;
    EXPECT_TRUE(refused(scene));
    scene = sound;
    scene.overlay.title = "two\nlines";
    EXPECT_TRUE(refused(scene));
    scene = sound;
    NetDef& net = scene.nets.emplace_back();
    net.points_m = {{0, 0}, {1, 0}, {0, 3}};
    net.bars = {{0, 1, true}, {0, 2, false}};
    EXPECT_TRUE(refused(scene));
}

}  // namespace
}  // namespace corda
