// Bars that stretch, by exact and rattle: statics and vibrations in closed form, both methods against each
// other (they share the forces, but neither equations nor steps), the rigid rope as the limit, and a bungee.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "benchmark/study/reference/numbers.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "support/gravity.hpp"
#include "support/nets.hpp"
#include "support/slope.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

using test::kGravity;

/// A rope of 1 m that hangs straight down, with a payload, at the lengths that its own weight gives it.
struct HeavyRope {
    static constexpr int kLinks = 10;
    static constexpr double kLink = 0.1;
    static constexpr double kPayload = 5.0;
    static constexpr double kCompliance = 1e-3;

    /// y of particle i: link k carries what hangs below it, (kLinks - k) masses of 1 kg and the payload.
    static double y_m(int i) {
        double y_m = 0.0;
        for (int k = 0; k < i; ++k) {
            const double tension_n = kGravity * (kLinks - k + kPayload);
            y_m -= kLink * (1.0 + kCompliance * tension_n);
        }
        return y_m;
    }
    static RopeDef rope(bool stretched) {
        RopeDef rope = reference::straight_rope(kLinks, 1.0, 0.0);
        rope.payload_kg = kPayload;
        rope.material.compliance_1_n = kCompliance;
        rope.rest_m.assign(kLinks, kLink);
        for (int i = 0; i <= kLinks; ++i)
            rope.points_m[static_cast<std::size_t>(i)] = {0.0, stretched ? y_m(i) : -kLink * i};
        return rope;
    }
    /// Largest distance of a particle from its equilibrium.
    static double error_m(const State& state) {
        double largest_m = 0.0;
        for (int i = 0; i <= kLinks; ++i) {
            const auto k = static_cast<std::size_t>(i);
            const double apart_m = length(state.x_m[k], state.y_m[k] - y_m(i));
            if (!(apart_m <= largest_m)) largest_m = apart_m;
        }
        return largest_m;
    }
};

const std::array<MethodDef, 2> kBothMethods{ExactDef{1e-9}, RattleDef{4}};

TEST(HeavyElasticRope, StaysInEquilibrium) {
    for (const MethodDef& def : kBothMethods) {
        test::SolverRun run(HeavyRope::rope(true), WorldDef{}, def);
        double largest_m = 0.0;
        for (int k = 1; k <= 100; ++k) {
            ASSERT_TRUE(run.go(0.1 * k));
            largest_m = std::max(largest_m, HeavyRope::error_m(run.state()));
        }
        const Loads loads = *run.loads();
        std::printf("%s: in equilibrium to %.1e m\n", method_name(def).data(), largest_m);
        EXPECT_LT(largest_m, 3e-13);  // measured: 4.3e-14 (exact), 1.6e-14 (rattle)
        EXPECT_NEAR(loads.largest_tension_n, kGravity * 15.0, 1e-10);
        EXPECT_NEAR(loads.pin_force_n, kGravity * 15.0, 1e-10);
    }
}

TEST(HeavyElasticRope, ComesToItsEquilibrium) {
    WorldDef world;
    world.drag_1_s = 8.0;
    for (const MethodDef& def : kBothMethods) {
        test::SolverRun run(HeavyRope::rope(false), world, def);
        ASSERT_TRUE(run.go(0.1));
        EXPECT_GT(HeavyRope::error_m(run.state()), 1e-3);
        ASSERT_TRUE(run.go(12.0));
        std::printf("%s: comes to it within %.1e m\n", method_name(def).data(),
                    HeavyRope::error_m(run.state()));
        EXPECT_LT(HeavyRope::error_m(run.state()), 1e-13);  // measured: 1.3e-14 (exact), 2.2e-15 (rattle)
    }
}

/// One mass released at the rest length of a hanging spring.
struct HangingMass {
    static constexpr double kRest = 0.7;
    static constexpr double kMass = 2.0;
    static constexpr double kCompliance = 0.01;

