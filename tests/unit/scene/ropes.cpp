// The shapes of ropes and what belongs to each particle.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "unit/scene/support.hpp"

namespace corda::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

RopeDef rope_of(const std::string& toml) {
    return parse_scene(toml, "swing.toml").ropes.at(0);
}

RopeDef hang(const std::string& angle_deg, const std::string& from = "[0, 0]") {
    return rope_of("schema = 1\n[[rope]]\nhang = { links = 4, length = 2.0, angle_deg = " + angle_deg +
                   ", from = " + from + " }\n");
}

TEST(SceneLine, HasParticlesAtExactMultiplesOfItsStep) {
    const auto rope =
        rope_of("schema = 1\n[[rope]]\nline = { particles = 40, from = [0.0, 50.0], step = [0.1, -1.0] }\n");
    EXPECT_EQ(rope.origin_m, (Vec2{0.0, 50.0}));
    ASSERT_EQ(rope.points_m.size(), 40U);
    for (int i = 0; i < 40; ++i)
        EXPECT_EQ(rope.points_m[static_cast<std::size_t>(i)], (Vec2{i * 0.1, -1.0 * i}));
    EXPECT_FALSE(std::signbit(rope.points_m[0].y));
}

TEST(SceneLine, FarFromTheOriginHasTheSamePoints) {
    const std::string begin = "schema = 1\n[[rope]]\nline = { particles = 40, step = [0.1, -0.3], from = ";
    const auto near = rope_of(begin + "[0, 0] }\n");
    const auto far = rope_of(begin + "[123456.7, -9e8] }\n");
    EXPECT_EQ(near.points_m, far.points_m);
    EXPECT_EQ(far.origin_m, (Vec2{123456.7, -9e8}));
}

TEST(SceneHang, TakesParticlesForLinks) {
    const auto by_links = hang("30");
    const auto by_particles =
        rope_of("schema = 1\n[[rope]]\nhang = { particles = 5, length = 2.0, angle_deg = 30 }\n");
    EXPECT_EQ(by_particles.points_m, by_links.points_m);
}

TEST(SceneHang, IsExactAtMultiplesOfARightAngle) {
    EXPECT_THAT(hang("0").points_m,
                ElementsAre(Vec2{0, 0}, Vec2{0, -0.5}, Vec2{0, -1}, Vec2{0, -1.5}, Vec2{0, -2}));
    EXPECT_THAT(hang("90").points_m,
                ElementsAre(Vec2{0, 0}, Vec2{0.5, 0}, Vec2{1, 0}, Vec2{1.5, 0}, Vec2{2, 0}));
    EXPECT_EQ(hang("-90").points_m.back(), (Vec2{-2, 0}));
    EXPECT_EQ(hang("270").points_m.back(), (Vec2{-2, 0}));
    EXPECT_EQ(hang("180").points_m.back(), (Vec2{0, 2}));
    EXPECT_EQ(hang("-180").points_m.back(), (Vec2{0, 2}));
    EXPECT_EQ(hang("360").points_m.back(), (Vec2{0, -2}));
    EXPECT_EQ(hang("3600000090").points_m.back(), (Vec2{2, 0}));
}

TEST(SceneHang, FollowsItsAngleFromStraightDown) {
    for (const int degrees : {1, 30, 45, 60, 89, 91, 135, 179, 181, 225, 300, 359, -1, -45, -100, -200}) {
        const double radians = degrees * std::numbers::pi / 180.0;
        const Vec2 last = hang(std::to_string(degrees)).points_m.back();
        EXPECT_NEAR(last.x, 2.0 * std::sin(radians), 4e-15) << degrees;  // measured 1e-15
        EXPECT_NEAR(last.y, -2.0 * std::cos(radians), 4e-15) << degrees;
    }
}

TEST(SceneHang, FarFromTheOriginHasTheSamePoints) {
    EXPECT_EQ(hang("33").points_m, hang("33", "[1e8, -7.7e8]").points_m);
    EXPECT_EQ(hang("33", "[1e8, -7.7e8]").origin_m, (Vec2{1e8, -7.7e8}));
}

