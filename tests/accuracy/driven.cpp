// R12 to R16 (section 4 of src/corda/sim/README.md): ropes whose pins move and ropes in wind that changes, by
// every method and every part of `exact`.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "benchmark/study/reference/numbers.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/exact/bar_dynamics.hpp"
#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/moving_pins.hpp"
#include "corda/sim/relaxation/relaxation.hpp"
#include "support/extended_motion.hpp"
#include "support/nets.hpp"
#include "support/slope.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

/// A rope that something drives, and where its tip is.
struct Driven {
    const char* name = "";
    RopeDef rope = {};
    WorldDef world = {};
    std::vector<reference::PublishedTip> tips = {};
    bool is_late = false;  ///< errors have grown a thousandfold and more
    double pace = 1.0;     ///< of steps that show an order
    bool is_taut = false;  ///< no link is ever compressed
};

RopeDef moved(RopeDef rope, MoveDef move) {
    rope.moves = {std::move(move)};
    return rope;
}

WorldDef windy() {
    WorldDef world;
    world.drag_1_s = 0.5;
    world.wind_m_s = {4.0, 0.0};
    world.gusts = {{2.0, 0.0}, 0.4, 0.0};
    return world;
}

std::vector<Driven> driven_ropes() {
    using reference::straight_rope;
    const RopeDef circle =
        moved(straight_rope(3, 1.5, 0.0), {0, {{{0.3, 0.0}, 0.8, 0.0}, {{0.0, 0.3}, 0.8, 90.0}}, {}});
    std::vector<Driven> all(6);
    all[0] = {"R12",
              moved(straight_rope(1, 1.0, 170.0), {0, {{{0.0, 0.1}, 10.0, 90.0}}, {}}),
              {},
              {{0.5, {0.00068330922761071948, 0.99999976654422248}},
               {1.0, {-0.17364299803668037, 0.98480866630672652}},
               {5.0, {-0.17351870000599194, 0.98483057464125807}}}};
    all[1] = {"R13",
              moved(straight_rope(1, 1.0, 0.0), {0, {{{0.2, 0.0}, 0.5, 90.0}}, {}}),
              {},
              {{2.0, {-0.032239352982219884, -0.99948017695164311}},
               {5.0, {0.42400431835054468, -0.56658351841511788}},
               {10.0, {-0.23086500641575135, -0.97298579065300593}}}};
    all[1].pace = 0.2;
    all[2] = {"R14",
              moved(straight_rope(10, 1.0, 0.0), {0, {}, {{0.0, {}}, {1.0, {1.0, 0.0}}}}),
              {},
              {{0.5, {0.0043894285606834499, -0.86280166572712425}},
               {1.0, {1.1600132444504673, -0.96115214663483146}},
               {2.0, {0.52382187358514740, -0.85421995677154559}}}};
    all[2].is_taut = true;
    all[3] = {"R15",
              straight_rope(5, 1.0, 0.0),
              windy(),
              {{1.0, {0.48376263771314436, -0.87433907993797165}},
               {5.0, {0.15181273249184909, -0.98828944668557407}},
               {10.0, {0.17139149546731796, -0.98517364623568144}}}};
    all[3].pace = 0.3;
    all[3].is_taut = true;
    all[4] = {"R16", circle, {}, {{1.0, {0.23982022972711992, -1.2933674337022074}}}};
    // By extrapolation of the midpoint rule in 34 digits, with the equations of angles.
    all[5] = {"R16 at 4 s", circle, {}, {{4.0, {-0.049603040271036058, -0.56269169334844635}}}};
    all[5].is_late = true;
    return all;
}

/// The largest error of the tip at these times.
double largest_error_m(Solver& solver, const System& system, std::span<const reference::PublishedTip> tips) {
    double largest_m = 0.0;
    State state{0.0, system.x_m, system.y_m};
    for (const reference::PublishedTip& tip : tips) {
        if (solver.advance_to(tip.time_s, state) != Status::kOk) return HUGE_VAL;
        largest_m =
            std::max(largest_m, length(state.x_m.back() - tip.tip_m.x, state.y_m.back() - tip.tip_m.y));
    }
    return largest_m;
}

