// What stretches and what bends: the forces themselves, what the methods refuse, and bodies of several kinds
// in one scene.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "corda/sim/elastic_forces.hpp"
#include "corda/sim/trial.hpp"
#include "corda/study/ropes.hpp"
#include "support/nets.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

/// A closed rope of 8 links that stretches and bends, its particles moved about at random, one pinned.
System random_ring(double largest_move_m, unsigned seed) {
    RopeDef rope;
    for (int i = 0; i < 8; ++i) rope.points_m.push_back({std::cos(0.8 * i), std::sin(0.8 * i)});
    rope.mass_kg = {1.0, 2.0, 0.5, 1.0, 3.0, 1.0, 0.2, 1.0};
    rope.velocity_m_s.assign(8, {});
    rope.closed = true;
    rope.material.compliance_1_n = 0.01;
    rope.bending_n_m2 = 3.0;
    System system = build_system({&rope, 1}, 1);
    std::mt19937 random(seed);
    const auto draw = [&] { return largest_move_m * (static_cast<double>(random() % 2001) / 1000.0 - 1.0); };
    for (std::size_t i = 0; i < 8; ++i) {
        system.x_m[i] += draw();
        system.y_m[i] += draw();
    }
    return system;
}

struct Forces {
    std::vector<double> x_n;
    std::vector<double> y_n;
    double square_frequency = 0.0;
};

Forces forces_of(const ElasticForces& elastic, const std::vector<double>& x_m,
                 const std::vector<double>& y_m) {
    Forces forces{std::vector<double>(x_m.size(), 0.0), std::vector<double>(x_m.size(), 0.0), 0.0};
    forces.square_frequency =
        elastic.add_forces(x_m.data(), y_m.data(), forces.x_n.data(), forces.y_n.data());
    return forces;
}

TEST(ElasticForces, AreTheSlopeOfTheirEnergy) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        System system = random_ring(0.3, seed);
        const ElasticForces elastic(system, 0, 8);
        const Forces forces = forces_of(elastic, system.x_m, system.y_m);
        constexpr double kMove = 1e-5;
        for (std::vector<double>* axis : {&system.x_m, &system.y_m}) {
            const std::vector<double>& force_n = axis == &system.x_m ? forces.x_n : forces.y_n;
            for (std::size_t i = 0; i < 8; ++i) {
                const double here_m = (*axis)[i];
                (*axis)[i] = here_m + kMove;
                const double after_j = elastic.energy_j(system.x_m.data(), system.y_m.data());
                (*axis)[i] = here_m - kMove;
                const double before_j = elastic.energy_j(system.x_m.data(), system.y_m.data());
                (*axis)[i] = here_m;
                // measured: 2e-8 of forces of about 30 N
                EXPECT_NEAR(force_n[i], (before_j - after_j) / (2.0 * kMove), 1e-6) << seed << " " << i;
            }
        }
    }
}

TEST(ElasticForces, NeitherPushNorTurnABodyAsAWhole) {
    const System system = random_ring(0.3, 7);
    const Forces forces = forces_of(ElasticForces(system, 0, 8), system.x_m, system.y_m);
    double x_n = 0.0;
    double y_n = 0.0;
    double turn_n_m = 0.0;
    for (std::size_t i = 0; i < 8; ++i) {
        x_n += forces.x_n[i];
        y_n += forces.y_n[i];
        turn_n_m += system.x_m[i] * forces.y_n[i] - system.y_m[i] * forces.x_n[i];
    }
    EXPECT_NEAR(x_n, 0.0, 1e-13);
    EXPECT_NEAR(y_n, 0.0, 1e-13);
    EXPECT_NEAR(turn_n_m, 0.0, 1e-13);
}

