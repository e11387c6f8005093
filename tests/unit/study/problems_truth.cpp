#include "corda/study/problems.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "corda/core/basics.hpp"
#include "corda/reference/numbers.hpp"
#include "own_problems.hpp"
#include "support/nets.hpp"

namespace corda::study {
namespace {

using testing::HasSubstr;

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
    subject.problem = problem_with(reference::straight_rope(10, 1.0, 90.0), 6.0);
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
    ring.problem = problem_with(test::ring(8), 0.2);
    find_truth(ring);
    EXPECT_THAT(facing(ring, RattleDef{}).truth, HasSubstr("run of itself"));
    EXPECT_TRUE(ring.problem.reference);

    Subject cloth;
    cloth.problem.id = "cloth";
    NetDef rod;  // in line: its second bars imply more than equations of the first order know
    rod.points_m = {{0.0, 0.0}, {1.0, -1.0}, {2.0, -2.0}};
    rod.bars = {{0, 1}, {1, 2}, {0, 2, false}};
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
    subject.problem = problem_with(rope, 0.1);
    EXPECT_THROW(find_truth(subject), Error);
}

}  // namespace
}  // namespace corda::study
