// What asks for too much is refused before any memory is taken: these tests return at once.
#include <gmock/gmock.h>

#include "corda/scene/schema.hpp"
#include "unit/scene/support.hpp"

namespace corda::scene {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string line_of(const std::string& particles) {
    return "schema = 1\n[[rope]]\nline = { particles = " + particles + ", step = [0, -0.001] }\n";
}

void expect_limit(const std::string& toml, const std::string& begin, const std::string& part) {
    SCOPED_TRACE(toml.substr(0, 200));
    const SceneError error = error_of(toml);
    EXPECT_EQ(error.code, ExitCode::kInvalidScene);
    EXPECT_THAT(error.message, StartsWith(begin));
    EXPECT_THAT(error.message, HasSubstr(part));
}

TEST(SceneLimits, Particles) {
    expect_limit(line_of("1000000000"),
                 "swing.toml:3:22: rope[0].line.particles: ", "1000000000 is not <= 1e6");
    expect_limit(line_of("9223372036854775807"),
                 "swing.toml:3:22: rope[0].line.particles: ", "9223372036854775807 is not <= 1e6");
    expect_limit("schema = 1\n[[rope]]\nhang = { links = 1000000, length = 1 }\n",
                 "swing.toml:3:18: rope[0].hang.links: ", "1000000 is not <= 999999");
}

TEST(SceneLimits, ParticlesOfAllRopesTogether) {
    const std::string rope = "[[rope]]\nline = { particles = 600000, step = [0, -0.001] }\n";
    expect_limit("schema = 1\nsolver.method = \"relaxation\"\nsolver.reach = 1\n" + rope + rope,
                 "swing.toml:6:1: rope[1]: ", "1200000 particles, over the limit of 1000000");
}

TEST(SceneLimits, Bars) {
    expect_limit(
        line_of("1000000") + "[solver]\nmethod = \"relaxation\"\nreach = 21\n", "swing.toml:2:1: rope[0]: ",
        "20999769 bars, over the limit of 20000000; give fewer particles, or the solver a smaller reach");
    expect_limit(line_of("1000000") + "[solver]\nmethod = \"relaxation\"\nreach = 1000000\n",
                 "swing.toml:2:1: rope[0]: ", "bars");
}

TEST(SceneLimits, ParticlesOfNets) {
    const auto grid = [](const std::string& columns, const std::string& rows) {
        return "[[net]]\ngrid = { columns = " + columns + ", rows = " + rows +
               ", spacing = 0.001, diagonals = false }\n";
    };
    expect_limit("schema = 1\n" + grid("1000001", "1"),
                 "swing.toml:3:20: net[0].grid.columns: ", "1000001 is not <= 1e6");
    expect_limit("schema = 1\n" + grid("1000000", "1000000"),
                 "swing.toml:2:1: net[0]: ", "1000000000000 particles, over the limit of 1000000");
    expect_limit("schema = 1\nsolver.method = \"relaxation\"\n" + grid("1000", "600") +
                     "[[rope]]\nline = { particles = 600000, step = [0, -0.001] }\n",
                 "swing.toml:3:1: net[0]: ",
                 "the ropes and nets up to this one have 1200000 particles, over the limit of 1000000");
}

TEST(SceneLimits, BarsOfNetsCountWithTheRopes) {
    // A rope of 950000 particles with bars up to reach 21 has 19949769 of them, a grid of 200 x 200 158802.
    expect_limit(
        "schema = 1\n[[net]]\ngrid = { columns = 200, rows = 200, spacing = 0.001, diagonals = true "
        "}\n[[rope]]\n"
        "line = { particles = 950000, step = [0, -0.001] }\n[solver]\nmethod = \"relaxation\"\n"
        "reach = 21\n",
        "swing.toml:2:1: net[0]: ", "20108571 bars, over the limit of 20000000; give fewer");
}

TEST(SceneLimits, BarUpdatesOfNets) {
    expect_limit(
        "schema = 1\n[[net]]\ngrid = { columns = 1000, rows = 1000, spacing = 0.001, diagonals = true "
        "}\n[solver]\n"
        "method = \"relaxation\"\nsweeps = 1000000\n",
        "swing.toml:6:10: solver.sweeps: ",
        "3994002 bars, 1000000 sweeps and 600 steps are 2.3964e+15 bar updates");
}

TEST(SceneLimits, ParticlesOfANetWhoseBarsAreFactored) {
    const std::string net =
        "schema = 1\n[[net]]\ngrid = { columns = 1000, rows = 501, spacing = 0.001, diagonals = true }\n";
    expect_limit(net, "swing.toml:2:1: net[0]: ",
                 "501000 particles are over the limit of 500000 for a net that relaxation does not move");
    EXPECT_NO_THROW(static_cast<void>(parse_scene(net + "[solver]\nmethod = \"relaxation\"\n", "a")));
}

TEST(SceneLimits, ASceneOfNetsAloneFailsAtTheFirst) {
    expect_limit(
        "schema = 1\n[[net]]\ngrid = { columns = 1000, rows = 1000, spacing = 0.001, diagonals = true }\n"
        "[[net]]\ngrid = { columns = 2, rows = 1, spacing = 1 }\n[solver]\nmethod = \"relaxation\"\n",
        "swing.toml:4:1: net[1]: ", "1000002 particles, over the limit");
}

TEST(SceneLimits, AFullRopeFits) {
    EXPECT_EQ(parse_scene(line_of("1000000"), "a").ropes[0].points_m.size(), 1'000'000U);
}

TEST(SceneLimits, Pictures) {
    expect_limit(with("[video]\nsize = [100000, 2]"),
                 "swing.toml:4:9: video.size[0]: ", "100000 is not <= 16384");
    expect_limit(with("[video]\nsize = [16384, 16384]"), "swing.toml:4:8: video.size: ",
                 "16384 x 16384 are 268435456 pixels, over the limit of 67108864");
    EXPECT_EQ(parse_scene(with("video.size = [16384, 4096]"), "a").video.width_px, 16384);
}

TEST(SceneLimits, Frames) {
    expect_limit(with("[world]\nduration = 1e12"), "swing.toml:4:12: world.duration: ",
                 "1e+12 s at 60 frames per second are 6e+13 frames, over the limit of 10000000");
    expect_limit(with("[world]\nduration = 1e308"),
                 "swing.toml:4:12: world.duration: ", "frames, over the limit");
    expect_limit(with("[world]\nduration = 1e-300"), "swing.toml:4:12: world.duration: ", "hold no frame");
    expect_limit(with("[world]\nduration = 1e99\n[style]\ntrail_s = 2.0"),
                 "swing.toml:4:12: world.duration: ", "are 6e+100 frames, over the limit");
    EXPECT_EQ(parse_scene(with("world.duration = 100\nvideo.fps = 100000"), "a").world.duration_s, 100.0);
}

TEST(SceneLimits, Steps) {
    expect_limit(with("[solver]\nmethod = \"rattle\"\nstep = 1e-9"),
                 "swing.toml:5:8: solver.step: ", "10 s are 1e+10 steps, over the limit of 1000000000");
}

TEST(SceneLimits, BarUpdates) {
    expect_limit(
        line_of("1000000") + "[solver]\nmethod = \"relaxation\"\nsweeps = 1000000\n",
        "swing.toml:6:10: solver.sweeps: ",
        "6999972 bars, 1000000 sweeps and 600 steps are 4.19998e+15 bar updates, over the limit of 1e+13");
    expect_limit(line_of("1000000") + "[solver]\nmethod = \"relaxation\"\nstep = 1e-6\n",
                 "swing.toml:6:8: solver.step: ", "bar updates");
}

/// A long rope, then a short one.
std::string two_ropes_with(const std::string& solver) {
    return line_of("900000") + "[[rope]]\nline = { particles = 3, step = [0, -1] }\n" + solver;
}

TEST(SceneLimits, StepsOfEachBodysSolver) {
    const std::string fine = "[[solver.bodies]]\nropes = [1]\nmethod = \"rattle\"\nstep = 1e-9\n";
    expect_limit(line_of("3") + line_of("3").substr(11) + fine,
                 "swing.toml:9:8: solver.bodies[0].step: ", "10 s are 1e+10 steps");
    // One that moves nothing takes none.
    EXPECT_NO_THROW(std::ignore = parse_scene(
                        line_of("3") +
                            "[solver]\nmethod = \"rattle\"\nstep = 1e-9\n[[solver.bodies]]\nropes = [0]\n"
                            "method = \"exact\"\n",
                        "a"));
}

TEST(SceneLimits, BarUpdatesOfEachBodysSolver) {
    const std::string relaxation = "method = \"relaxation\"\nreach = 1\n";
    const std::string sweeps = "sweeps = 1000000\n";
    const std::string first = "[[solver.bodies]]\nropes = [0]\n" + relaxation;
    const std::string second = "[[solver.bodies]]\nropes = [1]\n" + relaxation;
    // 899999 and 2 bars.
    EXPECT_NO_THROW(std::ignore = parse_scene(two_ropes_with(first + second + sweeps), "a"));
    expect_limit(two_ropes_with(first + sweeps + second), "swing.toml:10:10: solver.bodies[0].sweeps: ",
                 "899999 bars, 1000000 sweeps and 600 steps are 5.39999e+14 bar updates");
    expect_limit(
        two_ropes_with(first + "sweeps = 18500\n" + second + "step = 2e-8\nsweeps = 5000\n"),
        "swing.toml:16:10: solver.bodies[1].sweeps: ",
        "2 bars, 5000 sweeps and 5e+08 steps, with those of other methods, are 1.499e+13 bar updates");
}

TEST(SceneLimits, ReachOfEachBodysSolver) {
    const std::string far = "method = \"relaxation\"\nreach = 30\n";
    expect_limit(two_ropes_with("[[solver.bodies]]\nropes = [0]\n" + far),
                 "swing.toml:2:1: rope[0]: ", "26999535 bars, over the limit of 20000000");
    EXPECT_NO_THROW(std::ignore = parse_scene(two_ropes_with("[[solver.bodies]]\nropes = [1]\n" + far), "a"));
}

TEST(SceneLimits, PointsOfTrails) {
    std::string ropes;
    for (int i = 0; i < 20'000; ++i) ropes += "[[rope]]\nline = { particles = 2, step = [0.1, -1.0] }\n";
    const std::string long_motion = "schema = 1\n[world]\nduration = 20.0\n";
    EXPECT_NO_THROW(std::ignore = parse_scene(long_motion + ropes, "a"));
    expect_limit(
        long_motion + "[style]\ntrail_s = 6.0\n" + ropes, "swing.toml:33338:1: rope[16666]: ",
        "20000400 points in trails, over the limit of 20000000; give style.trail_of fewer particles");
    EXPECT_NO_THROW(std::ignore = parse_scene(long_motion + "[style]\ntrail_s = 20.0\n" + ropes, "a"));
    std::string twice = "0";  // two particles, however often they are named
    for (int i = 0; i < 4000; ++i) twice += ", -1";
    EXPECT_NO_THROW(std::ignore = parse_scene(
                        "schema = 1\n[world]\nduration = 600.0\n[style]\ntrail_s = 0.5\ntrail_of = [" +
                            twice + "]\n[[rope]]\nline = { particles = 2, step = [0.1, -1.0] }\n",
                        "a"));
}

TEST(SceneLimits, FileSize) {
    const std::string large(static_cast<std::size_t>(Limits::kFileBytes) + 1, '\n');
    expect_limit(large, "swing.toml: ", "over the limit of 16777216 bytes");
}

}  // namespace
}  // namespace corda::scene