/// The square of the largest frequency of small motions, by the slopes of the forces and power iteration.
double largest_square_frequency(const System& system, const ElasticForces& elastic) {
    const std::size_t count = system.particle_count();
    std::vector<std::vector<double>> slopes;
    constexpr double kMove = 1e-6;
    for (std::size_t j = 0; j < 2 * count; ++j) {
        System moved = system;
        double& axis = j < count ? moved.x_m[j] : moved.y_m[j - count];
        const double here_m = axis;
        axis = here_m + kMove;
        const Forces after = forces_of(elastic, moved.x_m, moved.y_m);
        axis = here_m - kMove;
        const Forces before = forces_of(elastic, moved.x_m, moved.y_m);
        std::vector<double>& slope = slopes.emplace_back();
        for (std::size_t i = 0; i < count; ++i) slope.push_back((after.x_n[i] - before.x_n[i]) / kMove / 2.0);
        for (std::size_t i = 0; i < count; ++i) slope.push_back((after.y_n[i] - before.y_n[i]) / kMove / 2.0);
    }
    std::vector<double> shape(2 * count, 0.0);
    for (std::size_t i = 0; i < 2 * count; ++i) shape[i] = std::sin(1.7 * static_cast<double>(i) + 1.0);
    double square = 0.0;
    for (int k = 0; k < 5000; ++k) {
        std::vector<double> next(2 * count, 0.0);
        double norm = 0.0;
        for (std::size_t i = 0; i < 2 * count; ++i) {
            for (std::size_t j = 0; j < 2 * count; ++j) next[i] -= slopes[j][i] * shape[j];
            next[i] *= system.inverse_mass_1_kg[i % count];
            norm = std::max(norm, std::abs(next[i]));
        }
        square = norm;
        for (std::size_t i = 0; i < 2 * count; ++i) shape[i] = next[i] / norm;
    }
    return square;
}

/// The bound has to hold, and not to be more than 1 / `least_share` times what it bounds.
void expect_bound(const System& system, double least_share, const char* name) {
    const ElasticForces elastic(system, 0, system.particle_count());
    const double true_square = largest_square_frequency(system, elastic);
    const double bound = forces_of(elastic, system.x_m, system.y_m).square_frequency;
    std::printf("%s: omega^2 %.4g, bound %.4g\n", name, true_square, bound);
    EXPECT_LE(true_square, bound) << name;
    EXPECT_GT(true_square, least_share * bound) << name;
}

TEST(ElasticForces, BoundTheLargestFrequency) {
    for (unsigned seed = 1; seed <= 5; ++seed) expect_bound(random_ring(0.5, seed), 0.05, "random ring");
}

TEST(ElasticForces, BoundThatOfAStraightRopeClosely) {
    for (const bool bends : {false, true}) {
        RopeDef rope = study::straight_rope(20, 2.0, 90.0);
        rope.material.compliance_1_n = bends ? 1e9 : 1e-3;
        rope.bending_n_m2 = bends ? 5.0 : 0.0;
        expect_bound(build_system({&rope, 1}, 1), 0.95, bends ? "straight rope that bends" : "straight rope");
    }
}

TEST(ElasticForces, OfOneMassOnASpringBoundItsFrequencyExactly) {
    RopeDef rope = study::straight_rope(1, 0.5, 0.0);
    rope.mass_kg[1] = 4.0;
    rope.material.compliance_1_n = 0.01;
    const System system = build_system({&rope, 1}, 1);
    const ElasticForces elastic(system, 0, 2);
    EXPECT_DOUBLE_EQ(forces_of(elastic, system.x_m, system.y_m).square_frequency, 1.0 / (0.01 * 0.5 * 4.0));
}

TEST(ElasticForces, OfEndsInOnePlaceAreFinite) {
    System system = random_ring(0.0, 1);
    const ElasticForces elastic(system, 0, 8);
    system.x_m[3] = system.x_m[2];
    system.y_m[3] = system.y_m[2];
    system.x_m[5] = system.x_m[4] + 1e-200;  // apart, but by less than a square can hold
    system.y_m[5] = system.y_m[4];
    const Forces forces = forces_of(elastic, system.x_m, system.y_m);
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_TRUE(std::isfinite(forces.x_n[i]) && std::isfinite(forces.y_n[i])) << i;
    }
    EXPECT_TRUE(std::isfinite(forces.square_frequency));
    EXPECT_TRUE(std::isfinite(elastic.energy_j(system.x_m.data(), system.y_m.data())));
}

