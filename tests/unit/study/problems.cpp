#include "benchmark/study/problems.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "benchmark/study/reference/numbers.hpp"
#include "corda/core/basics.hpp"
#include "own_problems.hpp"
#include "support/nets.hpp"

namespace corda::study {
namespace {

using testing::HasSubstr;

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

TEST(Truth, OfEachMethodIsMadeByAnother) {
    Subject subject;
    subject.problem = released_chain();
    find_truth(subject);
    EXPECT_THAT(facing(subject, RattleDef{}).truth, HasSubstr("exact"));
    EXPECT_THAT(facing(subject, RelaxationDef{}).truth, HasSubstr("exact"));
    EXPECT_THAT(facing(subject, ExactDef{}).truth, HasSubstr("rattle"));
    EXPECT_FALSE(subject.horizon_s.has_value());
    EXPECT_LT(subject.disagreement.value(), 1e-12);  // measured 3.6e-16
    constexpr Vec2 kTip = reference::released_tip_m(20, 45.0, 2.0);
    for (const MethodDef& method : {MethodDef(RattleDef{}), MethodDef(ExactDef{})}) {
        State state;
        ASSERT_TRUE(facing(subject, method).reference(120, state));
        // measured 9e-16 and 4e-16
        EXPECT_LT(std::hypot(state.x_m.back() - kTip.x, state.y_m.back() - kTip.y), 1e-12);
    }
}

TEST(Truth, EndsAtTheHorizonOfAChaoticMotion) {
    Subject subject;
    subject.problem = problem_of(reference::straight_rope(10, 1.0, 90.0), 6.0);
    find_truth(subject);
    ASSERT_TRUE(subject.horizon_s.has_value());
    // R5: a perturbation grows by 1e15 in 5 s, and past 2 s positions are not to be compared.
    EXPECT_GT(*subject.horizon_s, 1.5);  // measured 2.4
    EXPECT_LT(*subject.horizon_s, 4.5);
    const auto last = std::lround(60.0 * *subject.horizon_s);
    State state;
    for (const MethodDef& method : {MethodDef(RattleDef{}), MethodDef(ExactDef{})}) {
        const Problem problem = facing(subject, method);
        EXPECT_TRUE(problem.reference(last, state));
        EXPECT_FALSE(problem.reference(last + 1, state));
    }
    EXPECT_LE(subject.disagreement.value(), kHorizonDifference);
}

TEST(Truth, SaysIfOnlyOneMethodOrNoneKnowsIt) {
    Subject ring;
    ring.problem = problem_of(test::stiff_ring(8), 0.2);
    find_truth(ring);
    EXPECT_THAT(facing(ring, RattleDef{}).truth, HasSubstr("run of itself"));
    EXPECT_TRUE(ring.problem.reference);

    Subject cloth;
    cloth.problem.id = "cloth";
    NetDef rod;  // in line: its second bars imply more than equations of the first order know
    rod.points_m = {{0.0, 0.0}, {1.0, -1.0}, {2.0, -2.0}, {3.0, -1.5}, {4.0, -1.0}};
    rod.bars = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {0, 2, false}};
    rod.pinned = {0, 4};  // a closed linkage, which exact does not know
    cloth.problem.nets = {rod};
    cloth.problem.world.duration_s = 0.1;
    find_truth(cloth);
    EXPECT_THAT(cloth.problem.truth, HasSubstr("none"));
    EXPECT_FALSE(cloth.problem.reference);
}

TEST(Truth, RefusesWhatNoMethodCanRun) {
    RopeDef rope = reference::straight_rope(3, 1.0, 0.0);
    rope.closed = true;
    rope.material.is_string = true;
    Subject subject;
    subject.problem = problem_of(rope, 0.1);
    EXPECT_THROW(find_truth(subject), Error);
}

}  // namespace
}  // namespace corda::study