    static RopeDef rope() {
        RopeDef rope = reference::straight_rope(1, kRest, 0.0);
        rope.mass_kg[1] = kMass;
        rope.material.compliance_1_n = kCompliance;
        return rope;
    }
    static double omega_1_s() { return 1.0 / std::sqrt(kMass * kRest * kCompliance); }
    /// The damped vibration about the equilibrium.
    static double y_m(double time_s, double drag_1_s) {
        const double half_1_s = 0.5 * drag_1_s;
        const double omega = std::sqrt(omega_1_s() * omega_1_s() - half_1_s * half_1_s);
        const double share = std::exp(-half_1_s * time_s) *
                             (std::cos(omega * time_s) + half_1_s / omega * std::sin(omega * time_s));
        return -kRest - kMass * kGravity * kCompliance * kRest * (1.0 - share);
    }
};

TEST(MassOnASpring, SwingsWithItsPeriodInExact) {
    for (const auto& [tolerance, drag_1_s] : {std::pair{1e-6, 0.0}, {1e-9, 0.0}, {1e-12, 0.0}, {1e-9, 0.5}}) {
        WorldDef world;
        world.drag_1_s = drag_1_s;
        test::SolverRun run(HangingMass::rope(), world, ExactDef{tolerance});
        double largest_m = 0.0;
        for (int k = 1; k <= 40; ++k) {
            // Quarters of the period, with the largest velocity and with none, and a little after.
            const double time_s = 0.25 * k * 2.0 * std::numbers::pi / HangingMass::omega_1_s();
            ASSERT_TRUE(run.go(time_s));
            largest_m = std::max(largest_m, std::abs(run.tip_y() - HangingMass::y_m(time_s, drag_1_s)));
            ASSERT_TRUE(run.go(time_s + 0.01));
            largest_m =
                std::max(largest_m, std::abs(run.tip_y() - HangingMass::y_m(time_s + 0.01, drag_1_s)));
        }
        std::printf("exact at %g, drag %g: %.1e m\n", tolerance, drag_1_s, largest_m);
        // measured: 2.4e-8, 2.4e-11, 2.5e-14
        EXPECT_LT(largest_m, tolerance * HangingMass::kRest);
        EXPECT_EQ(run.tip_x(), 0.0);
    }
}

TEST(MassOnASpring, ConvergesWithItsOrderInRattle) {
    for (const auto& [order, drag_1_s] :
         {std::pair{2, 0.0}, {4, 0.0}, {6, 0.0}, {8, 0.0}, {4, 0.5}, {6, 0.5}}) {
        WorldDef world;
        world.drag_1_s = drag_1_s;
        std::vector<std::pair<double, double>> errors_m;                  // over the step
        const double first = order == 2 ? 0.2 : order == 8 ? 0.55 : 0.4;  // of omega h
        for (int halvings = 0; halvings < 3; ++halvings) {
            const double step_s = first / HangingMass::omega_1_s() * std::pow(0.5, 0.5 * halvings);
            test::SolverRun run(HangingMass::rope(), world, RattleDef{order, step_s});
            double largest_m = 0.0;
            for (int n = 1; n * step_s < 20.0; ++n) {
                ASSERT_TRUE(run.go(n * step_s));
                largest_m =
                    std::max(largest_m, std::abs(run.tip_y() - HangingMass::y_m(n * step_s, drag_1_s)));
            }
            errors_m.emplace_back(step_s, largest_m);
        }
        const double slope = test::slope(errors_m);
        std::printf("order %d, drag %g: %.2e .. %.2e m, slope %.3f\n", order, drag_1_s,
                    errors_m.front().second, errors_m.back().second, slope);
        EXPECT_NEAR(slope, order, 0.15);  // measured: 1.999, 3.985, 6.006, 8.002; 3.969, 5.988
    }
}

RopeDef swinging_rope() {
    RopeDef rope = reference::straight_rope(10, 1.0, 45.0);
    rope.material.compliance_1_n = 1e-4;
    return rope;
}

NetDef swinging_cloth() {
    NetDef net = test::cloth(6, 5, 0.1);
    net.material.compliance_1_n = 1e-3;
    net.pinned = {0};  // by one corner: it turns about it, folds and unfolds
    return net;
}