double error_m(const Driven& driven, const System& system, const MethodDef& method) {
    const auto solver = make_solver(system, driven.world, {&method, 1}, 1.0 / 60.0);
    return largest_error_m(*solver, system, driven.tips);
}

TEST(DrivenR12ToR16, AreExactByEveryPartOfExact) {
    for (const Driven& driven : driven_ropes()) {
        const System system = build_system({&driven.rope, 1});
        const NetDef net = test::as_net(driven.rope);
        RopeDef string = driven.rope;
        string.material.is_string = true;
        const auto by_dop853 = [&](const auto& make) {
            const auto solver = solve_in_frame_of_pins(
                system, driven.world, ExactDef{}, [&](const System& body, const Forces& there) {
                    return std::make_unique<OdePart>(body, there, make(body, there), 1e-13);
                });
            return largest_error_m(*solver, system, driven.tips);
        };
        const std::pair<const char*, double> errors[] = {
            {"Taylor series", error_m(driven, system, ExactDef{1e-13})},
            {"DOP853, links", by_dop853([](const System& body, const Forces& there) {
                 return std::make_unique<ChainDynamics>(body, body.bodies, there);
             })},
            {"DOP853, bars", by_dop853([](const System& body, const Forces& there) {
                 return std::make_unique<BarDynamics>(body, there);
             })},
            {"DOP853, groups of bars", error_m(driven, build_system({}, {&net, 1}), ExactDef{1e-13})},
            {"string", driven.is_taut ? error_m(driven, build_system({&string, 1}), ExactDef{1e-13}) : 0.0},
        };
        for (const auto& [part, error] : errors) {
            std::printf("%s by %s: %.1e m\n", driven.name, part, error);
            EXPECT_LT(error, 1e-12) << driven.name << ' ' << part;
        }
        const double implicit_m = error_m(driven, system, ExactDef{1e-9, true});
        std::printf("%s by implicit steps at 1e-9: %.1e m\n", driven.name, implicit_m);
        EXPECT_LT(implicit_m, driven.is_late ? 1e-4 : 1e-7) << driven.name;
    }
}

TEST(DrivenR12ToR16, HoldForTheTruthOfEstimates) {
    for (const Driven& driven : driven_ropes()) {
        const System system = build_system({&driven.rope, 1});
        test::ExtendedMotion truth(system, driven.world);
        for (const auto& [time_s, tip_m] : driven.tips) {
            ASSERT_TRUE(truth.advance_to(time_s)) << truth.failure();
            const std::size_t tip = system.particle_count() - 1;
            const auto error =
                static_cast<double>(std::hypot(truth.x_m(tip) - tip_m.x, truth.y_m(tip) - tip_m.y));
            std::printf("%s at %g s by the truth: %.1e m\n", driven.name, time_s, error);
            EXPECT_LT(error, 2e-13) << driven.name;  // 2.8e-14
        }
    }
}

TEST(DrivenR12ToR16, RattleAndRelaxationHaveTheirOrders) {
    for (const Driven& driven : driven_ropes()) {
        if (driven.is_late) continue;
        const System system = build_system({&driven.rope, 1});
        const auto measure = [&](const char* method, double steps_1_s, const auto& method_of) {
            std::vector<std::pair<double, double>> errors;
            for (const double share : {1.0, 1.5, 2.0}) {
                const double step_s = 1.0 / (share * steps_1_s);
                errors.emplace_back(step_s, error_m(driven, system, method_of(step_s)));
            }
            const double slope = test::slope(errors);
            std::printf("%s by %s: %.1e m at %g steps/s, slope %.2f\n", driven.name, method,
                        errors.front().second, steps_1_s, slope);
            return slope;
        };
        for (const auto& [order, steps_1_s] : {std::pair{2, 400.0}, {4, 200.0}, {6, 120.0}, {8, 80.0}}) {
            const double slope = measure("rattle", driven.pace * steps_1_s, [order = order](double step_s) {
                return RattleDef{order, step_s, 1.0};
            });
            EXPECT_NEAR(slope, order, 0.2 * order) << driven.name;
        }
        const double slope = measure("relaxation", 1000.0, [](double step_s) {
            return RelaxationDef{step_s, 64};
        });
        EXPECT_NEAR(slope, 1.0, 0.3) << driven.name;
    }
}

