// Bodies that stretch and bend: what the methods refuse, and several kinds of bodies in one scene.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "support/nets.hpp"
#include "support/random_ring.hpp"
#include "support/refusal_of.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

using Reason = Refusal::Reason;

TEST(Refusals, NameTheReason) {
    RopeDef string = reference::straight_rope(3, 1.0, 30.0);
    string.material.is_string = true;
    const System strings = build_system({&string, 1});
    EXPECT_EQ(test::refusal_of(strings, RattleDef{4}), Reason::kRigidString);
    EXPECT_EQ(test::refusal_of(strings, RelaxationDef{}), Reason::kMaterial);
    EXPECT_EQ(test::refusal_of(strings, ExactDef{1e-9}), std::nullopt);

    RopeDef ring = reference::straight_rope(3, 1.0, 30.0);
    ring.points_m = {{0.0, 0.0}, {1.0, 0.0}, {1.0, -1.0}, {0.0, -1.1}};
    ring.closed = true;
    const System rings = build_system({&ring, 1});
    EXPECT_EQ(test::refusal_of(rings, ExactDef{1e-9}), std::nullopt);
    EXPECT_EQ(test::refusal_of(rings, RattleDef{4}), std::nullopt);

    NetDef net = test::cloth(3, 3, 0.1);
    net.material.compliance_1_n = 1e-3;
    EXPECT_EQ(test::refusal_of(build_system({}, {&net, 1}), ExactDef{1e-9}), std::nullopt);
    EXPECT_EQ(test::refusal_of(build_system({}, {&net, 1}), RattleDef{4}), std::nullopt);
    EXPECT_EQ(test::refusal_of(build_system({}, {&net, 1}), RelaxationDef{}), Reason::kMaterial);
}

TEST(ElasticRing, FallsFreelyAndReturnsToRound) {
    System ring = test::random_ring(0.05, 3);
    ring.inverse_mass_1_kg[0] = 1.0 / ring.mass_kg[0];
    double mass_kg = 0.0;
    double start_m = 0.0;
    for (std::size_t i = 0; i < 8; ++i) {
        mass_kg += ring.mass_kg[i];
        start_m += ring.mass_kg[i] * ring.y_m[i];
    }
    for (const MethodDef& def : std::array<MethodDef, 2>{ExactDef{1e-9}, RattleDef{4}}) {
        test::SolverRun run(ring, WorldDef{}, def);
        ASSERT_TRUE(run.go(1.0, 20));
        double end_m = 0.0;
        for (std::size_t i = 0; i < 8; ++i) end_m += ring.mass_kg[i] * run.state().y_m[i];
        std::printf("ring by %s: centre off by %.1e m, energy %.1e\n", method_name(def).data(),
                    (end_m - start_m) / mass_kg + 0.5 * 9.81, run.energy_error());
        EXPECT_NEAR((end_m - start_m) / mass_kg, -0.5 * 9.81, 1e-12);
        EXPECT_LT(run.energy_error(), 1e-6);
        EXPECT_EQ(run.loads()->pin_force_n, 0.0);
    }
}

TEST(SeveralBodies, ARigidRopeMovesAsIfItWereAlone) {
    const RopeDef rigid = reference::straight_rope(6, 1.0, 70.0);
    RopeDef elastic = reference::straight_rope(8, 1.0, 40.0);
    elastic.origin_m = {2.0, 0.0};
    elastic.material.compliance_1_n = 1e-3;
    elastic.bending_n_m2 = 0.1;
    const std::array<RopeDef, 2> both{elastic, rigid};
    for (const MethodDef& def : std::array<MethodDef, 2>{ExactDef{1e-9}, RattleDef{6, 1e-3}}) {
        test::SolverRun together(build_system(both), WorldDef{}, def);
        test::SolverRun alone(rigid, WorldDef{}, def);
        RopeDef moved = elastic;
        moved.origin_m = {};
        test::SolverRun elastic_alone(moved, WorldDef{}, def);
        ASSERT_TRUE(together.go(1.0, 3) && alone.go(1.0, 3) && elastic_alone.go(1.0, 3));
        double largest_m = 0.0;
        for (std::size_t i = 0; i < 7; ++i) {
            // The rigid one stands 2 m to the left of the system's origin.
            largest_m = std::max(largest_m, length(together.state().x_m[9 + i] + 2.0 - alone.state().x_m[i],
                                                   together.state().y_m[9 + i] - alone.state().y_m[i]));
        }
        std::printf("%s: together and alone part by %.1e m\n", method_name(def).data(), largest_m);
        EXPECT_LT(largest_m, 1e-13);
        for (std::size_t i = 0; i < 9; ++i) {
            EXPECT_EQ(together.state().x_m[i], elastic_alone.state().x_m[i]) << i;
            EXPECT_EQ(together.state().y_m[i], elastic_alone.state().y_m[i]) << i;
        }
    }
}

TEST(ElasticRope, GivesTheSameBitsForAnyRequestedTimes) {
    RopeDef rope = reference::straight_rope(8, 1.0, 60.0);
    rope.material.compliance_1_n = 1e-3;
    rope.bending_n_m2 = 0.1;
    WorldDef world;
    world.drag_1_s = 0.2;
    for (const MethodDef& def : std::array<MethodDef, 2>{ExactDef{1e-9}, RattleDef{4}}) {
        test::SolverRun direct(rope, world, def);
        test::SolverRun often(rope, world, def);
        ASSERT_TRUE(direct.go(0.777));
        ASSERT_TRUE(often.go(0.777, 50));
        (void)often.loads();
        EXPECT_EQ(direct.state().x_m, often.state().x_m);
        EXPECT_EQ(direct.state().y_m, often.state().y_m);
        EXPECT_EQ(direct.solver().energy_j(), often.solver().energy_j());
        EXPECT_FALSE(direct.solver().conserves_energy());
    }
}

TEST(ElasticRope, WithEveryParticlePinnedStays) {
    RopeDef rope = reference::straight_rope(2, 1.0, 77.0);
    rope.origin_m = {0.1, 0.2};
    rope.pinned = {0, 1, 2};
    rope.material.compliance_1_n = 1e-3;
    rope.bending_n_m2 = 1.0;
    const RopeDef first = reference::straight_rope(1, 1.0, 10.0);
    const std::array<RopeDef, 2> ropes{first, rope};
    for (const MethodDef& def : std::array<MethodDef, 2>{ExactDef{1e-9}, RattleDef{4}}) {
        test::SolverRun run(build_system(ropes), WorldDef{}, def);
        ASSERT_TRUE(run.go(0.3));
        for (std::size_t i = 2; i < 5; ++i) {
            EXPECT_EQ(run.state().x_m[i], run.system().x_m[i]);
            EXPECT_EQ(run.state().y_m[i], run.system().y_m[i]);
        }
    }
}

TEST(ElasticRope, ThatStartsStraightBetweenPinsSags) {
    RopeDef rope = reference::straight_rope(10, 1.0, 90.0);
    rope.pinned = {0, 10};
    rope.material.compliance_1_n = 1e-3;
    for (const MethodDef& def : std::array<MethodDef, 2>{ExactDef{1e-11}, RattleDef{8}}) {
        test::SolverRun run(rope, WorldDef{}, def);
        ASSERT_TRUE(run.go(0.2, 10));
        EXPECT_LT(run.state().y_m[5], -0.05);
        EXPECT_NEAR(run.state().x_m[3], 1.0 - run.state().x_m[7], 1e-11);
        EXPECT_LT(run.energy_error(), 1e-9);
    }
}

}  // namespace
}  // namespace corda::sim