TEST(ElasticRope, MovesAlikeByExactAndRattle) {
    test::SolverRun exact(swinging_rope(), WorldDef{}, ExactDef{1e-12});
    test::SolverRun rattle(swinging_rope(), WorldDef{}, RattleDef{8});
    const double largest_m = test::largest_distance_m(exact, rattle, 20);
    std::printf("rope: exact and rattle differ by %.1e m\n", largest_m);
    EXPECT_GT(exact.moved_m(), 0.5);
    EXPECT_LT(largest_m, 1e-10);  // measured: 1.4e-11
    const Loads a = *exact.loads();
    const Loads b = *rattle.loads();
    EXPECT_NEAR(a.largest_tension_n, b.largest_tension_n, 1e-6);
    EXPECT_NEAR(a.pin_force_n, b.pin_force_n, 1e-6);
}

TEST(ElasticCloth, MovesAlikeByExactAndRattle) {
    test::SolverRun exact(swinging_cloth(), WorldDef{}, ExactDef{1e-12});
    test::SolverRun rattle(swinging_cloth(), WorldDef{}, RattleDef{8});
    const double largest_m = test::largest_distance_m(exact, rattle, 10);
    std::printf("cloth: exact and rattle differ by %.1e m, moved %.2f m\n", largest_m, exact.moved_m());
    EXPECT_GT(exact.moved_m(), 0.5);
    EXPECT_LT(largest_m, 1e-11);  // measured: 7.2e-13
}

TEST(ElasticBodies, KeepTheirEnergy) {
    for (const bool is_cloth : {false, true}) {
        const auto error = [&](const MethodDef& def) {
            test::SolverRun run = is_cloth ? test::SolverRun(swinging_cloth(), WorldDef{}, def)
                                           : test::SolverRun(swinging_rope(), WorldDef{}, def);
            EXPECT_TRUE(run.go(5.0, 300));
            return run.energy_error();
        };
        const double exact = error(ExactDef{1e-9});
        const double rope = error(RattleDef{4});
        std::printf("%s: energy of exact %.1e, of rattle %.1e\n", is_cloth ? "cloth" : "rope", exact, rope);
        EXPECT_LT(exact, 1e-11);  // measured: 1.8e-13 (rope), 1.9e-14 (cloth)
        EXPECT_LT(rope, 1e-8);    // measured: 1.3e-10, 1.3e-11
    }
}

TEST(ElasticRope, OfAllOrdersKeepsItsEnergyBetterByTheOrder) {
    double last = 1.0;
    for (const int order : {2, 4, 6, 8}) {
        test::SolverRun run(swinging_rope(), WorldDef{}, RattleDef{order});
        ASSERT_TRUE(run.go(5.0, 300));
        std::printf("order %d: energy %.1e\n", order, run.energy_error());
        EXPECT_LT(run.energy_error(), 0.1 * last);  // measured: 6.6e-7, 1.3e-10, 5.1e-13, 7.0e-15
        last = run.energy_error();
    }
}

TEST(StiffRope, ApproachesTheRigidOneInProportionToItsCompliance) {
    // R5 (src/corda/sim/README.md), N = 2, L = 2, 90 degrees, t = 1. Let go at the horizontal the links carry
    // nothing at first, so that their vibrations stay as small as the square of the compliance, and the error
    // is the stretch under the slow tensions.
    const Vec2 rigid = reference::released_tip_m(2, 90.0, 1.0);
    const auto tip = [&](double compliance_1_n, const MethodDef& def) {
        RopeDef rope = reference::straight_rope(2, 2.0, 90.0);
        rope.material.compliance_1_n = compliance_1_n;
        test::SolverRun run(rope, WorldDef{}, def);
        EXPECT_TRUE(run.go(1.0));
        return Vec2{run.tip_x(), run.tip_y()} - rigid;
    };
    for (const MethodDef& def : std::array<MethodDef, 2>{ExactDef{1e-13}, RattleDef{8}}) {
        std::vector<std::pair<double, double>> errors_m;  // over the compliance
        std::vector<Vec2> errors;
        for (const double compliance_1_n : {1e-4, 1e-5, 1e-6}) {
            errors.push_back(tip(compliance_1_n, def));
            errors_m.emplace_back(compliance_1_n, length(errors.back().x, errors.back().y));
        }
        // What is left if the two smallest are extrapolated to no compliance.
        const Vec2 left = (1.0 / 0.9) * errors[2] - (0.1 / 0.9) * errors[1];
        const double left_m = length(left.x, left.y);
        const double slope = test::slope(errors_m);
        std::printf("%s: %.2e, %.2e, %.2e m off the rigid one, slope %.4f, extended %.1e\n",
                    method_name(def).data(), errors_m[0].second, errors_m[1].second, errors_m[2].second,
                    slope, left_m);
        EXPECT_NEAR(slope, 1.0, 0.01);        // measured: 0.9998
        EXPECT_LT(errors_m[2].second, 3e-4);  // measured: 1.56e-4
        EXPECT_LT(left_m, 1e-6);              // measured: 1.3e-7
    }
}

