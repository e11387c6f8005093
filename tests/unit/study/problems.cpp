#include "corda/study/problems.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "own_problems.hpp"

namespace corda::study {
namespace {

TEST(Problems, StartWhereTheirReferencesDo) {
    for (const Problem& problem : {a01_pendulum(), spinning_chain()}) {
        const System system = problem.system();
        State state{0.0, system.x_m, system.y_m};
        ASSERT_TRUE(problem.reference(0, state)) << problem.id;
        for (std::size_t i = 0; i < state.x_m.size(); ++i) {
            EXPECT_NEAR(state.x_m[i], system.x_m[i], 1e-15) << problem.id;
            EXPECT_NEAR(state.y_m[i], system.y_m[i], 1e-15) << problem.id;
        }
    }
    EXPECT_EQ(a01_pendulum().last_frame(), 4000);
}

TEST(Problems, OfR5KnowOnlyTheTipAtTheEnd) {
    const Problem problem = released_problem(reference::kReleasedChains.back());
    const std::size_t particles = problem.system().particle_count();
    State state{0.0, std::vector<double>(particles), std::vector<double>(particles)};
    EXPECT_FALSE(problem.reference(problem.last_frame() - 1, state));
    ASSERT_TRUE(problem.reference(problem.last_frame(), state));
    EXPECT_TRUE(std::isnan(state.x_m.front()));
    EXPECT_EQ(state.x_m.back(), reference::kReleasedChains.back().tip_m.x);
}

TEST(Problems, OfAScene) {
    RopeDef rope = reference::straight_rope(5, 2.0, 30.0);
    rope.reach = 7;
    Scene scene = scene_with(rope, 0.5);
    scene.video.fps = FrameRate(Rational{30, 1});
    const Problem problem = problem_of(scene);
    EXPECT_EQ(problem.id, "own_rope_1");
    EXPECT_EQ(problem.title, "Own rope-1");
    EXPECT_EQ(problem.last_frame(), 15);
    EXPECT_NEAR(problem.length_m, 2.0, 1e-15);
    EXPECT_EQ(problem.system().bars.size(), 5U);  // the truth has no imaginary bars
}

}  // namespace
}  // namespace corda::study