TEST(SceneHang, HasItsDefaults) {
    const auto rope = rope_of("schema = 1\n[[rope]]\nhang = { links = 1, length = 3 }\n");
    EXPECT_EQ(rope.origin_m, Vec2{});
    EXPECT_THAT(rope.points_m, ElementsAre(Vec2{0, 0}, Vec2{0, -3}));
}

/// A rope of arms; `more` stands after its angles.
std::string arms(const std::string& lengths, const std::string& angles_deg, const std::string& more = "") {
    return "schema = 1\n[[rope]]\nhang = { lengths = " + lengths + ", angles_deg = " + angles_deg + more +
           " }\n";
}

TEST(SceneArms, FollowTheirOwnAnglesAndTurnByTheirOwnRates) {
    const auto rope =
        rope_of(arms("[1.0, 0.5, 2.0]", "[90, -30, 180]", ", from = [5, 7], rates_deg_s = [60, 0, -90]"));
    EXPECT_EQ(rope.origin_m, (Vec2{5, 7}));
    const std::vector<Vec2> points_m{
        {0, 0}, {1, 0}, {0.75, -std::sqrt(3.0) / 4}, {0.75, 2 - std::sqrt(3.0) / 4}};
    const double pi = std::numbers::pi;
    const std::vector<Vec2> velocity_m_s{{0, 0}, {0, pi / 3}, {0, pi / 3}, {pi, pi / 3}};
    ASSERT_EQ(rope.points_m.size(), 4U);
    ASSERT_EQ(rope.velocity_m_s.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_LT(std::hypot(rope.points_m[i].x - points_m[i].x, rope.points_m[i].y - points_m[i].y), 1e-15)
            << i;
        const Vec2 off = rope.velocity_m_s[i] - velocity_m_s[i];
        EXPECT_LT(std::hypot(off.x, off.y), 1e-15) << i;  // measured 4.4e-16
    }
}

TEST(SceneArms, OfOneAngleAreAStraightRope) {
    EXPECT_EQ(rope_of(arms("[0.5, 0.5, 0.5, 0.5]", "[90, 90, 90, 90]")).points_m, hang("90").points_m);
    EXPECT_THAT(rope_of(arms("[0.5]", "[30]")).velocity_m_s, ElementsAre(Vec2{}, Vec2{}));
}

TEST(SceneArms, TakeSettingsOfOneEntry) {
    const std::string text = arms("[1, 2]", "[0, 0]", ", rates_deg_s = [0, 0]");
    const auto rope =
        parse_scene(text, "a", {"rope[0].hang.angles_deg[1]=90", "rope[0].hang.rates_deg_s[1]=360"})
            .ropes.at(0);
    EXPECT_THAT(rope.points_m, ElementsAre(Vec2{0, 0}, Vec2{0, -1}, Vec2{2, -1}));
    EXPECT_EQ(rope.velocity_m_s[2].x, 0.0);
    EXPECT_NEAR(rope.velocity_m_s[2].y, 4 * std::numbers::pi, 1e-14);
}

TEST(ScenePoints, AreRelativeToTheFirst) {
    const auto rope = rope_of("schema = 1\n[[rope]]\npoints = [[5, 7], [5.5, 6], [8, 8]]\n");
    EXPECT_EQ(rope.origin_m, (Vec2{5, 7}));
    EXPECT_THAT(rope.points_m, ElementsAre(Vec2{0, 0}, Vec2{0.5, -1}, Vec2{3, 1}));
}

TEST(ScenePoints, OfAClosedRopeMayCoincideIfNoBarJoinsThem) {
    const std::string rope = "schema = 1\n[[rope]]\npoints = [[0, 0], [1, 0], [1, 1], [0, 0]]\n";
    EXPECT_EQ(
        parse_scene(rope + "[solver]\nmethod = \"relaxation\"\nreach = 2\n", "a").ropes[0].points_m.size(),
        4U);
    EXPECT_NE(error_of(rope + "[solver]\nmethod = \"relaxation\"\nreach = 3\n").code, ExitCode::kOk);
}