TEST(Wind, OfOneSpeedIsAConstantAcceleration) {
    // A pendulum in it is one in another gravity, with the same bits.
    WorldDef wind;
    wind.drag_1_s = 0.5;
    wind.wind_m_s = {3.0, 0.0};
    WorldDef gravity;
    gravity.drag_1_s = 0.5;
    gravity.gravity_m_s2 = {1.5, -9.81};
    const RopeDef rope = reference::straight_rope(7, 1.0, 50.0);
    for (const MethodDef& method :
         {MethodDef(ExactDef{}), MethodDef(ExactDef{1e-9, true}), MethodDef(RattleDef{})}) {
        test::SolverRun<> one(rope, wind, method);
        test::SolverRun<> other(rope, gravity, method);
        EXPECT_EQ(test::largest_distance_m(one, other, 20), 0.0);
    }
}

/// A particle that rests at first, in wind w and gusts a sin(o t): v' = g - c (v - w - a sin(o t)).
Vec2 place_of_free_particle_m(double t) {
    const WorldDef world = windy();
    const double c = world.drag_1_s;
    const double o = 2.0 * std::numbers::pi * world.gusts.frequency_hz;
    const double decay = std::exp(-c * t);
    // The terms of v that are constant, sines and decays, integrated.
    const Vec2 last_m_s = world.wind_m_s + (1.0 / c) * world.gravity_m_s2;
    const double scale = c / (c * c + o * o);
    const double sine = (1.0 - std::cos(o * t)) / o;
    const double cosine = std::sin(o * t) / o;
    const double gust = scale * (c * sine - o * cosine + o * (1.0 - decay) / c);
    return (t - (1.0 - decay) / c) * last_m_s + gust * world.gusts.amplitude;
}

TEST(Wind, BlowsAFreeParticleAsTheClosedForm) {
    RopeDef pair = reference::rope_through({{0.0, 0.0}, {1.0, 0.0}});
    pair.pinned = {};
    RopeDef stretching = pair;
    stretching.material.compliance_1_n = 1e-2;
    for (const RopeDef& rope : {pair, stretching}) {
        for (const auto& [method, bound] :
             {std::pair{MethodDef(ExactDef{1e-13}), 1e-12}, {MethodDef(RattleDef{8, 1.0 / 30.0}), 1e-10}}) {
            test::SolverRun<> run(rope, windy(), method);
            for (const double t : {0.3, 1.0, 4.0}) {
                ASSERT_TRUE(run.go(t));
                const Vec2 expected = place_of_free_particle_m(t);
                EXPECT_NEAR(run.tip_x() - 1.0, expected.x, bound) << t;
                EXPECT_NEAR(run.tip_y(), expected.y, bound) << t;
            }
        }
    }
}

TEST(Wind, IsNoWeight) {
    // Energies and their errors are those of gravity; the wind does work.
    const RopeDef rope = reference::straight_rope(5, 1.0, 0.0);
    test::SolverRun<> run(rope, windy(), ExactDef{});
    EXPECT_FALSE(run.solver().conserves_energy());
    EXPECT_DOUBLE_EQ(run.solver().energy_scale_j(), 9.81 * 5.0);
    ASSERT_TRUE(run.go(1.0));
    double expected_j = 0.0;
    const State state = run.state_with_velocities();
    for (std::size_t i = 0; i < 6; ++i) {
        expected_j += 9.81 * state.y_m[i];
        expected_j += 0.5 * (state.vx_m_s[i] * state.vx_m_s[i] + state.vy_m_s[i] * state.vy_m_s[i]);
    }
    EXPECT_NEAR(run.solver().energy_j(), expected_j, 1e-12);
}

