// Every way in which a scene can be wrong has a message with the exact place, the value and the remedy.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "corda/core/removed.hpp"
#include "unit/scene/support.hpp"

namespace corda::scene {
namespace {

using testing::StartsWith;

TEST(SceneErrors, WholeMessages) {
    EXPECT_EQ(error_of(rope_with("masss = 1")).message,
              "swing.toml:4:1: rope[0].masss: unknown key \"masss\"; did you mean \"mass\"?");
    EXPECT_EQ(error_of(rope_with("mass = -1")).message,
              "swing.toml:4:8: rope[0].mass: -1 is not >= 1e-12; give the mass of a particle in kg, 1e-12 .. "
              "1e12, or a list with one per particle");
}

TEST(SceneErrors, Schema) {
    expect_errors({
        {"", "swing.toml:1:1: schema: ", "missing; give schema = 1"},
        {"[[rope]]\nfoo = 1\n", "swing.toml:1:1: schema: ", "missing"},
        {"# later\nschema = 2\nnews = 1\n", "swing.toml:2:10: schema: ", "2 is not a known version"},
        {"schema = \"1\"\n[[rope]]\nline = { particles = 2, step = [1, 0] }\n",
         "swing.toml:1:10: schema: ", "\"1\" is a string, not an integer; give schema = 1"},
    });
}

TEST(SceneErrors, UnknownKeys) {
    expect_errors({
        {with("vidio = 1"), "swing.toml:3:1: vidio: ", "unknown key \"vidio\"; did you mean \"video\"?"},
        {with("[world]\n  gravty = 1"), "swing.toml:4:3: world.gravty: ", "did you mean \"gravity\"?"},
        {with("[solver]\nsweps = 1"), "swing.toml:4:1: solver.sweps: ", "did you mean \"sweeps\"?"},
        {with("[video]\nfbs = 1"), "swing.toml:4:1: video.fbs: ", "did you mean \"fps\"?"},
        {with("[style]\nbackgruond = 1"),
         "swing.toml:4:1: style.backgruond: ", "did you mean \"background\"?"},
        {with("[camera]\nfoo = 1"), "swing.toml:4:1: camera.foo: ", "valid keys: center, height, margin"},
        {with("fps = 1"), "swing.toml:3:1: fps: ", "it is a key of video"},
        {"schema = 1\n[[rope]]\nline = { particle = 3, step = [1, 0] }",
         "swing.toml:3:10: rope[0].line.particle: ", "did you mean \"particles\"?"},
        {"schema = 1\n[[rope]]\nhang = { links = 3, length = 1, angel_deg = 3 }",
         "swing.toml:3:33: rope[0].hang.angel_deg: ", "did you mean \"angle_deg\"?"},
        {with("[world]\nzz = 1\naa = 2"),
         "swing.toml:4:1: world.zz: ", "valid keys"},  // the first in the file
        {with("\"a\\u0001b\" = 1"), "swing.toml:3:1: a\\x01b: ", "unknown key"},
    });
}

TEST(SceneErrors, RemovedKeysNameWhatReplacesThem) {
    for (const auto& [name, replacement] : all_removed()) {
        if (name.find('.') == std::string_view::npos) continue;  // a command or an option
        const std::string message = error_of(with(fmt::format("{} = 1", name))).message;
        EXPECT_TRUE(message.starts_with("swing.toml:3:")) << message;
        EXPECT_THAT(message, testing::HasSubstr(fmt::format(": {}: was removed; {}", name, replacement)));
    }
}

TEST(SceneErrors, Syntax) {
    expect_errors({
        {"schema = \n", "swing.toml:1:10: ", "expected value"},
        {"schema = 1\nschema = 2\n", "swing.toml:2:", "cannot redefine"},
        {"a = [1,\n", "swing.toml:", "end-of-file"},
        {"schema = 1\nx = \"\xff\"\n", "swing.toml:", "utf-8"},
        {std::string("schema\0= 1\n", 11), "swing.toml:1:", ""},
        {"schema = " + std::string(100'000, '['), "swing.toml:1:", "nest"},
    });
}

TEST(SceneErrors, DeepDottedKeysAreRefusedBeforeTheParserRecurses) {
    std::string parts = "a";
    for (int i = 0; i < 1'000'000; ++i) parts.append(".a");
    expect_errors({
        {std::string("schema = 1 # a.b\n  ").append(parts).append(" = 1\n"),
         "swing.toml:2:66: ", "a key of more than 32 parts"},
        {std::string("[").append(parts).append("]\n"), "swing.toml:1:65: ", "a key of more than 32 parts"},
    });
    const std::string dots(100, '.');
    EXPECT_EQ(error_of("# " + dots + "\n" + rope_with("color = \"" + dots + "\"")).message,
              "swing.toml:5:9: rope[0].color: \"" + dots.substr(0, 60) +
                  "...\" is not a colour; give a colour such as \"tomato\", \"#e8c07d\", \"#e8c07d80\" (with "
                  "alpha) or \"transparent\"");
}

TEST(SceneErrors, Types) {
    expect_errors({
        {rope_with("mass = \"heavy\""), "swing.toml:4:8: rope[0].mass: ",
         "\"heavy\" is a string, not a number; give the mass of a particle"},
        {rope_with("payload = true"),
         "swing.toml:4:11: rope[0].payload: ", "true is a boolean, not a number"},
        {rope_with("payload = 2020-01-01"),
         "swing.toml:4:11: rope[0].payload: ", "a date or a time, not a number"},
        {rope_with("payload = nan"), "swing.toml:4:11: rope[0].payload: ", "nan is not a finite number"},
        {rope_with("payload = -inf"), "swing.toml:4:11: rope[0].payload: ", "-inf is not a finite number"},
        {rope_with("pinned = 0"), "swing.toml:4:10: rope[0].pinned: ", "0 is an integer, not a list"},
        {rope_with("pinned = [0.5]"),
         "swing.toml:4:11: rope[0].pinned[0]: ", "0.5 is a number with a fraction, not an integer"},
        {rope_with("color = 3"), "swing.toml:4:9: rope[0].color: ", "3 is an integer, not text"},
        {with("world = 3"), "swing.toml:3:9: world: ", "3 is an integer, not a table; write [world]"},
        {"schema = 1\n", "swing.toml:1:1: rope: ", "missing; give one or more [[rope]]"},
        {"schema = 1\nrope = []\n", "swing.toml:2:8: rope: ", "the list is empty"},
        {"schema = 1\nrope = [1]\n", "swing.toml:2:9: rope[0]: ", "1 is an integer, not a table"},
        {"schema = 1\n[rope]\nmass = 1\n", "swing.toml:2:1: rope: ", "this is a table, not a list"},
    });
}

TEST(SceneErrors, World) {
    expect_errors({
        {with("[world]\nduration = 0"),
         "swing.toml:4:12: world.duration: ", "0 is not > 0; give the duration in s, > 0"},
        {with("[world]\nduration = inf"), "swing.toml:4:12: world.duration: ", "inf is not a finite number"},
        {with("[world]\ndrag = -0.5"),
         "swing.toml:4:8: world.drag: ", "-0.5 is not >= 0; give the drag in 1/s, >= 0"},
        {with("[world]\ngravity = [1]"), "swing.toml:4:11: world.gravity: ", "a list of 1, not [gx, gy]"},
        {with("[world]\ngravity = [1, nan]"), "swing.toml:4:15: world.gravity[1]: ", "nan is not a finite"},
        {with("[world]\ngravity = \"down\""), "swing.toml:4:11: world.gravity: ", "or [gx, gy]"},
    });
}

TEST(SceneErrors, Shapes) {
    const std::string rope = "schema = 1\n[[rope]]\n";
    expect_errors({
        {rope, "swing.toml:2:1: rope[0]: ", "no shape; give one of: line, hang, points"},
        {rope_with("points = [[0, 0], [1, 1]]"),
         "swing.toml:2:1: rope[0]: ", "2 shapes (line, points); keep one"},
        {rope + "line = { particles = 3 }", "swing.toml:3:8: rope[0].line.step: ", "as [dx, dy]"},
        {rope + "line = { step = [0, 1] }", "swing.toml:3:8: rope[0].line.particles: ", "missing"},
        {rope + "line = { particles = 1, step = [0, 1] }",
         "swing.toml:3:22: rope[0].line.particles: ", "1 is not >= 2"},
        {rope + "line = { particles = 2.5, step = [0, 1] }",
         "swing.toml:3:22: rope[0].line.particles: ", "2.5 is a number with a fraction, not an integer"},
        {rope + "line = { particles = 2, step = [0, 0] }",
         "swing.toml:3:32: rope[0].line.step: ", "is no distance"},
        {rope + "line = { particles = 2, step = [0, 1], from = [2e9, 0] }",
         "swing.toml:3:48: rope[0].line.from[0]: ", "2000000000 is not <= 1e9"},
        {rope + "line = { particles = 20, step = [0, -1e8] }",
         "swing.toml:3:8: rope[0].line: ", "beyond the limit of 1e+09 m"},
        {rope + "line = [1, 2]", "swing.toml:3:8: rope[0].line: ", "a list of 2, not a table; give line = {"},
        {rope + "hang = { links = 0, length = 1 }", "swing.toml:3:18: rope[0].hang.links: ", "0 is not >= 1"},
        {rope + "hang = { links = 2 }",
         "swing.toml:3:8: rope[0].hang.length: ", "missing; give the length of the whole rope in m, > 0"},
        {rope + "hang = { links = 2, length = 0 }", "swing.toml:3:30: rope[0].hang.length: ", "0 is not > 0"},
        {rope + "hang = { links = 2, length = 1e-13 }",
         "swing.toml:3:30: rope[0].hang.length: ", "1e-13 m are less than 1e-12 m per link"},
        {rope + "hang = { links = 2, length = 2e9 }", "swing.toml:3:8: rope[0].hang: ", "beyond the limit"},
        {rope + "hang = { links = 2, length = 1, angle_deg = inf }",
         "swing.toml:3:45: rope[0].hang.angle_deg: ", "inf is not a finite number"},
        {rope + "points = [[0, 0]]",
         "swing.toml:3:10: rope[0].points: ", "this is a list of 1; give the positions of the particles"},
        {rope + "points = [[0, 0], [1]]",
         "swing.toml:3:19: rope[0].points[1]: ", "this is a list of 1, not ["},
        {rope + "points = [[0, 0], 3]",
         "swing.toml:3:19: rope[0].points[1]: ", "3 is an integer, not [x, y]"},
        {rope + "points = [[0, 0], [1, 1], [1, 1]]",
         "swing.toml:3:27: rope[0].points[2]: ", "points 1 and 2 coincide"},
        {rope + "points = [[0, 0], [1, 1], [0, 0]]\n[solver]\nmethod = \"relaxation\"",
         "swing.toml:3:27: rope[0].points[2]: ",
         "points 0 and 2 coincide, and the solver's reach = 7 ties them by a bar, which has no direction; "
         "move one, or give a reach below 2"},
        {rope + "points = [[0, 0], [1, -1e10]]",
         "swing.toml:3:23: rope[0].points[1][1]: ", "-10000000000 is not >= -1e9"},
    });
}

TEST(SceneErrors, Particles) {
    expect_errors({
        {rope_with("mass = 0"), "swing.toml:4:8: rope[0].mass: ", "0 is not >= 1e-12"},
        {rope_with("mass = [1, 2]"), "swing.toml:4:8: rope[0].mass: ", "2 values for 3 particles"},
        {rope_with("mass = [1, 2, 0]"), "swing.toml:4:15: rope[0].mass[2]: ", "0 is not >= 1e-12"},
        {rope_with("mass = 1e-13"), "swing.toml:4:8: rope[0].mass: ", "1e-13 is not >= 1e-12"},
        {rope_with("mass = 1e13"), "swing.toml:4:8: rope[0].mass: ", "is not <= 1e12"},
        {rope_with("payload = -1"), "swing.toml:4:11: rope[0].payload: ",
         "-1 is not >= 0; give the mass added to the last particle in kg, 0 .. 1e12"},
        {rope_with("velocity = 3"), "swing.toml:4:12: rope[0].velocity: ", "3 is an integer, not a list"},
        {rope_with("velocity = []"), "swing.toml:4:12: rope[0].velocity: ", "a list of 0, not [vx, vy]"},
        {rope_with("velocity = [1, 2, 3]"),
         "swing.toml:4:12: rope[0].velocity: ", "this is a list of 3, not ["},
        {rope_with("velocity = [[1, 2], [3, 4]]"),
         "swing.toml:4:12: rope[0].velocity: ", "2 values for 3 particles"},
        {rope_with("velocity = [[1, 2], 3, 4]"), "swing.toml:4:21: rope[0].velocity[1]: ", ", not ["},
        {rope_with("pinned = [3]"), "swing.toml:4:11: rope[0].pinned[0]: ",
         "3 is out of range; the rope has particles 0 .. 2, or -1 .. -3 from the end"},
        {rope_with("pinned = [-4]"), "swing.toml:4:11: rope[0].pinned[0]: ", "-4 is out of range"},
        {rope_with("pinned = [2, 0, -1]"),
         "swing.toml:4:17: rope[0].pinned[2]: ", "particle 2 is given twice"},
        {rope_with("color = \"redd\""),
         "swing.toml:4:9: rope[0].color: ", "\"redd\" is not a colour; did you mean \"red\"?"},
        {rope_with("width_px = 0"), "swing.toml:4:12: rope[0].width_px: ", "0 is not >= 0.1"},
    });
}

TEST(SceneErrors, ClosedRopes) {
    expect_errors({
        {square_with("closed = 1"),
         "swing.toml:4:10: rope[0].closed: ", "1 is an integer, not true or false; give true or false"},
        {rope_with("closed = true"), "swing.toml:4:10: rope[0].closed: ",
         "the closing link of a straight rope would lie on its others; give points, or remove it"},
        {"schema = 1\n[[rope]]\nhang = { links = 3, length = 1 }\nclosed = true",
         "swing.toml:4:10: rope[0].closed: ", "give points"},
        {"schema = 1\n[[rope]]\npoints = [[0, 0], [1, 0]]\nclosed = true",
         "swing.toml:4:10: rope[0].closed: ", "2 points close to no ring; give at least 3"},
        {"schema = 1\n[[rope]]\npoints = [[0, 0], [1, 0], [1, 1], [0, 0]]\nclosed = true",
         "swing.toml:3:35: rope[0].points[3]: ",
         "points 0 and 3 coincide; leave this one out, because closed = true ties the last point to the "
         "first"},
        {"schema = 1\n[[rope]]\npoints = [[0, 0], [1, 0], [2, 0], [2, 1], [0, 0], [-1, 1]]\nclosed = "
         "true\n[solver]\nmethod = \"relaxation\"",
         "swing.toml:3:43: rope[0].points[4]: ",
         "points 0 and 4 coincide, and the solver's reach = 7 ties them by a bar, which has no direction; "
         "move one, or give a reach below 2"},
    });
}

TEST(SceneErrors, Materials) {
    expect_errors({
        {rope_with("compliance = -1"), "swing.toml:4:14: rope[0].compliance: ", "-1 is not >= 0"},
        {rope_with("compliance = 2e6"), "swing.toml:4:14: rope[0].compliance: ", "is not <= 1e6; give"},
        {rope_with("compliance = true"),
         "swing.toml:4:14: rope[0].compliance: ", "true is a boolean, not a number"},
        {rope_with("string = \"yes\""),
         "swing.toml:4:10: rope[0].string: ", "\"yes\" is a string, not true or false"},
        {rope_with("bending = -1"), "swing.toml:4:11: rope[0].bending: ", "-1 is not >= 0"},
        {rope_with("bending = 1e13"),
         "swing.toml:4:11: rope[0].bending: ", "give the bending stiffness E I in N m2, 0 .. 1e12"},
        {rope_with("string = true\nbending = 1"), "swing.toml:5:11: rope[0].bending: ",
         "a string hangs slack, and so has no bending stiffness; remove bending or string"},
        {square_with("closed = true\nstring = true"), "swing.toml:5:10: rope[0].string: ",
         "a closed rope can only hang slack if it stretches; give a compliance, or remove string"},
        {rope_with("strng = true"), "swing.toml:4:1: rope[0].strng: ", "did you mean \"string\"?"},
    });
}

TEST(SceneErrors, LinkLengths) {
    expect_errors({
        {rope_with("link_length = 2"), "swing.toml:4:15: rope[0].link_length: ",
         "links that neither stretch nor hang slack are as long as their particles are apart at the start; "
         "give compliance or string = true, or remove it"},
        {rope_with("string = true\npinned = [0, -1]\nlink_length = 0.5"),
         "swing.toml:6:15: rope[0].link_length: ",
         "0.5 m are less than the 1 m between particles 0 and 1, which lie between pins"},
        {rope_with("string = true\npinned = [0, -1]\nlink_length = [2, 0.5]"),
         "swing.toml:6:19: rope[0].link_length[1]: ", "between particles 1 and 2"},
        {rope_with("string = true\nlink_length = [2]"),
         "swing.toml:5:15: rope[0].link_length: ", "1 values for 2 links"},
        {square_with("closed = true\ncompliance = 1\nlink_length = [1, 1, 1]"),
         "swing.toml:6:15: rope[0].link_length: ", "3 values for 4 links"},
        {rope_with("compliance = 1\nlink_length = 0"), "swing.toml:5:15: rope[0].link_length: ",
         "0 is not >= 1e-12; give the length of a link at rest in m, 1e-12 .. 4e9"},
        {rope_with("compliance = 1\nlink_length = [1, \"2\"]"),
         "swing.toml:5:19: rope[0].link_length[1]: ", "\"2\" is a string, not a number"},
    });
}

TEST(SceneErrors, Nets) {
    const std::string net = "schema = 1\n[[net]]\n";
    expect_errors({
        {"schema = 1\nnet = []\n", "swing.toml:2:7: net: ", "the list is empty; give one or more [[net]]"},
        {"schema = 1\nnet = [1]\n", "swing.toml:2:8: net[0]: ", "1 is an integer, not a table"},
        {"schema = 1\n[net]\nmass = 1\n", "swing.toml:2:1: net: ", "this is a table, not a list"},
        {with("nets = 1"), "swing.toml:3:1: nets: ", "did you mean \"net\"?"},
        {net, "swing.toml:2:1: net[0]: ", "the net has no shape; give grid, or points and bars"},
        {grid_with("points = [[0, 0], [1, 1]]"),
         "swing.toml:2:1: net[0]: ", "2 shapes (grid, points); keep one of them"},
        {grid_with("payload = 1"),
         "swing.toml:4:1: net[0].payload: ", "unknown key \"payload\"; it is a key of rope"},
        {rope_with("grid = 1"), "swing.toml:4:1: rope[0].grid: ", "it is a key of net"},
        {grid_with("mass = [1, 2]"), "swing.toml:4:8: net[0].mass: ", "2 values for 6 particles"},
        {grid_with("velocity = [[1, 2]]"), "swing.toml:4:12: net[0].velocity: ", "1 values for 6 particles"},
        {grid_with("string = true"), "swing.toml:4:10: net[0].string: ",
         "a net can only hang slack if it stretches; give a compliance, or remove string"},
        {grid_with("compliance = -1"), "swing.toml:4:14: net[0].compliance: ", "-1 is not >= 0"},
        {grid_with("width_px = 0"), "swing.toml:4:12: net[0].width_px: ", "0 is not >= 0.1"},
    });
}

TEST(SceneErrors, Grids) {
    const auto grid = [](const std::string& keys) {
        return "schema = 1\n[[net]]\ngrid = { " + keys + " }\n";
    };
    expect_errors({
        {"schema = 1\n[[net]]\ngrid = 3",
         "swing.toml:3:8: net[0].grid: ", "3 is an integer, not a table; give grid = { columns"},
        {grid("rows = 2, spacing = 1"), "swing.toml:3:8: net[0].grid.columns: ", "missing; give the number"},
        {grid("columns = 2, spacing = 1"), "swing.toml:3:8: net[0].grid.rows: ", "missing; give the number"},
        {grid("columns = 2, rows = 2"), "swing.toml:3:8: net[0].grid.spacing: ",
         "missing; give the distance from one particle to the next in m, 1e-12 .. 1e9, or [dx, dy]"},
        {grid("columns = 0, rows = 2, spacing = 1"),
         "swing.toml:3:20: net[0].grid.columns: ", "0 is not >= 1"},
        {grid("columns = 2, rows = 1.5, spacing = 1"),
         "swing.toml:3:30: net[0].grid.rows: ", "1.5 is a number with a fraction, not an integer"},
        {grid("columns = 1, rows = 1, spacing = 1"),
         "swing.toml:3:8: net[0].grid: ", "1 particle is no net; give more columns or rows"},
        {grid("columns = 2, rows = 2, spacing = 0"),
         "swing.toml:3:43: net[0].grid.spacing: ", "0 is not >= 1e-12; give the distance"},
        {grid("columns = 2, rows = 2, spacing = [1, -1]"),
         "swing.toml:3:47: net[0].grid.spacing[1]: ", "-1 is not >= 1e-12"},
        {grid("columns = 2, rows = 2, spacing = [1]"),
         "swing.toml:3:43: net[0].grid.spacing: ", "this is a list of 1, not ["},
        {grid("columns = 2, rows = 2, spacing = 1, diagonals = 1"),
         "swing.toml:3:58: net[0].grid.diagonals: ", "1 is an integer, not true or false"},
        {grid("columns = 2, rows = 2, spacing = 1, from = [0, 2e9]"),
         "swing.toml:3:57: net[0].grid.from[1]: ", "2000000000 is not <= 1e9"},
        {grid("columns = 3, rows = 2, spacing = 6e8"),
         "swing.toml:3:8: net[0].grid: ", "beyond the limit of 1e+09 m; make the grid smaller"},
        {grid("column = 3, rows = 2, spacing = 1"),
         "swing.toml:3:10: net[0].grid.column: ", "did you mean \"columns\"?"},
        {grid_with("bars = [[0, 1]]"), "swing.toml:4:8: net[0].bars: ",
         "a grid has bars of its own; remove them, or give points in place of the grid"},
        {grid_with("pinned = [6]"), "swing.toml:4:11: net[0].pinned[0]: ",
         "6 is out of range; the net has particles 0 .. 5, or -1 .. -6 from the end"},
        {grid_with("pinned = [[3, 0]]"), "swing.toml:4:12: net[0].pinned[0][0]: ",
         "3 is out of range; the grid has columns 0 .. 2, or -1 .. -3 from the end"},
        {grid_with("pinned = [[0, -3]]"), "swing.toml:4:15: net[0].pinned[0][1]: ",
         "-3 is out of range; the grid has rows 0 .. 1, or -1 .. -2 from the end"},
        {grid_with("pinned = [[1]]"),
         "swing.toml:4:11: net[0].pinned[0]: ", "a list of 1, not [column, row]"},
        {grid_with("pinned = [[2, 0], [-1, 0]]"),
         "swing.toml:4:19: net[0].pinned[1]: ", "particle 2 is given twice; remove one"},
        {grid_with("pinned = 3"), "swing.toml:4:10: net[0].pinned: ", "3 is an integer, not a list"},
    });
}

TEST(SceneErrors, Graphs) {
    const std::string net = "schema = 1\n[[net]]\n";
    expect_errors({
        {net + "points = [[0, 0], [1, 0]]", "swing.toml:2:1: net[0].bars: ",
         "missing; give the particles that each bar joins, as a list of [a, b]"},
        {net + "points = [[0, 0]]\nbars = [[0, 1]]",
         "swing.toml:3:10: net[0].points: ", "this is a list of 1; give the positions of the particles"},
        {graph_with("[]"),
         "swing.toml:4:8: net[0].bars: ", "the list is empty; give the particles that each bar joins"},
        {graph_with("[[0, 1, 2]]"), "swing.toml:4:9: net[0].bars[0]: ", "a list of 3, not [a, b]"},
        {graph_with("[1]"), "swing.toml:4:9: net[0].bars[0]: ", "1 is an integer, not [a, b]"},
        {graph_with("[[0, 0.5]]"), "swing.toml:4:13: net[0].bars[0][1]: ", "not an integer"},
        {graph_with("[[0, 1], [1, 4]]"), "swing.toml:4:21: net[0].bars[1][1]: ",
         "4 is out of range; the net has particles 0 .. 3, or -1 .. -4 from the end"},
        {graph_with("[[0, 1], [3, -1]]"),
         "swing.toml:4:17: net[0].bars[1]: ", "a bar from particle 3 to itself; join two different ones"},
        {graph_with("[[0, 1], [1, 2], [0, 1]]"),
         "swing.toml:4:25: net[0].bars[2]: ", "particles 0 and 1 are joined already, by bars[0]; remove one"},
        {graph_with("[[2, 1], [0, 3], [1, 2]]"),
         "swing.toml:4:25: net[0].bars[2]: ", "particles 1 and 2 are joined already, by bars[0]"},
        {net + "points = [[0, 0], [1, 0], [0, 0]]\nbars = [[0, 1], [0, 2]]",
         "swing.toml:4:17: net[0].bars[1]: ", "particles 0 and 2 coincide"},
        {graph_with("[[0, 1]]", "pinned = [[0, 0]]"), "swing.toml:5:11: net[0].pinned[0]: ",
         "only a grid has columns and rows; give the index of a particle"},
        {graph_with("[[0, 1]]", "pinned = [4]"), "swing.toml:5:11: net[0].pinned[0]: ", "4 is out of range"},
    });
}

TEST(SceneErrors, Solver) {
    const auto solver = [](const std::string& keys) { return with("[solver]\n" + keys); };
    const auto method = [&](const std::string& name, const std::string& keys) {
        return solver("method = \"" + name + "\"\n" + keys);
    };
    expect_errors({
        {solver("method = \"relaxatoin\""),
         "swing.toml:4:10: solver.method: ", "\"relaxatoin\" is unknown; did you mean \"relaxation\"?"},
        {solver("method = \"magic\""), "swing.toml:4:10: solver.method: ",
         "\"magic\" is unknown; give one of: auto, exact, rattle, relaxation"},
        {method("rattle", "step = 0"),
         "swing.toml:5:8: solver.step: ", "0 is not >= 1e-9; give the step in s, >= 1e-9"},
        {method("relaxation", "reach = 0"), "swing.toml:5:9: solver.reach: ", "0 is not >= 1"},
        {method("relaxation", "sweeps = 1000001"),
         "swing.toml:5:10: solver.sweeps: ", "1000001 is not <= 1e6"},
        {method("relaxation", "delta = 1"), "swing.toml:5:9: solver.delta: ", "1 is not < 1"},
        {method("relaxation", "delta = -0.1"), "swing.toml:5:9: solver.delta: ", "-0.1 is not >= 0"},
        {method("relaxation", "force = 3"),
         "swing.toml:5:9: solver.force: ", "3 is an integer, not [fx, fy]"},
        {solver("tolerance_px = 0"), "swing.toml:4:16: solver.tolerance_px: ", "0 is not > 0"},
        {method("exact", "tolerance = 0.02"), "swing.toml:5:13: solver.tolerance: ", "0.02 is not <= 0.01"},
        {method("rattle", "order = 3"),
         "swing.toml:5:9: solver.order: ", "3 is not allowed; give one of: 2, 4, 6, 8"},
        {method("rattle", "order = 10"), "swing.toml:5:9: solver.order: ", "10 is not allowed"},
    });
}

TEST(SceneErrors, KeysOfOtherMethods) {
    const auto solver = [](const std::string& keys) { return with("[solver]\n" + keys); };
    const auto method = [&](const std::string& name, const std::string& keys) {
        return solver("method = \"" + name + "\"\n" + keys);
    };
    expect_errors({
        {method("relaxation", "tolerance_px = 0.1"), "swing.toml:5:16: solver.tolerance_px: ",
         "method \"relaxation\" does not use it, only auto; remove it"},
        {solver("tolerance = 1e-9"), "swing.toml:4:13: solver.tolerance: ", "only exact; remove it"},
        {method("exact", "order = 4"), "swing.toml:5:9: solver.order: ", "only rattle; remove it"},
        {method("exact", "step = 0.01"),
         "swing.toml:5:8: solver.step: ", "only rattle, relaxation; remove it"},
        {method("rattle", "reach = 7"),
         "swing.toml:5:9: solver.reach: ", "a rigid rod, and its equations singular"},
        {method("exact", "reach = 7"),
         "swing.toml:5:9: solver.reach: ", "a rigid rod, and its equations singular"},
        {method("rattle", "delta = 0.1"), "swing.toml:5:9: solver.delta: ", "give world.drag"},
        {method("exact", "force = [0, 1]"), "swing.toml:5:9: solver.force: ", "give world.gravity"},
    });
}

TEST(SceneErrors, Video) {
    const auto video = [](const std::string& keys) { return with("[video]\n" + keys); };
    expect_errors({
        {video("size = 100"), "swing.toml:4:8: video.size: ",
         "not [width, height]; give the size of the picture in px, 1 .. 16384"},
        {video("size = [1, 2, 3]"), "swing.toml:4:8: video.size: ", "this is a list of 3, not ["},
        {video("size = [0, 2]"), "swing.toml:4:9: video.size[0]: ", "0 is not >= 1"},
        {video("size = [2, 2.5]"), "swing.toml:4:12: video.size[1]: ", "not an integer"},
        {video("fps = 0"),
         "swing.toml:4:7: video.fps: ", "0 is out of range; give the frames per second, 0.001 .. 100000"},
        {video("fps = 100001"), "swing.toml:4:7: video.fps: ", "100001 is out of range"},
        {video("fps = 23.976"), "swing.toml:4:7: video.fps: ", "\"24000/1001\""},
        {video("fps = 29.97"), "swing.toml:4:7: video.fps: ", "29.97 is not exact; write \"30000/1001\""},
        {video("fps = \"29.97\""), "swing.toml:4:7: video.fps: ", "29.97 is not exact; write \"30000/1001\""},
        {video("fps = 16.667"), "swing.toml:4:7: video.fps: ", "16.667 is not exact; write \"50/3\""},
        {video("fps = -12.5"), "swing.toml:4:7: video.fps: ", "is out of range"},
        {video("fps = 3.14159265"),
         "swing.toml:4:7: video.fps: ", "is not exact; give the frames per second"},
        {video("fps = \"30/0\""), "swing.toml:4:7: video.fps: ", "\"30/0\" is not a fraction"},
        {video("fps = \"0/5\""), "swing.toml:4:7: video.fps: ", "is out of range"},
        {video("fps = \"1/1001\""), "swing.toml:4:7: video.fps: ", "is out of range"},
        {video("fps = \"-30\""), "swing.toml:4:7: video.fps: ", "\"-30\" is not a fraction"},
        {video("crf = 0"), "swing.toml:4:7: video.crf: ",
         "0 is not >= 1; give the constant rate factor (H.264, H.265: up to 51), 1 .. 63"},
        {video("crf = 64"), "swing.toml:4:7: video.crf: ", "64 is not <= 63"},
        {video("crf = -1"), "swing.toml:4:7: video.crf: ", "-1 is not >= 1"},
        {video("preset = \"slwo\""), "swing.toml:4:10: video.preset: ", "did you mean \"slow\"?"},
        {video("preset = \"unknown word\""), "swing.toml:4:10: video.preset: ", "ultrafast, superfast"},
        {video("codec = \"libx266\""), "swing.toml:4:9: video.codec: ", "did you mean \"libx264\"?"},
        {video("pix = \"422\""), "swing.toml:4:7: video.pix: ", "did you mean \"420\"?"},
        {video("threads = 65"), "swing.toml:4:11: video.threads: ", "65 is not <= 64"},
        {video("threads = 0"), "swing.toml:4:11: video.threads: ", "0 is not >= 1"},
        {video("shutter = 1.5"), "swing.toml:4:11: video.shutter: ", "1.5 is not <= 1"},
        {video("shutter = -0.1"), "swing.toml:4:11: video.shutter: ", "-0.1 is not >= 0"},
        {video("subframes = 1"), "swing.toml:4:13: video.subframes: ", "1 is not >= 2"},
        {video("subframes = 65"), "swing.toml:4:13: video.subframes: ", "65 is not <= 64"},
    });
}

TEST(SceneErrors, Overlay) {
    const auto overlay = [](const std::string& keys) { return with("[overlay]\n" + keys); };
    expect_errors({
        {overlay("time = 1"), "swing.toml:4:8: overlay.time: ", "give true or false"},
        {overlay("tittle = \"a\""), "swing.toml:4:1: overlay.tittle: ", "did you mean \"title\"?"},
        {overlay("title = 3"),
         "swing.toml:4:9: overlay.title: ", "give the title, at the upper left as one line"},
        {overlay("title = \"a\\nb\""), "swing.toml:4:9: overlay.title: ", "has a control character"},
        {overlay("title = \"a\\u202eb\""), "swing.toml:4:9: overlay.title: ", "has a control character"},
        {overlay("title = \"yarn \\U0001f9f6\""), "swing.toml:4:9: overlay.title: ",
         "U+1F9F6 is an emoji, whose coloured fonts are not drawn; leave that character out"},
    });
}

TEST(SceneErrors, StyleAndCamera) {
    const auto style = [](const std::string& keys) { return with("[style]\n" + keys); };
    const auto camera = [](const std::string& keys) { return with("[camera]\n" + keys); };
    expect_errors({
        {style("background = \"clear\""),
         "swing.toml:4:14: style.background: ", "\"clear\" is not a colour; give a colour such as"},
        {style("background = [\"#000000\"]"), "swing.toml:4:14: style.background: ", "[top, bottom]"},
        {style("background = [\"#000000\", \"#0000\"]"),
         "swing.toml:4:26: style.background[1]: ", "is not a colour"},
        {style("theme = \"light\""), "swing.toml:4:9: style.theme: ", "give one of: dark, paper"},
        {style("palette = []"), "swing.toml:4:11: style.palette: ", "the list is empty"},
        {style("palette = [\"#000000\", \"bleu\"]"),
         "swing.toml:4:23: style.palette[1]: ", "did you mean \"blue\"?"},
        {style("rope_width_px = 1001"), "swing.toml:4:17: style.rope_width_px: ", "1001 is not <= 1000"},
        {style("markers = \"al\""), "swing.toml:4:11: style.markers: ", "did you mean \"all\"?"},
        {style("bars = \"imaginary\""), "swing.toml:4:8: style.bars: ", "give one of: none, real, all"},
        {style("marker_radius_px = 0"), "swing.toml:4:20: style.marker_radius_px: ", "0 is not >= 0.1"},
        {camera("center = 3"), "swing.toml:4:10: camera.center: ", ", not ["},
        {camera("height = 0"), "swing.toml:4:10: camera.height: ",
         "0 is not >= 1e-9; give the height of the picture in m, 1e-9 .. 4e9"},
        {camera("margin = 0.46"), "swing.toml:4:10: camera.margin: ", "0.46 is not <= 0.45"},
    });
}

TEST(SceneErrors, ColoursOfLinks) {
    const std::string relaxes = "[solver]\nmethod = \"relaxation\"\n";
    expect_errors({
        {with("[style]\ncolor_by = \"tensoin\""),
         "swing.toml:4:12: style.color_by: ", "\"tensoin\" is unknown; did you mean \"tension\"?"},
        {with("[style]\ncolor_by = 3"), "swing.toml:4:12: style.color_by: ", "3 is an integer, not text"},
        {with(relaxes + "[style]\narrows = \"tension\""),
         "swing.toml:6:10: style.arrows: ", "knows no tensions; give \"velocity\" or \"weight\", or another"},
        {with(relaxes + "[style]\ncolor_by = \"tension\""),
         "swing.toml:6:12: style.color_by: ", "knows no tensions; give \"speed\" or \"strain\", or another"},
        {rope_with("color = [\"red\", \"blue\"]"),
         "swing.toml:4:9: rope[0].color: ", "set style.color_by = \"link\", or give one colour"},
        {rope_with("color = [\"red\", 3]"),
         "swing.toml:4:17: rope[0].color[1]: ", "3 is an integer, not text"},
        {rope_with("color = [\"red\", \"bleu\"]"),
         "swing.toml:4:17: rope[0].color[1]: ", "did you mean \"blue\""},
        {rope_with("color = [\"red\", \"#00ff0080\"]\n[style]\ncolor_by = \"link\""),
         "swing.toml:4:17: rope[0].color[1]: ", "another alpha than that of the first link"},
        {rope_with("color = []"), "swing.toml:4:9: rope[0].color: ", "the list is empty"},
    });
    EXPECT_THAT(error_of(rope_with("color = [\"red\"]\n[style]\ncolor_by = \"lnik\"")).message,
                testing::AllOf(testing::HasSubstr("did you mean \"link\""),
                               testing::Not(testing::HasSubstr("rope[0].color"))));
    EXPECT_NO_THROW(std::ignore = parse_scene(with(relaxes + "[style]\ncolor_by = \"speed\""), "a"));
}

TEST(SceneErrors, LongTitles) {
    const std::string title(1001, 'x');
    expect_errors({{with("[overlay]\ntitle = \"" + title + "\""),
                    "swing.toml:4:9: overlay.title: ", "a text of 1001 bytes, over the limit of 1000"}});
    EXPECT_NO_THROW(std::ignore = parse_scene(with("[overlay]\ntitle = \"" + title.substr(1) + "\""), "a"));
}

}  // namespace
}  // namespace corda::scene
