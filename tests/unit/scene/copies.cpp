// Ropes with copies, as the scene file gives them.
#include <gmock/gmock.h>

#include "corda/core/cancel.hpp"
#include "corda/scene/write_scene.hpp"
#include "unit/scene/support.hpp"

namespace corda::scene {
namespace {

using testing::HasSubstr;

Scene with_copies(const std::string& rope, const std::string& more = "") {
    return parse_scene("schema = 1\n[[rope]]\n" + rope + more, "swing.toml");
}

constexpr const char* kThree = "\ncopies = { count = 3, angle_deg = 10.0 }\n";

TEST(SceneCopies, OfAHangingRopeHangAtTheirAngles) {
    const Scene scene = with_copies(std::string("hang = { links = 2, length = 1.0, angle_deg = 30.0 }\n"
                                                "label = \"first\"\npayload = 2.0") +
                                    kThree + "[[rope]]\nline = { particles = 2, step = [0, -1] }\n");
    ASSERT_EQ(scene.ropes.size(), 4U);
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        RopeDef expected;
        place(HangDef{2, 1.0, 30.0 + 10.0 * k, {}}, expected);
        EXPECT_EQ(scene.ropes[i].points_m, expected.points_m);
        EXPECT_EQ(scene.ropes[i].payload_kg, 2.0);
        EXPECT_EQ(scene.body_styles[i].merged, k > 0);
        EXPECT_EQ(scene.body_styles[i].label, k > 0 ? "" : "first");
    }
    EXPECT_FALSE(scene.body_styles[3].merged);
    // Written out, it is the same scene.
    const Scene again = parse_scene(write_scene(scene), "again.toml");
    EXPECT_EQ(values_of(again), values_of(scene));
    ASSERT_EQ(again.ropes.size(), 4U);
}

TEST(SceneCopies, OfArmsHangAtTheirAnglesWithTheirRates) {
    const Scene scene = with_copies(
        "hang = { lengths = [1.0, 2.0], angles_deg = [80, -10], rates_deg_s = [360, 0] }\n"
        "copies = { count = 2, angle_deg = 10.0 }\n");
    ASSERT_EQ(scene.ropes.size(), 2U);
    RopeDef expected;
    const ArmsDef turned{{1.0, 2.0}, {90.0, 0.0}, {360.0, 0.0}, {}};
    place(turned, expected);
    EXPECT_EQ(scene.ropes[1].points_m, expected.points_m);
    EXPECT_EQ(scene.ropes[1].velocity_m_s, velocities_m_s(turned));
}

TEST(SceneCopies, OfPointsAreTurnedAboutTheirFirstPinWithTheirVelocities) {
    const Scene scene = with_copies(
        "points = [[0.0, 2.0], [0.0, 1.0], [0.0, 0.0]]\npinned = [1]\nvelocity = [1.0, 0.0]\n"
        "copies = { count = 2, angle_deg = 90.0 }\n");
    ASSERT_EQ(scene.ropes.size(), 2U);
    const RopeDef& turned = scene.ropes[1];
    const std::vector<Vec2> expected{{-1.0, 1.0}, {0.0, 1.0}, {1.0, 1.0}};
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec2 at = turned.origin_m + turned.points_m[i];
        EXPECT_EQ(at, expected[i]) << i;
    }
    EXPECT_EQ(turned.velocity_m_s[0], (Vec2{0.0, 1.0}));
}

TEST(SceneCopies, CountAsRopes) {
    const Scene scene = with_copies(std::string("hang = { links = 1, length = 1.0 }") + kThree,
                                    "[[solver.bodies]]\nropes = [2]\nmethod = \"rattle\"\n");
    ASSERT_EQ(scene.body_solvers.size(), 1U);
    EXPECT_EQ(scene.body_solvers[0].ropes, std::vector<std::uint32_t>{2});
}

std::string message_of(const std::string& rope) {
    try {
        static_cast<void>(with_copies(rope));
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(SceneCopies, HaveTheProblemsOfTheirRopeOnce) {
    const std::string one = "hang = { links = 2, length = 1.0 }\nmass = [1.0]";
    EXPECT_EQ(message_of(one + kThree), message_of(one + "\n"));
    // The problem of the next rope names its number in the file.
    EXPECT_THAT(message_of(std::string("hang = { links = 2, length = 1.0 }") + kThree +
                           "[[rope]]\nhang = { links = 2, length = 1.0 }\nmass = [1.0]\n"),
                HasSubstr("swing.toml:7:8: rope[1].mass: "));
    EXPECT_THAT(message_of("line = { particles = 2, from = [1e9, 0.0], step = [0.0, -1e8] }\n"
                           "copies = { count = 2, angle_deg = 90.0 }\n"),
                HasSubstr("rope[0].points[1]: with the origin it is at [1100000000"));
    EXPECT_THAT(message_of("line = { particles = 500000, step = [0, -1] }" + std::string(kThree)),
                HasSubstr("rope[0].copies: 3 copies of 500000 particles are over the limit"));
}

TEST(SceneCopies, AreCountedTogetherBeforeTheyAreMade) {
    const std::string one =
        "line = { particles = 100, step = [0.0, -0.01] }\ncopies = { count = 9000, angle_deg = 0.001 }\n";
    EXPECT_THAT(message_of(one + "[[rope]]\n" + one),
                HasSubstr("rope[1].copies: 9000 copies of 100 particles, with 900000 of ropes before it, are "
                          "over the limit of 1000000 particles; make fewer"));
}

TEST(SceneCopies, AreMadeUntilCancelled) {
    int checks = 0;
    const CancelScope scope([&] { return ++checks < 100; });
    EXPECT_THROW(static_cast<void>(with_copies(
                     "line = { particles = 2, step = [0, -1] }\ncopies = { count = 9000, angle_deg = 1 }\n")),
                 Error);
    EXPECT_EQ(checks, 100);
}

}  // namespace
}  // namespace corda::scene