TEST(Wind, LoadsThePinByItsForce) {
    // A rope that has come to rest leans until its pull balances weight and wind.
    WorldDef world;
    world.drag_1_s = 2.0;
    world.wind_m_s = {3.0, 0.0};
    const RopeDef rope = reference::straight_rope(3, 1.0, 20.0);
    for (const MethodDef& method : {MethodDef(ExactDef{}), MethodDef(RattleDef{})}) {
        test::SolverRun<> run(rope, world, method);
        ASSERT_TRUE(run.go(60.0));
        EXPECT_NEAR(run.loads()->pin_force_n, 3.0 * length(6.0, 9.81), 1e-6);
    }
}

TEST(MovingPin, PullsWithTheForceThatAcceleratesTheBob) {
    const Driven driven = driven_ropes()[1];
    for (const MethodDef& method : {MethodDef(ExactDef{1e-12}), MethodDef(RattleDef{8, 1.0 / 200.0})}) {
        constexpr double kStep = 1e-4;
        test::SolverRun<> run(driven.rope, driven.world, method);
        const auto velocity_at = [&](double t) {
            EXPECT_TRUE(run.go(t));
            const State state = run.state_with_velocities();
            // The pin's own velocity.
            EXPECT_NEAR(state.vx_m_s[0], -0.2 * std::numbers::pi * std::sin(std::numbers::pi * t), 1e-13);
            return Vec2{state.vx_m_s[1], state.vy_m_s[1]};
        };
        const Vec2 before = velocity_at(0.7 - kStep);
        EXPECT_TRUE(run.go(0.7));
        const double pull_n = run.loads()->pin_force_n;
        const Vec2 after = velocity_at(0.7 + kStep);
        const Vec2 force_n = (0.5 / kStep) * (after - before) - Vec2{0.0, -9.81};
        EXPECT_NEAR(pull_n, length(force_n.x, force_n.y), 1e-6);
    }
}

TEST(MovingPins, OfStringsAreWhereTheyGo) {
    RopeDef rope = reference::straight_rope(3, 1.0, 10.0);
    rope.material.is_string = true;
    rope.moves = {{0, {{{0.1, 0.05}, 1.0, 0.0}}, {}}};
    test::SolverRun<> run(rope, WorldDef{}, ExactDef{});
    for (const double t : {0.1, 0.25, 0.5, 0.75}) {
        ASSERT_TRUE(run.go(t));
        EXPECT_NEAR(run.state().x_m[0], 0.1 * std::sin(2.0 * std::numbers::pi * t), 1e-14);
        EXPECT_NEAR(run.state().y_m[0], 0.05 * std::sin(2.0 * std::numbers::pi * t), 1e-14);
    }
}

TEST(MovingPins, CarryNetsAndStretchingRopes) {
    // Both pins of a bungee and of a cloth on one way; rattle checks exact.
    const MoveDef way{0, {{{0.1, 0.05}, 1.3, 20.0}}, {{0.2, {}}, {0.9, {0.3, 0.1}}}};
    NetDef net;
    for (int i = 0; i < 9; ++i) net.points_m.push_back({0.3 * (i % 3) + 0.02 * (i / 3), -0.3 * (i / 3)});
    for (std::uint32_t i = 0; i < 9; ++i) {
        if (i % 3 < 2) net.bars.push_back({i, i + 1});
        if (i < 6) net.bars.push_back({i, i + 3});
    }
    net.pinned = {0};
    net.moves = {way};
    NetDef cloth = net;
    cloth.material.compliance_1_n = 1e-3;
    cloth.pinned = {0, 2};
    cloth.moves = {way, way};
    cloth.moves.back().pin = 2;
    for (const NetDef& moving : {net, cloth}) {
        test::SolverRun<> exact(moving, WorldDef{}, ExactDef{1e-12});
        test::SolverRun<> rattle(moving, WorldDef{}, RattleDef{8, 1.0 / 1000.0});
        EXPECT_LT(test::largest_distance_m(exact, rattle, 12), 1e-8);
        EXPECT_NEAR(exact.state().x_m[0],
                    0.3 + 0.1 * (std::sin(2.0 * std::numbers::pi * 1.3 * 1.2 + std::numbers::pi / 9.0) -
                                 std::sin(std::numbers::pi / 9.0)),
                    1e-12);
    }
}