TEST(ElasticForces, OfASlackStringAreNone) {
    RopeDef rope = study::straight_rope(3, 1.0, 30.0);
    rope.rest_m = {0.4, 0.3, 0.5};
    rope.material = {1e-3, true};
    const System system = build_system({&rope, 1}, 1);
    const ElasticForces elastic(system, 0, 4);
    const Forces slack = forces_of(elastic, system.x_m, system.y_m);
    // The link of 1/3 m whose length at rest is 0.3 m alone pulls, by (d / l - 1) / C.
    const double tension_n = (1.0 / 3.0 / 0.3 - 1.0) / 1e-3;
    EXPECT_NEAR(elastic.largest_tension_n(system.x_m.data(), system.y_m.data()), tension_n, 1e-11);
    EXPECT_NEAR(length(slack.x_n[1], slack.y_n[1]), tension_n, 1e-11);
    EXPECT_EQ(slack.x_n[0], 0.0);
    EXPECT_EQ(slack.y_n[3], 0.0);
    EXPECT_NEAR(elastic.energy_j(system.x_m.data(), system.y_m.data()),
                0.5 * tension_n * tension_n * 1e-3 * 0.3, 1e-12);
}

/// Why a method cannot run a system; empty where it can.
std::string refusal(const System& system, const SolverDef& def) {
    return sim::refusal(system, WorldDef{}, def, 1.0 / 60.0);
}

TEST(Refusals, NameTheReasonAndTheRemedy) {
    RopeDef string = study::straight_rope(3, 1.0, 30.0);
    string.material.is_string = true;
    const System strings = build_system({&string, 1}, 1);
    EXPECT_NE(refusal(strings, rope_solver(4)).find("method exact"), std::string::npos);
    EXPECT_EQ(refusal(strings, exact_solver(1e-9)), "");

    RopeDef ring = study::straight_rope(3, 1.0, 30.0);
    ring.points_m = {{0.0, 0.0}, {1.0, 0.0}, {1.0, -1.0}, {0.0, -1.0}};
    ring.closed = true;
    const System rings = build_system({&ring, 1}, 1);
    EXPECT_NE(refusal(rings, exact_solver(1e-9)).find("method = \"rope\""), std::string::npos);
    EXPECT_EQ(refusal(rings, rope_solver(4)), "");

    NetDef net = test::cloth(3, 3, 0.1);
    EXPECT_NE(refusal(build_system({}, {&net, 1}, 1), exact_solver(1e-9)).find("compliance"),
              std::string::npos);
    net.material.compliance_1_n = 1e-3;
    EXPECT_EQ(refusal(build_system({}, {&net, 1}, 1), exact_solver(1e-9)), "");
    EXPECT_EQ(refusal(build_system({}, {&net, 1}, 1), rope_solver(4)), "");
}

TEST(ElasticRing, FallsFreelyAndReturnsToRound) {
    System ring = random_ring(0.05, 3);
    ring.inverse_mass_1_kg[0] = 1.0 / ring.mass_kg[0];
    double mass_kg = 0.0;
    double start_m = 0.0;
    for (std::size_t i = 0; i < 8; ++i) {
        mass_kg += ring.mass_kg[i];
        start_m += ring.mass_kg[i] * ring.y_m[i];
    }
    for (const SolverDef& def : {exact_solver(1e-9), rope_solver(4)}) {
        test::SolverRun run(ring, WorldDef{}, def);
        ASSERT_TRUE(run.go(1.0, 20));
        double end_m = 0.0;
        for (std::size_t i = 0; i < 8; ++i) end_m += ring.mass_kg[i] * run.state().y_m[i];
        std::printf("ring by %s: centre off by %.1e m, energy %.1e\n", method_name(def.method).data(),
                    (end_m - start_m) / mass_kg + 0.5 * 9.81, run.energy_error());
        EXPECT_NEAR((end_m - start_m) / mass_kg, -0.5 * 9.81, 1e-12);
        EXPECT_LT(run.energy_error(), 1e-6);
        EXPECT_EQ(run.solver().loads()->pin_force_n, 0.0);
    }
}