TEST(SceneRope, MassIsOneForAllOrAList) {
    EXPECT_THAT(rope_of(rope_with("mass = 2")).mass_kg, ElementsAre(2.0, 2.0, 2.0));
    EXPECT_THAT(rope_of(rope_with("mass = [1, 2.5, 1e-12]")).mass_kg, ElementsAre(1.0, 2.5, 1e-12));
}

TEST(SceneRope, VelocityIsOneForAllOrAList) {
    EXPECT_THAT(rope_of(rope_with("velocity = [1, -2]")).velocity_m_s,
                ElementsAre(Vec2{1, -2}, Vec2{1, -2}, Vec2{1, -2}));
    EXPECT_THAT(rope_of(rope_with("velocity = [[1, 2], [3, 4], [5, 6]]")).velocity_m_s,
                ElementsAre(Vec2{1, 2}, Vec2{3, 4}, Vec2{5, 6}));
    const auto two = rope_of(
        "schema = 1\n[[rope]]\nline = { particles = 2, step = [1, 0] }\nvelocity = [[1, 2], [3, 4]]\n");
    EXPECT_THAT(two.velocity_m_s, ElementsAre(Vec2{1, 2}, Vec2{3, 4}));
}

TEST(SceneRope, PinnedCountsFromEitherEnd) {
    EXPECT_THAT(rope_of(rope_with("pinned = [0, -1]")).pinned, ElementsAre(0U, 2U));
    EXPECT_THAT(rope_of(rope_with("pinned = [-3]")).pinned, ElementsAre(0U));
    EXPECT_THAT(rope_of(rope_with("pinned = []")).pinned, IsEmpty());
}

TEST(SceneRope, PayloadColourAndWidth) {
    const Scene scene = parse_scene(rope_with("payload = 3\ncolor = \"#10203040\"\nwidth_px = 0.1"), "a");
    EXPECT_EQ(scene.ropes[0].payload_kg, 3.0);
    EXPECT_EQ(scene.body_styles[0].color, (Color{0x10, 0x20, 0x30, 0x40}));
    EXPECT_EQ(scene.body_styles[0].width_px, 0.1);
}

TEST(SceneRope, IsPlainUnlessTheFileSaysOtherwise) {
    const auto rope = rope_of(square_with(""));
    EXPECT_FALSE(rope.closed);
    EXPECT_THAT(rope.rest_m, IsEmpty());
    EXPECT_EQ(rope.material.compliance_1_n, 0.0);
    EXPECT_FALSE(rope.material.is_string);
    EXPECT_EQ(rope.bending_n_m2, 0.0);
    const auto same = rope_of(square_with("closed = false\ncompliance = 0\nstring = false\nbending = 0\n"));
    EXPECT_FALSE(same.closed);
    EXPECT_FALSE(same.material.is_string);
}

TEST(SceneRope, ClosedHasOneLinkMore) {
    const Scene scene = parse_scene(square_with("closed = true\nbending = 0.5"), "a");
    EXPECT_TRUE(scene.ropes[0].closed);
    EXPECT_EQ(scene.ropes[0].bending_n_m2, 0.5);
    const System system = system_of(scene);
    ASSERT_EQ(system.bars.size(), 4U);
    EXPECT_EQ(system.bars[3].a, 3U);
    EXPECT_EQ(system.bars[3].b, 0U);
    EXPECT_EQ(system.bends.size(), 4U);
}

TEST(SceneRope, ClosedHasEachBarOnceUpToItsReach) {
    // Six points: 6 bars of reach 1 and 2, 3 of reach 3 that join opposite ones.
    const std::string points =
        "points = [[2, 0], [1, 1.7], [-1, 1.7], [-2, 0], [-1, -1.7], [1, -1.7]]\nclosed = true\n";
    for (const auto& [reach, bars] : {std::pair{1, 6}, {2, 12}, {3, 15}, {4, 15}, {7, 15}}) {
        const Scene scene =
            parse_scene("schema = 1\n[[rope]]\n" + points +
                            "[solver]\nmethod = \"relaxation\"\nreach = " + std::to_string(reach) + "\n",
                        "a");
        EXPECT_EQ(system_of(scene).bars.size(), static_cast<std::size_t>(bars)) << "reach " << reach;
    }
}