/// A mass on a bungee of 1 m, thrown up from its equilibrium: it vibrates while the bungee is taut and
/// flies free while it is slack, and does the same on the way down.
struct Bungee {
    static constexpr double kCompliance = 0.02;
    static constexpr double kThrow = 5.0;

    static RopeDef rope() {
        RopeDef rope = reference::straight_rope(1, 1.0, 0.0);
        rope.material = {kCompliance, true};
        rope.rest_m = {1.0};
        rope.points_m[1] = {0.0, -1.0 - kGravity * kCompliance};
        rope.velocity_m_s[1] = {0.0, kThrow};
        return rope;
    }
    static double omega_1_s() { return 1.0 / std::sqrt(kCompliance); }
    /// From the throw until the bungee goes slack.
    static double rise_s() { return std::asin(kGravity * kCompliance * omega_1_s() / kThrow) / omega_1_s(); }
    static double slack_speed_m_s() { return kThrow * std::cos(omega_1_s() * rise_s()); }
    static double flight_s() { return 2.0 * slack_speed_m_s() / kGravity; }
    static double period_s() { return 2.0 * rise_s() + flight_s() + std::numbers::pi / omega_1_s(); }
    static double y_m(double time_s) {
        const double t = std::fmod(time_s, period_s());
        const auto vibrating = [](double since_s) {
            return -1.0 - kGravity * kCompliance + kThrow / omega_1_s() * std::sin(omega_1_s() * since_s);
        };
        if (t < rise_s()) return vibrating(t);
        const double flown_s = t - rise_s();
        if (flown_s < flight_s()) return -1.0 + (slack_speed_m_s() - 0.5 * kGravity * flown_s) * flown_s;
        // Through the equilibrium downwards, half a vibration after the throw.
        return vibrating(t - flight_s() - 2.0 * rise_s() + std::numbers::pi / omega_1_s());
    }
};

TEST(Bungee, FliesFreeWhileItIsSlack) {
    ASSERT_GT(Bungee::flight_s(), 0.5);
    struct Case {
        MethodDef def;
        double bound_m;
    };
    for (const Case& it : {Case{ExactDef{1e-9}, 1e-8}, Case{ExactDef{1e-12}, 1e-11},
                           Case{RattleDef{2, 1e-4}, 1e-5}, Case{RattleDef{4, 1e-3}, 1e-4}}) {
        test::SolverRun run(Bungee::rope(), WorldDef{}, it.def);
        const double top_s = Bungee::rise_s() + 0.5 * Bungee::flight_s();
        ASSERT_TRUE(run.go(top_s));
        EXPECT_EQ(run.loads()->largest_tension_n, 0.0);
        double largest_m = 0.0;
        for (int k = 1; k <= 60; ++k) {
            const double time_s = top_s + 0.05 * k;
            ASSERT_TRUE(run.go(time_s));
            largest_m = std::max(largest_m, std::abs(run.tip_y() - Bungee::y_m(time_s)));
        }
        std::printf("bungee, %s: %.1e m, energy %.1e, %llu steps\n", method_name(it.def).data(), largest_m,
                    run.energy_error(), static_cast<unsigned long long>(run.solver().steps()));
        // measured: 6.1e-10, 5.7e-13; 6.1e-7, 5.7e-6: of order 2 whatever the composition, by the force's
        // kink
        EXPECT_LT(largest_m, it.bound_m);
    }
}

}  // namespace
}  // namespace corda::sim
