#include "corda/sim/forces/elastic_forces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/defs.hpp"
#include "support/nets.hpp"
#include "support/random_ring.hpp"

namespace corda::sim {
namespace {

struct ElasticState {
    std::vector<double> x_n;
    std::vector<double> y_n;
    double square_frequency = 0.0;
};

ElasticState forces_of(const ElasticForces& elastic, const std::vector<double>& x_m,
                       const std::vector<double>& y_m) {
    ElasticState forces{std::vector<double>(x_m.size(), 0.0), std::vector<double>(x_m.size(), 0.0), 0.0};
    forces.square_frequency =
        elastic.add_forces({x_m.data(), y_m.data()}, {forces.x_n.data(), forces.y_n.data()});
    return forces;
}

TEST(ElasticForces, AreTheSlopeOfTheirEnergy) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        System system = test::random_ring(0.3, seed);
        const ElasticForces elastic(system, 0, 8);
        const ElasticState forces = forces_of(elastic, system.x_m, system.y_m);
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

// Springs are computed in chunks, each of strips of successive particles, with the roundings of one after the
// other in the order of the distances between the numbers of their ends.
TEST(ElasticForces, AreThoseOfOneSpringAfterTheOther) {
    for (const bool is_string : {false, true}) {
        NetDef net = test::leaning_net(37, 11, 0.1, true);
        for (std::size_t k = 100; k < net.bars.size(); k += 7) std::swap(net.bars[k].a, net.bars[k].b);
        net.bars.insert(net.bars.begin(), {0, 1});  // between two pins
        net.material = {1e-3, is_string};
        System system = build_system({}, {&net, 1});
        const ElasticForces elastic(system, 0, system.particle_count());
        for (std::size_t i = 0; i < system.particle_count(); ++i) {
            system.x_m[i] += 0.03 * std::sin(1.7 * static_cast<double>(i));
            system.y_m[i] += 0.03 * std::cos(2.9 * static_cast<double>(i));
        }
        std::vector<double> x_n(system.particle_count(), 0.0);
        std::vector<double> y_n = x_n;
        double shortest = 0.5;
        std::ranges::stable_sort(system.bars, {}, [](const Bar& bar) {
            return std::pair(std::max(bar.a, bar.b) - std::min(bar.a, bar.b), std::min(bar.a, bar.b));
        });
        for (const Bar& bar : system.bars) {
            if (system.is_pinned(bar.a) && system.is_pinned(bar.b)) continue;
            const double dx = system.x_m[bar.b] - system.x_m[bar.a];
            const double dy = system.y_m[bar.b] - system.y_m[bar.a];
            const double inverse = 1.0 / length(dx, dy);
            const double longer_m = length(dx, dy) - bar.rest_m;
            const double stretch_m = is_string ? std::max(longer_m, 0.0) : longer_m;
            const double tension_n = 1.0 / (1e-3 * bar.rest_m) * stretch_m;
            shortest = std::min(shortest, 1.0 + stretch_m / bar.rest_m);
            x_n[bar.a] += tension_n * (dx * inverse);
            y_n[bar.a] += tension_n * (dy * inverse);
            x_n[bar.b] -= tension_n * (dx * inverse);
            y_n[bar.b] -= tension_n * (dy * inverse);
        }
        const ElasticState forces = forces_of(elastic, system.x_m, system.y_m);
        EXPECT_EQ(forces.x_n, x_n);
        EXPECT_EQ(forces.y_n, y_n);
        EXPECT_EQ(shortest < 0.5, !is_string);
        EXPECT_EQ(forces.square_frequency, (1.0 / shortest - 1.0) * elastic.common_square_frequency());
    }
}

TEST(ElasticForces, NeitherPushNorTurnABodyAsAWhole) {
    const System system = test::random_ring(0.3, 7);
    const ElasticState forces = forces_of(ElasticForces(system, 0, 8), system.x_m, system.y_m);
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
        const ElasticState after = forces_of(elastic, moved.x_m, moved.y_m);
        axis = here_m - kMove;
        const ElasticState before = forces_of(elastic, moved.x_m, moved.y_m);
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
    for (unsigned seed = 1; seed <= 5; ++seed)
        expect_bound(test::random_ring(0.5, seed), 0.05, "random ring");
}

TEST(ElasticForces, BoundTheFrequencyOfAStraightRopeClosely) {
    for (const bool bends : {false, true}) {
        RopeDef rope = reference::straight_rope(20, 2.0, 90.0);
        rope.material.compliance_1_n = bends ? 1e9 : 1e-3;
        rope.bending_n_m2 = bends ? 5.0 : 0.0;
        expect_bound(build_system({&rope, 1}), 0.95, bends ? "straight rope that bends" : "straight rope");
    }
}

TEST(ElasticForces, OfOneMassOnASpringBoundItsFrequencyExactly) {
    RopeDef rope = reference::straight_rope(1, 0.5, 0.0);
    rope.mass_kg[1] = 4.0;
    rope.material.compliance_1_n = 0.01;
    const System system = build_system({&rope, 1});
    const ElasticForces elastic(system, 0, 2);
    EXPECT_DOUBLE_EQ(forces_of(elastic, system.x_m, system.y_m).square_frequency, 1.0 / (0.01 * 0.5 * 4.0));
}

TEST(ElasticForces, AreFiniteForCoincidentEnds) {
    System system = test::random_ring(0.0, 1);
    const ElasticForces elastic(system, 0, 8);
    system.x_m[3] = system.x_m[2];
    system.y_m[3] = system.y_m[2];
    system.x_m[5] = system.x_m[4] + 1e-200;  // apart, but by less than a square can hold
    system.y_m[5] = system.y_m[4];
    const ElasticState forces = forces_of(elastic, system.x_m, system.y_m);
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_TRUE(std::isfinite(forces.x_n[i]) && std::isfinite(forces.y_n[i])) << i;
    }
    EXPECT_TRUE(std::isfinite(forces.square_frequency));
    EXPECT_TRUE(std::isfinite(elastic.energy_j(system.x_m.data(), system.y_m.data())));
}

TEST(ElasticForces, AreZeroForASlackString) {
    RopeDef rope = reference::straight_rope(3, 1.0, 30.0);
    rope.rest_m = {0.4, 0.3, 0.5};
    rope.material = {1e-3, true};
    const System system = build_system({&rope, 1});
    const ElasticForces elastic(system, 0, 4);
    const ElasticState slack = forces_of(elastic, system.x_m, system.y_m);
    // Only the link of 1/3 m whose rest length is 0.3 m pulls, by (d / l - 1) / C.
    const double tension_n = (1.0 / 3.0 / 0.3 - 1.0) / 1e-3;
    std::vector<double> tensions_n(3, 0.0);
    elastic.tensions(system.x_m.data(), system.y_m.data(), tensions_n);
    EXPECT_EQ(tensions_n[0], 0.0);
    EXPECT_NEAR(tensions_n[1], tension_n, 1e-11);
    EXPECT_EQ(tensions_n[2], 0.0);
    EXPECT_NEAR(length(slack.x_n[1], slack.y_n[1]), tension_n, 1e-11);
    EXPECT_EQ(slack.x_n[0], 0.0);
    EXPECT_EQ(slack.y_n[3], 0.0);
    EXPECT_NEAR(elastic.energy_j(system.x_m.data(), system.y_m.data()),
                0.5 * tension_n * tension_n * 1e-3 * 0.3, 1e-12);
}

/// Two free particles of 2 and 3 kg, 1 m apart, that a spring of 1/C = 500 N joins.
System spring_pair() {
    RopeDef rope;
    rope.points_m = {{0.0, 0.0}, {1.0, 0.0}};
    rope.mass_kg = {2.0, 3.0};
    rope.pinned.clear();
    rope.material.compliance_1_n = 1.0 / 500.0;
    return build_system(std::vector{rope});
}

TEST(EnergyMeter, AddsUpMotionWeightAndSprings) {
    const System system = spring_pair();
    const WorldDef world{.gravity_m_s2 = {0.0, -10.0}};
    const MethodDef method = ExactDef{};
    const State state{0.0, {0.0, 0.0}, {1.0, 3.0}, {1.0, 0.0}, {0.0, -2.0}, {}};
    const Energy energy = EnergyMeter(system, world, {&method, 1}).of(state);
    EXPECT_DOUBLE_EQ(energy.kinetic_j, 0.5 * 2.0 * 1.0 + 0.5 * 3.0 * 4.0);
    EXPECT_DOUBLE_EQ(energy.weight_j, 10.0 * (2.0 * 1.0 + 3.0 * 3.0));
    EXPECT_DOUBLE_EQ(energy.elastic_j, 0.5 * 500.0 * 1.0);  // stretched from 1 m to 2 m
    EXPECT_DOUBLE_EQ(energy.potential_j(), energy.weight_j + energy.elastic_j);
}

TEST(EnergyMeter, KnowsTheForceOfRelaxation) {
    const System system = spring_pair();
    RelaxationDef relaxation;
    relaxation.force_n = Vec2{4.0, 0.0};
    const MethodDef method = relaxation;
    const State state{0.0, {1.0, 2.0}, {5.0, 5.0}, {0.0, 0.0}, {0.0, 0.0}, {}};
    EXPECT_DOUBLE_EQ(EnergyMeter(system, WorldDef{}, {&method, 1}).of(state).weight_j, -4.0 * (1.0 + 2.0));
}

}  // namespace
}  // namespace corda::sim