TEST(MovingPin, HoldsAPendulumOnItsHeadFromASpeedOn) {
    // From 5 degrees: at rest on average if (a w)^2 > 2 g L, until 2 g L / (a w)^2 is the cosine of its
    // angle.
    constexpr double kAmplitude = 0.02;
    const auto least_height_m = [](double ratio, const MethodDef& method) {
        const double frequency_hz = ratio * std::sqrt(2.0 * 9.81) / kAmplitude / (2.0 * std::numbers::pi);
        test::SolverRun<> run(moved(reference::straight_rope(1, 1.0, 175.0),
                                    {0, {{{0.0, kAmplitude}, frequency_hz, 90.0}}, {}}),
                              WorldDef{}, method);
        double lowest_m = 1.0;
        for (int k = 1; k <= 500; ++k) {
            EXPECT_TRUE(run.go(0.01 * k));
            lowest_m = std::min(lowest_m, run.tip_y() - run.state().y_m[0]);
        }
        return lowest_m;
    };
    for (const MethodDef& method :
         {MethodDef(ExactDef{}), MethodDef(ExactDef{1e-9, true}), MethodDef(RattleDef{4, 1.0 / 2000.0}),
          MethodDef(RelaxationDef{1.0 / 8000.0, 64})}) {
        EXPECT_LT(least_height_m(0.9, method), -0.9);
        EXPECT_GT(least_height_m(1.1, method), 0.98);
    }
}

TEST(MovingPin, DrivesASmallSwingAsTheLinearOscillator) {
    // x'' + c x' + w0^2 (x - a sin(w t)) = 0 has the amplitude w0^2 a / sqrt((w0^2 - w^2)^2 + (c w)^2).
    constexpr double kAmplitude = 1e-4;
    WorldDef world;
    world.drag_1_s = 0.2;
    const double own_1_s = std::sqrt(9.81);
    for (const double ratio : {0.8, 1.0, 1.25}) {
        const double drive_1_s = ratio * own_1_s;
        for (const MethodDef& method : {MethodDef(ExactDef{1e-12}), MethodDef(RattleDef{4, 1.0 / 200.0})}) {
            test::SolverRun<> run(
                moved(reference::straight_rope(1, 1.0, 0.0),
                      {0, {{{kAmplitude, 0.0}, drive_1_s / (2.0 * std::numbers::pi), 0.0}}, {}}),
                world, method);
            ASSERT_TRUE(run.go(150.0));  // what was at the start has decayed to 3e-7
            const State at = run.state_with_velocities();
            const double squares = own_1_s * own_1_s - drive_1_s * drive_1_s;
            const double expected_m = own_1_s * own_1_s * kAmplitude / length(squares, 0.2 * drive_1_s);
            const double found_m = length(at.x_m[1], at.vx_m_s[1] / drive_1_s);
            std::printf("resonance at %g: %.2e of the amplitude\n", ratio, found_m / expected_m - 1.0);
            EXPECT_NEAR(found_m, expected_m, 5e-6 * expected_m);  // 9e-7
        }
    }
}

/// The same by a solver that prescribes the places of pins itself.
template <class Made>
double error_with_prescribed_pins_m(const Driven& driven, const Made& make) {
    const System system = build_system({&driven.rope, 1});
    const auto solver = make(system);
    return largest_error_m(*solver, system, driven.tips);
}