TEST(SeveralBodies, ARigidRopeMovesAsIfItWereAlone) {
    const RopeDef rigid = study::straight_rope(6, 1.0, 70.0);
    RopeDef elastic = study::straight_rope(8, 1.0, 40.0);
    elastic.origin_m = {2.0, 0.0};
    elastic.material.compliance_1_n = 1e-3;
    elastic.bending_n_m2 = 0.1;
    const std::array<RopeDef, 2> both{elastic, rigid};
    for (const SolverDef& def : {exact_solver(1e-9), rope_solver(6, 1e-3)}) {
        test::SolverRun together(build_system(both, 1), WorldDef{}, def);
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
        std::printf("%s: together and alone part by %.1e m\n", method_name(def.method).data(), largest_m);
        EXPECT_LT(largest_m, 1e-13);
        for (std::size_t i = 0; i < 9; ++i) {
            EXPECT_EQ(together.state().x_m[i], elastic_alone.state().x_m[i]) << i;
            EXPECT_EQ(together.state().y_m[i], elastic_alone.state().y_m[i]) << i;
        }
    }
}

TEST(ElasticRope, GivesTheSameBitsWhateverTimesAreAskedFor) {
    RopeDef rope = study::straight_rope(8, 1.0, 60.0);
    rope.material.compliance_1_n = 1e-3;
    rope.bending_n_m2 = 0.1;
    WorldDef world;
    world.drag_1_s = 0.2;
    for (const SolverDef& def : {exact_solver(1e-9), rope_solver(4)}) {
        test::SolverRun direct(rope, world, def);
        test::SolverRun often(rope, world, def);
        ASSERT_TRUE(direct.go(0.777));
        ASSERT_TRUE(often.go(0.777, 50));
        (void)often.solver().loads();
        EXPECT_EQ(direct.state().x_m, often.state().x_m);
        EXPECT_EQ(direct.state().y_m, often.state().y_m);
        EXPECT_EQ(direct.solver().energy_j(), often.solver().energy_j());
        EXPECT_FALSE(direct.solver().conserves_energy());
    }
}

TEST(ElasticRope, WithEveryParticlePinnedStays) {
    RopeDef rope = study::straight_rope(2, 1.0, 77.0);
    rope.origin_m = {0.1, 0.2};
    rope.pinned = {0, 1, 2};
    rope.material.compliance_1_n = 1e-3;
    rope.bending_n_m2 = 1.0;
    const RopeDef first = study::straight_rope(1, 1.0, 10.0);
    const std::array<RopeDef, 2> ropes{first, rope};
    for (const SolverDef& def : {exact_solver(1e-9), rope_solver(4)}) {
        test::SolverRun run(build_system(ropes, 1), WorldDef{}, def);
        ASSERT_TRUE(run.go(0.3));
        for (std::size_t i = 2; i < 5; ++i) {
            EXPECT_EQ(run.state().x_m[i], run.system().x_m[i]);
            EXPECT_EQ(run.state().y_m[i], run.system().y_m[i]);
        }
    }
}

TEST(ElasticRope, ThatStartsStraightBetweenPinsSags) {
    RopeDef rope = study::straight_rope(10, 1.0, 90.0);
    rope.pinned = {0, 10};
    rope.material.compliance_1_n = 1e-3;
    for (const SolverDef& def : {exact_solver(1e-11), rope_solver(8)}) {
        test::SolverRun run(rope, WorldDef{}, def);
        ASSERT_TRUE(run.go(0.2, 10));
        EXPECT_LT(run.state().y_m[5], -0.05);
        EXPECT_NEAR(run.state().x_m[3], 1.0 - run.state().x_m[7], 1e-11);
        EXPECT_LT(run.energy_error(), 1e-9);
    }
}

}  // namespace
}  // namespace corda::sim
