// [[solver.bodies]]: which method moves which body.
#include "unit/scene/support.hpp"

namespace corda::scene {
namespace {

using testing::ElementsAre;

/// A scene of two ropes and a net; line 9 is the first of the first [[solver.bodies]].
std::string three_bodies_with(const std::string& keys) {
    const std::string rope = "[[rope]]\nline = { particles = 3, step = [0, -1] }\n";
    return "schema = 1\n" + rope + rope +
           "[[net]]\ngrid = { columns = 3, rows = 2, spacing = 0.5 }\n[[solver.bodies]]\n" + keys;
}

TEST(SolversOfBodies, AreThoseThatNameThem) {
    const std::string rope = "[[rope]]\nline = { particles = 3, step = [0, -1] }\n";
    const std::string net = "[[net]]\ngrid = { columns = 3, rows = 2, spacing = 0.5 }\n";
    const Scene scene = parse_scene("schema = 1\n" + rope + net + rope + rope + net +
                                        "[solver]\nmethod = \"exact\"\ntolerance = 1e-7\n"
                                        "[[solver.bodies]]\nropes = [-1, 0]\nnets = [1]\n"
                                        "method = \"relaxation\"\nreach = 2\nsweeps = 3\n"
                                        "[[solver.bodies]]\nnets = [0]\nmethod = \"rattle\"\norder = 8\n"
                                        "step = 0.004\n",
                                    "a");
    ASSERT_EQ(scene.body_solvers.size(), 2U);
    EXPECT_THAT(scene.body_solvers[0].ropes, ElementsAre(2U, 0U));
    EXPECT_THAT(scene.body_solvers[0].nets, ElementsAre(1U));
    EXPECT_TRUE(scene.body_solvers[1].ropes.empty());
    EXPECT_EQ(std::get<RattleDef>(scene.body_solvers[1].method).step_s, 0.004);
    EXPECT_EQ(scene.ropes[0].reach, 2);
    EXPECT_EQ(scene.ropes[1].reach, 1);
    EXPECT_EQ(scene.ropes[2].reach, 2);
    const std::vector<SolverDef> solvers = solvers_of(scene);
    ASSERT_EQ(solvers.size(), 5U);  // three ropes, then two nets
    EXPECT_EQ(std::get<RelaxationDef>(solvers[0]).sweeps, 3);
    EXPECT_EQ(std::get<ExactDef>(solvers[1]).tolerance, 1e-7);
    EXPECT_EQ(solver_name(solvers[2]), "relaxation");
    EXPECT_EQ(std::get<RattleDef>(solvers[3]).order, 8);
    EXPECT_EQ(solver_name(solvers[4]), "relaxation");
}

TEST(SolversOfBodies, HaveTheDefaultsOfTheSolver) {
    const auto group = [](const std::string& method) {
        return parse_scene(with("solver.bodies = [{ ropes = [0], method = \"" + method + "\" }]"), "a");
    };
    EXPECT_EQ(solver_name(group("exact").solver), "auto");
    EXPECT_EQ(std::get<ExactDef>(group("exact").body_solvers[0].method).tolerance, ExactDef{}.tolerance);
    EXPECT_EQ(std::get<RattleDef>(group("rattle").body_solvers[0].method).order, 4);
    EXPECT_EQ(group("exact").ropes[0].reach, 1);
    EXPECT_EQ(group("relaxation").ropes[0].reach, 7);
}

TEST(SolversOfBodies, AloneGiveARopeItsReach) {
    const Scene scene = parse_scene(with("[solver]\nmethod = \"relaxation\"\nreach = 3\n[[solver.bodies]]\n"
                                         "ropes = [0]\nmethod = \"exact\"\n"),
                                    "a");
    EXPECT_EQ(scene.ropes[0].reach, 1);
}

TEST(SolversOfBodies, DoNotRepeatTheProblemsOfTheBodies) {
    const std::string solver = "[[solver.bodies]]\nropes = [0]\nmethod = \"exact\"\n";
    EXPECT_EQ(error_of("schema = 1\n[[rop]]\nmass = 1\n" + solver).message,
              "swing.toml:2:3: rop: unknown key \"rop\"; did you mean \"rope\"?");
    EXPECT_EQ(error_of("schema = 1\nrope = []\n" + solver).message,
              "swing.toml:2:8: rope: the list is empty; give one or more [[rope]]");
    EXPECT_EQ(error_of(three_bodies_with("rops = [0]\nmethod = \"exact\"")).message,
              "swing.toml:9:1: solver.bodies[0].rops: unknown key \"rops\"; did you mean \"ropes\"?");
}

TEST(SolversOfBodies, OfASceneFilledInCodeAreChecked) {
    Scene scene = parse_scene(three_bodies_with("ropes = [0]\nmethod = \"exact\""), "a");
    const auto message = [&](const std::vector<BodySolverDef>& groups) -> std::string {
        scene.body_solvers = groups;
        try {
            static_cast<void>(solvers_of(scene));
            return "no error";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::kInvalidScene);
            return error.what();
        }
    };
    EXPECT_EQ(message({{{0}, {0}, {}}, {{1}, {}, {}}}), "no error");
    EXPECT_EQ(message({{{2}, {}, {}}}), "body_solvers[0]: names rope 2 of 2");
    EXPECT_EQ(message({{{}, {4294967295}, {}}}), "body_solvers[0]: names net 4294967295 of 1");
    EXPECT_EQ(message({{{1, 1}, {}, {}}}), "body_solvers[0]: names rope 1, which has a method");
    EXPECT_EQ(message({{{1}, {0}, {}}, {{0}, {0}, {}}}), "body_solvers[1]: names net 0, which has a method");
    EXPECT_EQ(message({{{0}, {}, {}}, {}}), "body_solvers[1]: names neither a rope nor a net");
}

}  // namespace
}  // namespace corda::scene
