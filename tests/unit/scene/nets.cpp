// Nets: grids, graphs of points, and what belongs to each particle.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "corda/film/film.hpp"
#include "corda/film/plan_text.hpp"
#include "unit/scene/support.hpp"

namespace corda::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

NetDef net_of(const std::string& keys, const std::vector<Setting>& settings = {}) {
    return parse_scene("schema = 1\n[[net]]\n" + keys, "cloth.toml", settings).nets.at(0);
}

NetDef grid(const std::string& keys, const std::string& more = "") {
    return net_of("grid = { " + keys + " }\n" + more);
}

/// Three points and two bars.
NetDef graph(const std::string& more) {
    return net_of("points = [[5, 7], [6, 7], [6, 5]]\nbars = [[0, 1], [1, 2]]\n" + more);
}

std::vector<std::pair<unsigned, unsigned>> bars_of(const NetDef& net, bool real) {
    std::vector<std::pair<unsigned, unsigned>> bars;
    for (const NetBar& bar : net.bars) {
        if (bar.is_real == real) bars.emplace_back(bar.a, bar.b);
    }
    return bars;
}

TEST(SceneGrid, NumbersItsParticlesRowByRowFromTheUpperLeft) {
    const auto net = grid("columns = 3, rows = 2, from = [10, 20], spacing = [0.5, 0.25]");
    EXPECT_EQ(net.origin_m, (Vec2{10, 20}));
    EXPECT_THAT(net.points_m, ElementsAre(Vec2{0, 0}, Vec2{0.5, 0}, Vec2{1, 0}, Vec2{0, -0.25},
                                          Vec2{0.5, -0.25}, Vec2{1, -0.25}));
    EXPECT_FALSE(std::signbit(net.points_m[0].y));
}

TEST(SceneGrid, OneSpacingIsThatOfBothDirections) {
    const auto net = grid("columns = 2, rows = 2, spacing = 0.5");
    EXPECT_EQ(net.origin_m, Vec2{});
    EXPECT_THAT(net.points_m, ElementsAre(Vec2{0, 0}, Vec2{0.5, 0}, Vec2{0, -0.5}, Vec2{0.5, -0.5}));
}

TEST(SceneGrid, OrdersBarsAlongTheRowsThenTheColumnsThenTheDiagonals) {
    const auto net = grid("columns = 3, rows = 2, spacing = 1, diagonals = true");
    EXPECT_THAT(bars_of(net, true), ElementsAre(Pair(0, 1), Pair(1, 2), Pair(3, 4), Pair(4, 5), Pair(0, 3),
                                                Pair(1, 4), Pair(2, 5)));
    EXPECT_THAT(bars_of(net, false), ElementsAre(Pair(0, 4), Pair(1, 3), Pair(1, 5), Pair(2, 4)));
    EXPECT_TRUE(
        std::is_partitioned(net.bars.begin(), net.bars.end(), [](const NetBar& bar) { return bar.is_real; }));
}

TEST(SceneGrid, HasTheBarsOfACloth) {
    // 39 * 30 + 40 * 29 threads, two diagonals in each of 39 * 29 cells.
    const auto net = grid("columns = 40, rows = 30, spacing = 0.1, diagonals = true");
    EXPECT_EQ(bars_of(net, true).size(), 2330U);
    EXPECT_EQ(bars_of(net, false).size(), 2262U);
    for (const char* more : {"", ", diagonals = false"}) {
        const auto open = grid(std::string("columns = 40, rows = 30, spacing = 0.1") + more);
        EXPECT_EQ(bars_of(open, true).size(), 2330U);
        EXPECT_THAT(bars_of(open, false), IsEmpty());
    }
}

TEST(SceneGrid, MayBeASingleRowOrColumn) {
    EXPECT_THAT(bars_of(grid("columns = 3, rows = 1, spacing = 1"), true),
                ElementsAre(Pair(0, 1), Pair(1, 2)));
    const auto column = grid("columns = 1, rows = 3, spacing = 1");
    EXPECT_THAT(bars_of(column, true), ElementsAre(Pair(0, 1), Pair(1, 2)));
    EXPECT_THAT(column.pinned, ElementsAre(0U));
}

TEST(SceneGrid, IsPinnedAtItsUpperCornersOrWhereItSays) {
    const std::string keys = "columns = 4, rows = 3, spacing = 1";
    EXPECT_THAT(grid(keys).pinned, ElementsAre(0U, 3U));
    EXPECT_THAT(grid(keys, "pinned = []").pinned, IsEmpty());
    EXPECT_THAT(grid(keys, "pinned = [1, -1]").pinned, ElementsAre(1U, 11U));
    EXPECT_THAT(grid(keys, "pinned = [[1, 0], [-1, 0], [0, -1], [-2, -2], 0]").pinned,
                ElementsAre(1U, 3U, 8U, 6U, 0U));
}

TEST(ScenePointNet, IsRelativeToItsFirstPoint) {
    const auto net = graph("");
    EXPECT_EQ(net.origin_m, (Vec2{5, 7}));
    EXPECT_THAT(net.points_m, ElementsAre(Vec2{0, 0}, Vec2{1, 0}, Vec2{1, -2}));
    EXPECT_THAT(bars_of(net, true), ElementsAre(Pair(0, 1), Pair(1, 2)));
    EXPECT_THAT(bars_of(net, false), IsEmpty());
    EXPECT_THAT(net.pinned, ElementsAre(0U));
}

