#include "corda/film/motion_input.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "corda/film/film.hpp"
#include "support/failure.hpp"

namespace corda::film {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

TEST(ValidScenes, HaveOneFrameUpToTheLimit) {
    const auto code_of = [](double duration_s, Rational fps) {
        Scene scene;
        scene.world.duration_s = duration_s;
        scene.video.fps = FrameRate(fps);
        return test::failure_of([&] { validate(scene, {}); }).code;
    };
    EXPECT_EQ(code_of(10.0, {60, 1}), ExitCode::kOk);
    EXPECT_EQ(code_of(1e-9, {1, 1000}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of(1e10, {1, 1000}), ExitCode::kOk);
    EXPECT_EQ(code_of(1.001e10, {1, 1000}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of(100.0, {100'000, 1}), ExitCode::kOk);
    EXPECT_EQ(code_of(101.0, {100'000, 1}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of(1.0, {100'001, 1}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of(1.0, {1'000'000'001, 1000}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of(1.0, {1, -1}), ExitCode::kInvalidScene);
}

TEST(ValidScenes, NameTheirBodiesOnce) {
    Scene scene;
    scene.ropes.resize(2);
    const auto code_of = [&](const std::vector<BodySolverDef>& groups) {
        scene.body_solvers = groups;
        return test::failure_of([&] { validate(scene, {}); }).code;
    };
    EXPECT_EQ(code_of({{{1}, {}, ExactDef{}}}), ExitCode::kOk);
    EXPECT_EQ(code_of({{{2}, {}, ExactDef{}}}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of({{{1}, {}, ExactDef{}}, {{0, 1}, {}, RattleDef{}}}), ExitCode::kInvalidScene);
    EXPECT_EQ(code_of({{{1}, {}, ExactDef{1.0}}}), ExitCode::kInvalidScene);
}

TEST(MotionTimes, IncludeTheEndAndTheLastFrame) {
    Scene scene;
    scene.world.duration_s = 0.1;  // rounded down, by 30 per second a bit less than 3 frames
    scene.video.fps = FrameRate(Rational{30, 1});
    EXPECT_EQ(last_frame_of(scene), 3);
    EXPECT_TRUE(motion_time_s(scene, 0.0).has_value());
    EXPECT_TRUE(motion_time_s(scene, 0.1).has_value());
    EXPECT_TRUE(motion_time_s(scene, std::nextafter(0.1, 1.0)).has_value());
    EXPECT_TRUE(motion_time_s(scene, scene.video.fps.time_s(3)).has_value());
    EXPECT_FALSE(motion_time_s(scene, -0.001).has_value());
    EXPECT_FALSE(motion_time_s(scene, 0.101).has_value());
    EXPECT_FALSE(motion_time_s(scene, std::nan("")).has_value());
    const std::array<double, 2> stills_s{0.05, std::nan("")};
    EXPECT_EQ(test::failure_of([&] { validate(scene, stills_s); }).code, ExitCode::kUsage);
    EXPECT_EQ(test::failure_of([&] { validate(scene, std::span(stills_s).first(1)); }).code, ExitCode::kOk);
}

std::vector<std::string> notes_of(const std::string& bodies) {
    return Film(parse_scene("schema = 1\nworld.duration = 0.2\n" + bodies, "notes")).plan().notes;
}

TEST(Notes, ReportTheEnergyThatRigidBarsRemove) {
    for (const char* const method : {"auto", "exact", "rattle", "relaxation"}) {
        const std::string solver = std::string("solver.method = \"") + method + "\"\n";
        EXPECT_THAT(
            notes_of(solver + "[[rope]]\npoints = [[0, 0], [1, 0]]\nvelocity = [[0, 0], [3, 4]]\n"),
            ElementsAre(AllOf(StartsWith("rope 0: 36 % of the kinetic energy at the start, 4.5 J of 12.5 J"),
                              HasSubstr("or a compliance"))))
            << method;
    }
    EXPECT_THAT(
        notes_of("[[rope]]\nhang = { links = 1, length = 1, angle_deg = 0 }\nvelocity = [[0, 0], [0, -5]]\n"),
        ElementsAre(HasSubstr("100 % of the kinetic energy")));
}

TEST(Notes, ReportPinsThatStartWithASpeed) {
    const std::string rope =
        "[[rope]]\nhang = { links = 3, length = 1, angle_deg = 0 }\n"
        "moves = [{ pin = 0, waves = [{ amplitude = [0, 0.1], frequency = 1";
    EXPECT_THAT(
        notes_of(rope + " }] }]\n"),
        ElementsAre(AllOf(HasSubstr("is left out: a pin starts with a speed along bars"),
                          HasSubstr("let its waves start at rest (phase_deg = 90), or a compliance"))));
    EXPECT_THAT(notes_of(rope + ", phase_deg = 90 }] }]\n"), IsEmpty());
    // With the speed of the pin, nothing is lost but rounding.
    EXPECT_THAT(notes_of(rope + " }] }]\nvelocity = [0.0, 0.628318530718]\n"), IsEmpty());
}

TEST(Notes, DoNotReportAdmissibleVelocities) {
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, 0]]\nvelocity = [[0, 0], [0, 4]]\n"), IsEmpty());
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, 0]]\nvelocity = [1, 1]\npinned = []\n"), IsEmpty());
    EXPECT_THAT(
        notes_of("[[rope]]\npoints = [[0, 0], [1, 0]]\nvelocity = [[0, 0], [3, 4]]\ncompliance = 0.01\n"),
        IsEmpty());
}

TEST(Notes, ReportVelocityAlongTheLinksOfAString) {
    const std::string string = "[[rope]]\nstring = true\npoints = [[0, 0], [1, 0]]\nvelocity = [[0, 0], ";
    EXPECT_THAT(notes_of(string + "[3, 4]]\n"), ElementsAre(HasSubstr("36 %")));
    EXPECT_THAT(notes_of(string + "[-3, 4]]\n"), IsEmpty());
}

TEST(Notes, ReportAStringThatIsPulledIn) {
    const std::string string =
        "[[rope]]\npoints = [[0, 0], [0, -1], [0, -1], [1, -1]]\nstring = true\nlink_length = ";
    EXPECT_THAT(notes_of(string + "0.5\n"),
                ElementsAre(HasSubstr("particle 3 at [0.5, -0.5] instead of [1, -1]")));
    EXPECT_THAT(notes_of(string + "0.5\ncompliance = 1e-3\n"), IsEmpty());
    EXPECT_THAT(notes_of(string + "1.0\n"), IsEmpty());
}

TEST(Notes, ReportVelocitiesOfPinnedParticles) {
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, 0]]\nvelocity = [[1, 0], [0, 2]]\n"),
                ElementsAre(HasSubstr("velocity [1, 0] of particle 0 is left out")));
    // One velocity for all is that of the free ones.
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, 0]]\nvelocity = [0, 2]\n"), IsEmpty());
}

TEST(Notes, ReportPayloadOnAPinAndBendingWithoutAJoint) {
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, -1], [2, 0]]\npinned = [0, -1]\npayload = 2\n"),
                ElementsAre(HasSubstr("payload 2 kg changes nothing")));
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, -1], [2, 0]]\npinned = [0, -1]\npayload = 2\n"
                         "release = [{ pin = -1, t = 1 }]\n"),
                IsEmpty());
    EXPECT_THAT(notes_of("[[rope]]\npoints = [[0, 0], [1, -1]]\nbending = 2\n"),
                ElementsAre(HasSubstr("bending changes nothing")));
}

TEST(Notes, ReportColoursBeyondTheLastLink) {
    EXPECT_THAT(notes_of("style.color_by = \"link\"\n[[rope]]\nhang = { links = 2, length = 1 }\n"
                         "color = [\"red\", \"blue\", \"red\"]\n"),
                ElementsAre(HasSubstr("the last 1 of 3 colours are not used")));
}

}  // namespace
}  // namespace corda::film