TEST(PrescribedPins, AreTheMovingFrame) {
    for (const Driven& driven : driven_ropes()) {
        if (driven.is_late) continue;
        const double rattle_m = error_with_prescribed_pins_m(driven, [&](const System& system) {
            return std::make_unique<Rattle>(system, driven.world, RattleDef{8, 1.0 / 480.0}, 1.0);
        });
        std::vector<std::pair<double, double>> errors;
        for (const double step_s : {1e-3, 0.5e-3, 0.25e-3}) {
            errors.emplace_back(
                step_s, error_with_prescribed_pins_m(driven, [&](const System& system) {
                    return std::make_unique<Relaxation>(system, driven.world, RelaxationDef{step_s, 64}, 1.0);
                }));
        }
        std::printf("%s with prescribed pins by rattle: %.1e m, by relaxation %.1e m\n", driven.name,
                    rattle_m, errors.back().second);
        EXPECT_LT(rattle_m, 1e-11) << driven.name;
        EXPECT_NEAR(test::slope(errors), 1.0, 0.35) << driven.name;
    }
}

TEST(PrescribedPins, OfARattleHaveItsTensionsAndVelocities) {
    const Driven driven = driven_ropes()[4];
    const System system = build_system({&driven.rope, 1});
    Rattle rattle(system, driven.world, RattleDef{8, 1.0 / 480.0}, 1.0);
    test::SolverRun<> exact(driven.rope, driven.world, ExactDef{1e-12});
    State state{0.0, system.x_m, system.y_m, system.vx_m_s, system.vy_m_s};
    State expected = state;
    std::vector<double> tension_n(3);
    std::vector<double> expected_n(3);
    for (const double t : {0.0, 0.4, 1.1}) {
        ASSERT_EQ(rattle.advance_to(t, state), Status::kOk);
        ASSERT_TRUE(exact.go(t));
        rattle.velocities(state);
        exact.solver().velocities(expected);
        ASSERT_TRUE(rattle.tensions(tension_n) && exact.solver().tensions(expected_n));
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(state.vx_m_s[i], expected.vx_m_s[i], 1e-8);
            EXPECT_NEAR(state.vy_m_s[i], expected.vy_m_s[i], 1e-8);
        }
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(tension_n[k], expected_n[k], 1e-6);
    }
}

TEST(MovingPins, ThatDifferMoveWhatStretches) {
    RopeDef rope = reference::slack_rope(6);
    rope.material.compliance_1_n = 1e-3;
    rope.moves = {{0, {{{0.1, 0.05}, 1.3, 20.0}}, {}}, {6, {}, {{0.2, {}}, {0.9, {0.2, 0.1}}}}};
    test::SolverRun<> exact(rope, WorldDef{}, ExactDef{1e-12});
    test::SolverRun<> rattle(rope, WorldDef{}, RattleDef{8, 1.0 / 2000.0});
    EXPECT_LT(test::largest_distance_m(exact, rattle, 12), 1e-8);
    EXPECT_NEAR(exact.tip_x(), rope.points_m.back().x + 0.2, 1e-12);
}

TEST(MovingPins, ThatDifferMoveARigidRope) {
    RopeDef rope = reference::slack_rope(6);
    rope.moves = {{0, {{{0.1, 0.05}, 1.3, 20.0}}, {}}, {6, {}, {{0.2, {}}, {0.9, {0.2, 0.1}}}}};
    test::SolverRun<> fine(rope, WorldDef{}, RattleDef{8, 1.0 / 2000.0});
    test::SolverRun<> other(rope, WorldDef{}, RattleDef{4, 1.0 / 4000.0});
    EXPECT_LT(test::largest_distance_m(fine, other, 10), 1e-7);
    EXPECT_LT(fine.strain(), 1e-12);
}

}  // namespace
}  // namespace corda::sim