TEST(ScenePointNet, CountsFromEitherEnd) {
    const auto net =
        net_of("points = [[0, 0], [1, 0], [1, 1]]\nbars = [[0, -1], [-1, 1]]\npinned = [-1, 0]\n");
    EXPECT_THAT(bars_of(net, true), ElementsAre(Pair(0, 2), Pair(2, 1)));
    EXPECT_THAT(net.pinned, ElementsAre(2U, 0U));
}

TEST(ScenePointNet, MayHaveCoincidentPointsThatNoBarJoins) {
    EXPECT_EQ(net_of("points = [[0, 0], [1, 0], [0, 0]]\nbars = [[0, 1], [1, 2]]\n").points_m.size(), 3U);
}

TEST(SceneNet, HasMassesVelocitiesAndMaterialAsARope) {
    const auto plain = graph("");
    EXPECT_THAT(plain.mass_kg, ElementsAre(1.0, 1.0, 1.0));
    EXPECT_THAT(plain.velocity_m_s, ElementsAre(Vec2{}, Vec2{}, Vec2{}));
    EXPECT_EQ(plain.material.compliance_1_n, 0.0);
    EXPECT_FALSE(plain.material.is_string);
    const auto net =
        graph("mass = [1, 2, 3]\nvelocity = [[1, 2], [3, 4], [5, 6]]\ncompliance = 0.25\nstring = true\n");
    EXPECT_THAT(net.mass_kg, ElementsAre(1.0, 2.0, 3.0));
    EXPECT_THAT(net.velocity_m_s, ElementsAre(Vec2{1, 2}, Vec2{3, 4}, Vec2{5, 6}));
    EXPECT_EQ(net.material.compliance_1_n, 0.25);
    EXPECT_TRUE(net.material.is_string);
    EXPECT_FALSE(graph("string = false").material.is_string);
}

TEST(SceneNet, ComesAfterTheRopesWhereverItStands) {
    const Scene scene = parse_scene(
        "schema = 1\n[[net]]\ngrid = { columns = 2, rows = 2, spacing = 1, diagonals = true }\nwidth_px = "
        "7\ncolor = "
        "\"#010203\"\n[[rope]]\nline = { particles = 3, step = [1, 0] }\nwidth_px = 8\n",
        "a");
    ASSERT_EQ(scene.body_styles.size(), 2U);
    EXPECT_EQ(scene.body_styles[0].width_px, 8.0);
    EXPECT_EQ(scene.body_styles[1].width_px, 7.0);
    EXPECT_EQ(scene.body_styles[1].color, (Color{1, 2, 3, 255}));
    const System system = system_of(scene);
    ASSERT_EQ(system.bodies.size(), 2U);
    EXPECT_FALSE(system.bodies[0].is_net);
    EXPECT_TRUE(system.bodies[1].is_net);
    EXPECT_EQ(system_text(system), "1 rope, 1 net: 7 particles, 8 bars (6 real)");
}

TEST(SceneNet, AloneIsAScene) {
    const Scene scene =
        parse_scene("schema = 1\nnet = [{ grid = { columns = 2, rows = 1, spacing = 1 } }]\n", "a");
    EXPECT_TRUE(scene.ropes.empty());
    EXPECT_EQ(scene.nets.size(), 1U);
}

TEST(SceneNet, SettingsReachIntoIt) {
    const std::string keys = "grid = { columns = 3, rows = 2, spacing = 1 }\n";
    EXPECT_EQ(net_of(keys, {"net[0].grid.columns=5"}).points_m.size(), 10U);
    EXPECT_EQ(bars_of(net_of(keys, {"net[0].grid.diagonals=true"}), false).size(), 4U);
    EXPECT_EQ(net_of(keys, {"net[0].mass=2"}).mass_kg[5], 2.0);
    EXPECT_THAT(net_of(keys, {"net[0].pinned=[[1,-1]]"}).pinned, ElementsAre(4U));
    EXPECT_EQ(error_of("schema = 1\n[[net]]\n" + keys, {"net[0].grid.colums=5"}).message,
              "--set net[0].grid.colums=5: net[0].grid.colums: unknown key \"colums\"; did you mean "
              "\"columns\"?");
}

TEST(SceneNet, AParticleThatNoBarJoinsFalls) {
    const Scene scene = parse_scene(
        "schema = 1\n[[net]]\npoints = [[0, 0], [0, -1], [3, 2]]\nbars = [[0, 1]]\n"
        "[solver]\nmethod = \"rattle\"\n",
        "a");
    Film film(scene);
    const State& state = film.state_at(1.0);
    EXPECT_EQ(state.x_m[2], 3.0);
    EXPECT_NEAR(state.y_m[2], 2.0 - 0.5 * 9.81, 1e-13);  // measured 2e-15
    EXPECT_EQ(state.y_m[1], -1.0);
}

}  // namespace
}  // namespace corda::scene
