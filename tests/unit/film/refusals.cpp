// Scenes that their methods cannot move, and scenes beyond a limit: each message names remedies that work.
#include <gmock/gmock.h>

#include "corda/film/film.hpp"
#include "support/failure.hpp"
#include "support/messages.hpp"

namespace corda {
namespace {

constexpr const char* kOfMethods = R"(
@shape
points = [[0, 0], [0.5, -0.4], [0.1, -1], [-0.5, -0.5]]\nclosed = true\nbending = 0.1\n[solver]\nmethod = "exact" | - | use method auto, or let the bars stretch by a compliance | exact => rattle ; exact => auto ; [solver] => compliance = 1e-3\n[solver]
@rope
string = true\n[solver]\nmethod = "rattle" | - | use method auto, or let the string stretch by a compliance | rattle => exact ; rattle => auto ; [solver] => compliance = 1e-3\n[solver]
compliance = 1e-3\nbending = 1.0\n[solver]\nmethod = "relaxation" | - | remove compliance, string and bending, or use method auto | compliance = 1e-3\nbending = 1.0 => ; relaxation => exact ; relaxation => auto
string = true\n[solver]\nmethod = "relaxation" | - | remove compliance, string and bending, or use method auto | string = true => ; relaxation => exact ; relaxation => auto
@grid
compliance = 1e-3\n[solver]\nmethod = "relaxation" | - | remove compliance, string and bending, or use method auto | compliance = 1e-3 => ; relaxation => exact ; relaxation => auto
[solver]\nmethod = "relaxation"\n[[rope]]\nhang = { links = 4, length = 1.0 }\nstring = true | - | or use method auto | relaxation => auto
[solver]\nmethod = "rattle"\n[[rope]]\nhang = { links = 4, length = 1.0 }\nstring = true | - | use method auto | rattle => auto
@shape
points = [[0, 0], [0.5, -0.4], [0.1, -1], [-0.5, -0.5]]\nclosed = true\n[solver]\nmethod = "rattle"\n[[rope]]\npoints = [[2, 0], [2.3, 0.1]]\nstring = true\nlink_length = 0.5 | - | use method auto, or let the string stretch by a compliance | + [[solver.bodies]]\nropes = [1]\nmethod = "exact" ; + compliance = 1e-3 ; rattle => auto
line = { particles = 5, step = [0.25, 0.0] }\npinned = [0, -1] | - | let the rope sag between its pins (other points, or a string with a larger link_length), or pin the particles between them too | line = { particles = 5, step = [0.25, 0.0] } => points = [[0, 0], [0.25, -0.1], [0.5, -0.15], [0.75, -0.1], [1, 0]] ; + string = true\nlink_length = 0.26 ; [0, -1] => [0, 1, 2, 3, 4]
line = { particles = 3, step = [0.5, 0.0] }\npinned = [0, -1]\nstring = true | - | let the rope sag between its pins (other points, or a string with a larger link_length), or pin the particles between them too | + link_length = 0.6 ; [0, -1] => [0, 1, -1]
line = { particles = 3, step = [0.5, 0.0] }\npinned = [0, -1]\n[solver]\nmethod = "exact" | - | let the rope sag between its pins | [0, -1] => [0]
line = { particles = 3, step = [0.5, 0.0] }\npinned = [0, -1]\n[solver]\nmethod = "rattle" | - | let the rope sag between its pins | [0, -1] => [0]
@net
points = [[0, 0], [1, 0], [2, 0]]\nbars = [[0, 1], [1, 2], [0, 2]]\npinned = [0]\n[solver]\nmethod = "rattle" | - | bend collinear bars a little, leave out bars that others imply, or use method relaxation | [1, 0] => [1, -0.01] ; , [0, 2] => ; rattle => relaxation
grid = { columns = 1000, rows = 900, spacing = 0.1, diagonals = true }\npinned = []\n[solver]\nmethod = "rattle" | - | give fewer, or method relaxation | 1000, rows = 900 => 20, rows = 10
grid = { columns = 3, rows = 3, spacing = 0.2, diagonals = true }\n[style]\ncolor_by = "tension" | - | set style.color_by = "strain" or "speed", style.arrows = "velocity" or "weight", or let the bars stretch by a compliance | tension => speed ; tension => strain ; [style] => compliance = 1e-4\n[style]
grid = { columns = 3, rows = 3, spacing = 0.2, diagonals = true }\n[style]\narrows = "tension" | 5:10 style.arrows | tensions are asked for, which the method does not know | tension => velocity ; tension => weight ; [style] => compliance = 1e-4\n[style]
)";

constexpr const char* kOfLimits = R"(
@rope
[world]\nduration = 1e6 | - | give a shorter duration or fewer frames per second | 1e6 => 1 ; 1e6 => 10\n[video]\nfps = 0.1
[world]\nduration = 1e-12 | - | hold no frame; give a longer duration | 1e-12 => 0.1
mass = 0.1\ncompliance = 1e-25\n[solver]\nmethod = "rattle" | - | give more compliance, less bending, heavier particles or less gravity | 1e-25 => 1e-3
[solver]\nmethod = "rattle"\norder = 2\nstep = 9e-9\n[world]\nduration = 9.1 | - | give a longer step or a shorter duration | 9e-9 => 1e-3 ; 9.1 => 0.004
[solver]\nmethod = "relaxation"\nsweeps = 1000000\nstep = 5e-9\n[world]\nduration = 0.051 | - | give fewer of one of them | 5e-9 => 1e-2 ; 0.051 => 0.001 & 1000000 => 1
@shape
line = { particles = 1000000, step = [0.1, 0] }\n[[rope]]\nhang = { links = 4, length = 1.0 } | - | the ropes and nets up to this one have 1000005 particles, over the limit of 1000000; give fewer | 1000000 => 10
line = { particles = 100000, step = [0.1, -0.1] }\n[solver]\nmethod = "relaxation"\nreach = 1000 | - | give fewer particles, or the solver a smaller reach | 100000 => 100 ; reach = 1000 => reach = 1
)";

TEST(Refusals, OfMethodsNameRemediesThatWork) {
    test::expect_scene_messages(kOfMethods);
}

TEST(Refusals, OfLimitsNameRemediesThatWork) {
    test::expect_scene_messages(kOfLimits);
}

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
