// `--set key=value` over a scene file.
#include <gmock/gmock.h>

#include "unit/scene/support.hpp"

namespace corda::scene {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Scene scene_with(const std::vector<Setting>& settings) {
    return parse_scene(rope_with("mass = 1\n[video]\nfps = 60\n"), "swing.toml", settings);
}

TEST(SceneSettings, TakeThePlaceOfTheFile) {
    EXPECT_EQ(scene_with({"video.fps=30"}).video.fps.rational(), (Rational{30, 1}));
    EXPECT_EQ(scene_with({"rope[0].mass=2"}).ropes[0].mass_kg[1], 2.0);
    EXPECT_EQ(scene_with({"rope[0].mass=[1, 2, 3]"}).ropes[0].mass_kg[1], 2.0);
    EXPECT_EQ(scene_with({"rope[0].line.particles=5"}).ropes[0].points_m.size(), 5U);
    EXPECT_EQ(scene_with({"rope[0].line.step[1]=-2"}).ropes[0].points_m[1], (Vec2{0, -2}));
}

TEST(SceneSettings, MakeMissingTables) {
    EXPECT_EQ(scene_with({"world.duration=3"}).world.duration_s, 3.0);
    EXPECT_EQ(solver_name(scene_with({"solver.method=relaxation"}).solver), "relaxation");
    EXPECT_EQ(scene_with({" camera.margin = 0.2 "}).camera.margin, 0.2);
    EXPECT_EQ(scene_with({"world={duration=2}"}).world.duration_s, 2.0);
}

TEST(SceneSettings, ReachTheSolversOfBodies) {
    const Setting group = "solver.bodies=[{ropes=[0],method=\"rattle\"}]";
    const auto def_with = [&](const Setting& more) {
        return std::get<RattleDef>(scene_with({group, more}).body_solvers.at(0).method);
    };
    EXPECT_EQ(def_with("world.duration=1").order, 4);
    EXPECT_EQ(def_with("solver.bodies[0].order=8").order, 8);
    EXPECT_EQ(error_of(rope_with(""), {group, "solver.bodies[0].order=3"}).message,
              "--set solver.bodies[0].order=3: solver.bodies[0].order: 3 is not allowed; give one of: 2, 4, "
              "6, 8");
    EXPECT_EQ(error_of(rope_with(""), {group, "solver.bodies.order=8"}).message,
              "--set solver.bodies.order=8: solver.bodies: this is a list of tables; give an index: "
              "solver.bodies[0]");
}

TEST(SceneSettings, TakeWhatIsNotTomlAsText) {
    EXPECT_EQ(scene_with({"video.fps=30000/1001"}).video.fps.rational(), (Rational{30000, 1001}));
    EXPECT_EQ(scene_with({"video.preset=\"slow\""}).video.encoder.preset, "slow");
    EXPECT_EQ(scene_with({"video.preset=slow"}).video.encoder.preset, "slow");
    EXPECT_EQ(scene_with({"style.background=#102030"}).style.background->top, (Color{0x10, 0x20, 0x30}));
    const SceneError two = error_of(rope_with(""), {"video.crf=20\nother=3"});
    EXPECT_EQ(two.message,
              "--set video.crf=20\\x0aother=3: video.crf: \"20\\x0aother=3\" is a string, not an integer; "
              "give the constant rate factor (H.264, H.265: up to 51), 1 .. 63");
}

TEST(SceneSettings, LaterOnesWin) {
    EXPECT_EQ(scene_with({"video.size=[64,64]", "video.size=[32,16]", "video.size[0]=8"}).video.width_px, 8);
}

TEST(SceneSettings, AreNamedInMessagesAboutTheirValues) {
    EXPECT_EQ(error_of(rope_with("mass = 1"), {"rope[0].mass=-1"}).message,
              "--set rope[0].mass=-1: rope[0].mass: -1 is not >= 1e-12; give the mass of a particle in kg, "
              "1e-12 .. 1e12, or a list with one per particle");
    EXPECT_EQ(error_of(rope_with(""), {"video.fbs=3"}).message,
              "--set video.fbs=3: video.fbs: unknown key \"fbs\"; did you mean \"fps\"?");
    EXPECT_EQ(error_of(rope_with(""), {"vidio.fps=3"}).message,
              "--set vidio.fps=3: vidio: unknown key \"vidio\"; did you mean \"video\"?");
    EXPECT_THAT(error_of(rope_with(""), {"world.gravity=[0,nan]"}).message,
                StartsWith("--set world.gravity=[0,nan]: world.gravity[1]: nan is not a finite number"));
    EXPECT_THAT(error_of(rope_with(""), {"world.duration=1e12"}).message,
                StartsWith("--set world.duration=1e12: world.duration: 1e+12 s at 60"));
    EXPECT_THAT(error_of(rope_with("mass = -1"), {"video.fps=30"}).message, StartsWith("swing.toml:4:8: "));
}

TEST(SceneSettings, WithoutAValueRemoveTheKey) {
    EXPECT_EQ(scene_with({"video.fps="}).video.fps.rational(), VideoDef{}.fps.rational());
    EXPECT_EQ(scene_with({"video.fps=30", "video.fps="}).video.fps.rational(), VideoDef{}.fps.rational());
    EXPECT_EQ(scene_with({"video="}).video.fps.rational(), VideoDef{}.fps.rational());
    const std::string two = rope_with("") + rope_with("").substr(rope_with("").find("[[rope]]"));
    EXPECT_EQ(parse_scene(two, "swing.toml").ropes.size(), 2U);
    EXPECT_EQ(parse_scene(two, "swing.toml", {"rope[1]="}).ropes.size(), 1U);
    EXPECT_EQ(error_of(rope_with(""), {"video.fps="}).message,
              "--set video.fps=: video.fps: the scene does not give this key, so there is nothing to remove; "
              "give a value");
    EXPECT_THAT(error_of(rope_with(""), {"rope[0]="}).message, HasSubstr("rope"));
    EXPECT_THAT(error_of(rope_with(""), {"rope[1]="}).message, HasSubstr("index 1 is out of range"));
}

TEST(SceneSettings, ThatDoNotFitTheFileAreInvalid) {
    const auto message = [](const Setting& setting) {
        const SceneError error = error_of(rope_with("mass = 1\n[world]\ngravity = 1\n"), {setting});
        EXPECT_EQ(error.code, ExitCode::kInvalidScene) << setting;
        return error.message;
    };
    EXPECT_EQ(message("rope[1].mass=2"),
              "--set rope[1].mass=2: rope: index 1 is out of range; the list has 1; give 0");
    EXPECT_EQ(message("rope[99999999999].mass=2").substr(0, 24), "--set rope[99999999999].");
    EXPECT_THAT(message("rope.mass=2"), HasSubstr("rope: this is a list of tables; give an index: rope[0]"));
    EXPECT_THAT(message("world.gravity.x=2"),
                HasSubstr("world.gravity: 1 is an integer, not a table; end the key at world.gravity"));
    EXPECT_THAT(message("world[0]=2"), HasSubstr("world: this is a table, not a list; leave out the index"));
    EXPECT_THAT(message("net[0].mass=2"), HasSubstr("the scene gives no list \"net\""));
    EXPECT_THAT(message("rope[0].line.from[0]=2"), HasSubstr("the scene gives no list \"from\""));
}

TEST(SceneSettings, ThatAreNoKeyAndValueAreUsageErrors) {
    std::string deep = "a";
    for (int i = 0; i < 100'000; ++i) deep += ".a";
    for (const Setting& setting :
         {std::string("video.fps"), std::string(""), std::string("=3"), std::string(" =3"),
          std::string("video..fps=3"), std::string(".fps=3"), std::string("video.=3"),
          std::string("rope[]=3"), std::string("rope[x]=3"), std::string("rope[-1]=3"),
          std::string("rope[0=3"), std::string("rope[0]mass=3"), std::string("[0]=3"),
          std::string("rope[99999999999999999999]=3"), std::string("a b=3"), deep + "=3"}) {
        const SceneError error = error_of(rope_with(""), {setting});
        EXPECT_EQ(error.code, ExitCode::kUsage) << setting.substr(0, 80);
        EXPECT_THAT(error.message, HasSubstr("give --set key=value")) << setting.substr(0, 80);
    }
}

TEST(SceneSettings, OfDeepValuesAreText) {
    std::string deep = "world={a";
    for (int i = 0; i < 1'000'000; ++i) deep += ".a";
    const SceneError error = error_of(rope_with(""), {deep + "=1}"});
    EXPECT_EQ(error.code, ExitCode::kInvalidScene);
    EXPECT_THAT(error.message, HasSubstr("is a string, not a table"));
}

}  // namespace
}  // namespace corda::scene