TEST(SceneRope, IsOfItsMaterial) {
    const auto rubber = rope_of(rope_with("compliance = 1e-3"));
    EXPECT_EQ(rubber.material.compliance_1_n, 1e-3);
    EXPECT_FALSE(rubber.material.is_string);
    EXPECT_TRUE(rope_of(rope_with("string = true")).material.is_string);
    const auto bungee = rope_of(square_with("closed = true\nstring = true\ncompliance = 1e6"));
    EXPECT_TRUE(bungee.material.is_string);
    EXPECT_EQ(bungee.material.compliance_1_n, 1e6);
    EXPECT_EQ(rope_of(rope_with("bending = 2.5\ncompliance = 0.1")).bending_n_m2, 2.5);
}

TEST(SceneRope, LinkLengthsAreOneForAllOrAList) {
    EXPECT_THAT(rope_of(rope_with("compliance = 0.1\nlink_length = 0.5")).rest_m, ElementsAre(0.5, 0.5));
    EXPECT_THAT(rope_of(rope_with("compliance = 0.1\nlink_length = [0.5, 2]")).rest_m, ElementsAre(0.5, 2.0));
    EXPECT_THAT(rope_of(square_with("closed = true\ncompliance = 0.1\nlink_length = [1, 2, 3, 4]")).rest_m,
                ElementsAre(1.0, 2.0, 3.0, 4.0));
    EXPECT_THAT(rope_of(rope_with("string = true\nlink_length = [1, 1.5]")).rest_m, ElementsAre(1.0, 1.5));
}

TEST(SceneRope, AStringThatIsTooShortByRoundingAloneIsTaut) {
    // The distance of the second link is sqrt(2): ten digits of it are short by 2e-11 of it.
    const std::string rope =
        "schema = 1\n[[rope]]\npoints = [[0, 0], [1, 0], [2, 1]]\nstring = true\nlink_length = ";
    EXPECT_THAT(rope_of(rope + "[1, 1.414213562]").rest_m, ElementsAre(1.0, std::sqrt(2.0)));
    EXPECT_THAT(rope_of(rope + "[0.9999999995, 1.5]").rest_m, ElementsAre(1.0, 1.5));
    EXPECT_THAT(rope_of(rope + "[0.999999998, 1.5]").rest_m, ElementsAre(0.999999998, 1.5));
    EXPECT_NE(error_of(rope + "[0.999999998, 1.5]\npinned = [0, 1]").code, ExitCode::kOk);
}

TEST(SceneRope, SeveralStayInTheirOrder) {
    const Scene scene =
        parse_scene(rope_with("mass = 2\n[[rope]]\npoints = [[0, 0], [1, 1]]\nmass = 3\n"), "a");
    ASSERT_EQ(scene.ropes.size(), 2U);
    EXPECT_THAT(scene.ropes[0].mass_kg, ElementsAre(2.0, 2.0, 2.0));
    EXPECT_THAT(scene.ropes[1].mass_kg, ElementsAre(3.0, 3.0));
    EXPECT_EQ(scene.body_styles.size(), 2U);
}

TEST(SlackStrings, MayHaveLinksWhoseEndsAreAtOnePlace) {
    const std::string points = "schema = 1\n[[rope]]\npoints = [[0, 0], [0, -1], [0, -1], [1, -1]]\n";
    const Scene scene = parse_scene(points + "string = true\nlink_length = [1, 0.5, 1.5]\n", "a");
    EXPECT_THAT(scene.ropes[0].rest_m, testing::ElementsAre(1.0, 0.5, 1.5));
    // Without rest lengths, or rigid, such a link has no direction.
    EXPECT_THAT(error_of(points + "string = true\n").message, testing::HasSubstr("points 1 and 2 coincide"));
    EXPECT_THAT(error_of(points).message, testing::HasSubstr("points 1 and 2 coincide"));
}

}  // namespace
}  // namespace corda::scene
