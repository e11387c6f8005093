#include "corda/sim/phases.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/events.hpp"
#include "corda/sim/exact/string/part.hpp"
#include "corda/sim/forces/elastic_forces.hpp"
#include "support/solver_run.hpp"

namespace corda::sim {
namespace {

using testing::ElementsAre;

constexpr double kEvent = 0.37;

const std::vector<MethodDef>& all_methods() {
    static const std::vector<MethodDef> methods{ExactDef{1e-10}, ExactDef{1e-6, true},
                                                RattleDef{4, 1.0 / 200.0}, RelaxationDef{1.0 / 500.0, 8}};
    return methods;
}

RopeDef swinging() {
    return reference::straight_rope(6, 1.0, 65.0);
}

/// With velocities.
State full_state(test::SolverRun<>& run, double time_s) {
    EXPECT_TRUE(run.go(time_s));
    return run.state_with_velocities();
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

/// Of positions in m and velocities in m/s.
double largest_difference(const State& a, const State& b) {
    return std::max({largest_difference(a.x_m, b.x_m), largest_difference(a.y_m, b.y_m),
                     largest_difference(a.vx_m_s, b.vx_m_s), largest_difference(a.vy_m_s, b.vy_m_s)});
}

TEST(Phases, BeginWithTheStateOfTheRopeBefore) {
    RopeDef released = swinging();
    released.releases = {{0, kEvent}};
    RopeDef cut = swinging();
    cut.cuts = {{2, kEvent}};
    for (const MethodDef& method : all_methods()) {
        test::SolverRun<> whole(swinging(), WorldDef{}, method);
        const State expected = full_state(whole, kEvent);
        // Steps that are chosen end there, and differ; all others agree but for a projection.
        const double bound = std::holds_alternative<ExactDef>(method) ? 1e-6 : 1e-15;
        for (const RopeDef& rope : {released, cut}) {
            test::SolverRun<> run(rope, WorldDef{}, method);
            EXPECT_LE(largest_difference(full_state(run, kEvent), expected), bound) << method_text(method);
        }
    }
}

TEST(Phases, AreExactAtTheEvent) {
    // A tolerance at the limit of rounding: dense output within a step is not this good.
    test::SolverRun<> whole(swinging(), WorldDef{}, ExactDef{1e-14});
    RopeDef released = swinging();
    released.releases = {{0, kEvent}};
    test::SolverRun<> run(released, WorldDef{}, ExactDef{1e-14});
    EXPECT_LT(largest_difference(full_state(run, kEvent), full_state(whole, kEvent)), 1e-12);
}

TEST(Phases, ThatHaveNotBegunChangeNoBits) {
    RopeDef rope = swinging();
    rope.releases = {{0, 100.0}};
    rope.cuts = {{3, 200.0}};
    for (const MethodDef& method : all_methods()) {
        test::SolverRun<> without(swinging(), WorldDef{}, method);
        test::SolverRun<> with(rope, WorldDef{}, method);
        EXPECT_EQ(test::largest_distance_m(without, with, 12), 0.0) << method_text(method);
        EXPECT_EQ(without.solver().steps(), with.solver().steps()) << method_text(method);
    }
}

TEST(Phases, DoNotDependOnTheRequestedTimes) {
    RopeDef rope = swinging();
    rope.cuts = {{4, 0.3}, {2, 0.61}};
    rope.releases = {{0, 0.85}};
    for (const MethodDef& method : all_methods()) {
        test::SolverRun<> once(rope, WorldDef{}, method);
        const State expected = full_state(once, 1.3);
        for (const int looks : {2, 7, 60}) {
            test::SolverRun<> often(rope, WorldDef{}, method);
            ASSERT_TRUE(often.go(1.3, looks));
            EXPECT_EQ(largest_difference(full_state(often, 1.3), expected), 0.0) << method_text(method);
        }
        test::SolverRun<> at_events(rope, WorldDef{}, method);
        for (const double time_s : {0.3, 0.3, 0.61, 0.85}) ASSERT_TRUE(at_events.go(time_s));
        EXPECT_EQ(largest_difference(full_state(at_events, 1.3), expected), 0.0) << method_text(method);
    }
}

TEST(Phases, OfACutAreTwoBodiesThatStartThere) {
    RopeDef rope = swinging();
    rope.cuts = {{2, kEvent}};
    for (const MethodDef& method : {MethodDef(ExactDef{1e-13}), MethodDef(RattleDef{8, 1.0 / 240.0})}) {
        test::SolverRun<> run(rope, WorldDef{}, method);
        const State start = full_state(run, kEvent);
        RopeDef hanging;
        RopeDef falling;
        falling.pinned = {};
        for (std::size_t i = 0; i < 7; ++i) {
            RopeDef& part = i < 3 ? hanging : falling;
            part.points_m.push_back({start.x_m[i], start.y_m[i]});
            part.velocity_m_s.push_back({start.vx_m_s[i], start.vy_m_s[i]});
        }
        test::SolverRun<> one(hanging, WorldDef{}, method);
        test::SolverRun<> other(falling, WorldDef{}, method);
        for (const double time_s : {0.2, 0.8, 1.5}) {
            ASSERT_TRUE(run.go(kEvent + time_s) && one.go(time_s) && other.go(time_s));
            for (std::size_t i = 0; i < 7; ++i) {
                const State& part = i < 3 ? one.state() : other.state();
                const std::size_t k = i < 3 ? i : i - 3;
                EXPECT_NEAR(run.state().x_m[i], part.x_m[k], 2e-12) << i;
                EXPECT_NEAR(run.state().y_m[i], part.y_m[k], 2e-12) << i;
            }
        }
    }
}

TEST(Phases, KeepMomentumAndAngularMomentumOverAnEvent) {
    // Of a thrown rope, which nothing holds, before, at and after a cut; of velocities at a release.
    RopeDef rope = swinging();
    rope.pinned = {};
    rope.velocity_m_s.clear();
    for (const Vec2 point : rope.points_m) rope.velocity_m_s.push_back(Vec2{1.0, 2.0} + 3.0 * left_of(point));
    rope.cuts = {{1, kEvent}, {3, kEvent}};
    WorldDef weightless;
    weightless.gravity_m_s2 = {};
    for (const MethodDef& method : {MethodDef(ExactDef{1e-13}), MethodDef(RattleDef{8, 1.0 / 240.0})}) {
        test::SolverRun<> run(rope, weightless, method);
        const auto sums = [&](double time_s) {
            const State state = full_state(run, time_s);
            std::array<double, 3> sum{};
            for (std::size_t i = 0; i < 7; ++i) {
                const Vec2 v{state.vx_m_s[i], state.vy_m_s[i]};
                sum[0] += v.x;
                sum[1] += v.y;
                sum[2] += dot(left_of({state.x_m[i], state.y_m[i]}), v);
            }
            return sum;
        };
        const auto start = sums(0.0);
        for (const double time_s : {kEvent - 1e-9, kEvent, kEvent + 1e-9, 1.0}) {
            const auto now = sums(time_s);
            for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(now[k], start[k], 1e-12) << time_s;
        }
    }
}

TEST(Phases, OfAReleaseAloneChangeNoEnergy) {
    RopeDef rope = swinging();
    rope.releases = {{0, kEvent}};
    RopeDef moving = rope;  // its pin has a velocity then
    moving.moves = {{0, {{{0.1, 0.05}, 0.8, 20.0}}, {}}};
    for (const RopeDef& one : {rope, moving}) {
        for (const MethodDef& method : {MethodDef(ExactDef{1e-13}), MethodDef(RattleDef{8, 1.0 / 240.0})}) {
            test::SolverRun<> run(one, WorldDef{}, method);
            ASSERT_TRUE(run.go(kEvent - 1e-10));
            const double before_j = run.solver().energy_j();
            ASSERT_TRUE(run.go(kEvent));
            EXPECT_NEAR(run.solver().energy_j(), before_j, 1e-7);
            ASSERT_TRUE(run.go(2.0));
            EXPECT_NEAR(run.solver().energy_j(), before_j, 1e-7);
        }
    }
}

TEST(Phases, CountTheEnergyBetweenPinsThatAreLetGo) {
    // A stretched link between two pins, and a bend of three, that an event sets free.
    RopeDef rope = reference::rope_through({{0.0, 0.0}, {0.3, 0.0}, {0.5, -0.2}, {0.5, -0.6}});
    rope.material.compliance_1_n = 1e-3;
    rope.bending_n_m2 = 0.2;
    rope.rest_m = {0.25, 0.25, 0.4};
    rope.pinned = {0, 1, 2};
    rope.releases = {{0, kEvent}, {1, kEvent}};
    test::SolverRun<> run(rope, WorldDef{}, ExactDef{1e-13});
    ASSERT_TRUE(run.go(kEvent - 1e-10));
    const double before_j = run.solver().energy_j();
    ASSERT_TRUE(run.go(kEvent));
    EXPECT_NEAR(run.solver().energy_j(), before_j, 1e-7);
    ASSERT_TRUE(run.go(1.0));
    EXPECT_NEAR(run.solver().energy_j(), before_j, 1e-7);
}

TEST(Phases, OfTimesThatAreAlmostOneGoOn) {
    RopeDef rope = swinging();
    rope.cuts = {{1, 1e-300}, {2, 1e-17}, {3, 0.5}, {4, std::nextafter(0.5, 1.0)}};
    RopeDef together = swinging();
    together.cuts = {{1, 0.0}, {2, 0.0}, {3, 0.5}, {4, 0.5}};
    for (const MethodDef& method : {MethodDef(ExactDef{1e-12}), MethodDef(RattleDef{8, 1.0 / 240.0})}) {
        test::SolverRun<> run(rope, WorldDef{}, method);
        test::SolverRun<> other(together, WorldDef{}, method);
        EXPECT_LT(test::largest_distance_m(run, other, 12), 1e-11);
    }
}

TEST(Phases, GiveAReleasedPinTheVelocityThatItHas) {
    RopeDef rope = swinging();
    rope.moves = {{0, {{{0.1, 0.05}, 0.8, 20.0}}, {}}};
    rope.releases = {{0, kEvent}};
    const double phase = M_PI / 9.0;
    const double rate_1_s = 2.0 * M_PI * 0.8;
    const double speed = rate_1_s * std::cos(rate_1_s * kEvent + phase);
    for (const MethodDef& method : {MethodDef(ExactDef{1e-12}), MethodDef(RattleDef{8, 1.0 / 240.0})}) {
        test::SolverRun<> run(rope, WorldDef{}, method);
        const State at = full_state(run, kEvent);
        EXPECT_NEAR(at.vx_m_s[0], 0.1 * speed, 1e-12);
        EXPECT_NEAR(at.vy_m_s[0], 0.05 * speed, 1e-12);
        EXPECT_NEAR(at.x_m[0], 0.1 * (std::sin(rate_1_s * kEvent + phase) - std::sin(phase)), 1e-13);
    }
}

TEST(Phases, LetOtherPinsGoOnWithTheirMoves) {
    // In mid-piece of a path, and waves. A cut of a link that bears nothing changes nothing of the rest.
    const MoveDef way{0, {{{0.1, 0.05}, 1.3, 20.0}}, {{0.2, {}}, {0.9, {0.3, 0.1}}}};
    RopeDef rope = reference::straight_rope(4, 1.0, 20.0);
    rope.moves = {way};
    RopeDef cut = rope;
    cut.cuts = {{1, 0.5}};
    WorldDef world;
    world.drag_1_s = 0.3;
    world.gusts = {{1.0, 0.0}, 0.7, 10.0};
    for (const MethodDef& method : {MethodDef(ExactDef{1e-13}), MethodDef(RattleDef{8, 1.0 / 480.0}),
                                    MethodDef(RelaxationDef{1e-3, 1})}) {
        test::SolverRun<> whole(rope, world, method);
        test::SolverRun<> run(cut, world, method);
        for (const double time_s : {0.4, 0.5, 0.7, 0.9, 1.4, 3.0}) {
            ASSERT_TRUE(whole.go(time_s) && run.go(time_s));
            EXPECT_NEAR(run.state().x_m[0], whole.state().x_m[0], 1e-13) << time_s;
            EXPECT_NEAR(run.state().y_m[0], whole.state().y_m[0], 1e-13) << time_s;
        }
    }
    // The same rope from the event on: a scene whose wind and moves are shifted by hand.
    test::SolverRun<> exact(cut, world, ExactDef{1e-13});
    test::SolverRun<> rattle(cut, world, RattleDef{8, 1.0 / 1000.0});
    EXPECT_LT(test::largest_distance_m(exact, rattle, 20), 1e-9);
}

TEST(Phases, WithPinsThatMoveDifferentlyGoOn) {
    RopeDef rope = reference::slack_rope(6);
    rope.material.compliance_1_n = 1e-3;
    rope.moves = {{0, {{{0.1, 0.05}, 1.3, 20.0}}, {}}, {6, {}, {{0.2, {}}, {0.9, {0.2, 0.1}}}}};
    rope.cuts = {{2, 0.6}};
    test::SolverRun<> exact(rope, WorldDef{}, ExactDef{1e-12});
    test::SolverRun<> rattle(rope, WorldDef{}, RattleDef{8, 1.0 / 2000.0});
    EXPECT_LT(test::largest_distance_m(exact, rattle, 12), 1e-8);
    EXPECT_NEAR(exact.tip_x(), rope.points_m.back().x + 0.2, 1e-12);
}

TEST(Phases, KeepTautStringsTaut) {
    // Far from the origin too, where lengths are rounded. A rope of the same shape never goes slack.
    RopeDef rope = reference::straight_rope(5, 1.0, 40.0);
    rope.cuts = {{3, kEvent}};
    RopeDef string = rope;
    string.material.is_string = true;
    RopeDef far = string;
    far.origin_m = {3e3, -2e3};
    test::SolverRun<> rigid(rope, WorldDef{}, ExactDef{1e-12});
    const std::array both{RopeDef(reference::straight_rope(1, 1.0, 0.0)), far};
    test::SolverRun<> near(string, WorldDef{}, ExactDef{1e-12});
    test::SolverRun<> beside(build_system(both), WorldDef{}, ExactDef{1e-12});
    (void)beside;
    for (int k = 1; k <= 10; ++k) {
        ASSERT_TRUE(rigid.go(0.1 * k) && near.go(0.1 * k));
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(near.state().x_m[i], rigid.state().x_m[i], 1e-11);
            EXPECT_NEAR(near.state().y_m[i], rigid.state().y_m[i], 1e-11);
        }
    }
}

TEST(Phases, KeepTheLengthsThatAStringWasGiven) {
    // A check's links come taut a little later; from then on that is their length.
    RopeDef string = reference::slack_rope(3);
    string.material.is_string = true;
    string.pinned = {0};
    string.rest_m = {0.7, 0.7, 0.7};
    string.releases = {{0, 1.1}};
    const System system = build_system({&string, 1});
    constexpr double kLonger = 1e-6;
    std::vector<std::vector<double>> given;
    const auto solver = solve_in_phases(
        system, WorldDef{}, ExactDef{1e-10},
        [&](const System& part, const Forces& there, const MethodDef&, std::span<const std::size_t> bars) {
            std::vector<double> longer_m(bars.size(), 0.0);
            given.emplace_back();
            for (std::size_t j = 0; j < bars.size(); ++j) {
                given.back().push_back(part.bars[j].rest_m);
                if (part.bars[j].rest_m == 0.7) longer_m[j] = kLonger;
            }
            return std::make_unique<StringPart>(part, there, 1e-10, longer_m);
        });
    State state{0.0, system.x_m, system.y_m};
    ASSERT_EQ(solver->advance_to(2.0, state), Status::kOk);
    ASSERT_EQ(given.size(), 2U);
    EXPECT_THAT(given[0], ElementsAre(0.7, 0.7, 0.7));
    for (const double rest_m : given[1]) EXPECT_DOUBLE_EQ(rest_m, 0.7 + kLonger);
}

TEST(Phases, GiveNoTensionToWhatIsGone) {
    RopeDef rope = swinging();
    rope.cuts = {{2, kEvent}};
    RopeDef stretching = rope;
    stretching.material.compliance_1_n = 1e-3;
    for (const RopeDef& one : {rope, stretching}) {
        for (const MethodDef& method : {MethodDef(ExactDef{}), MethodDef(RattleDef{})}) {
            test::SolverRun<> run(one, WorldDef{}, method);
            std::vector<double> tension_n(6);
            ASSERT_TRUE(run.go(kEvent - 1e-6) && run.solver().tensions(tension_n));
            EXPECT_NE(tension_n[2], 0.0);
            ASSERT_TRUE(run.go(kEvent) && run.solver().tensions(tension_n));
            EXPECT_EQ(tension_n[2], 0.0);
            EXPECT_NE(tension_n[1], 0.0);
            EXPECT_NEAR(run.loads()->pin_force_n, std::abs(tension_n[0]), 1e-9);
        }
    }
    RopeDef released = swinging();
    released.releases = {{0, kEvent}};
    test::SolverRun<> run(released, WorldDef{}, ExactDef{});
    ASSERT_TRUE(run.go(kEvent - 1e-6));
    EXPECT_GT(run.loads()->pin_force_n, 1.0);
    ASSERT_TRUE(run.go(kEvent));
    EXPECT_EQ(run.loads()->pin_force_n, 0.0);
}

TEST(Phases, CountNoEnergyOfWhatIsGone) {
    RopeDef rope = swinging();
    rope.material.compliance_1_n = 1e-3;
    rope.bending_n_m2 = 0.1;
    rope.cuts = {{2, kEvent}};
    const System system = build_system({&rope, 1});
    const MethodDef method = ExactDef{};
    const EnergyMeter meter(system, WorldDef{}, {&method, 1});
    State state{kEvent, system.x_m, system.y_m, system.vx_m_s, system.vy_m_s};
    state.x_m[3] += 0.01;  // beyond the cut, so that link 2 and the bends at its ends have energy
    const double after_j = meter.of(state).elastic_j;
    state.time_s = 0.0;
    EXPECT_GT(meter.of(state).elastic_j, after_j);
    state.x_m[3] = system.x_m[3];
    for (std::size_t i = 3; i < 7; ++i) state.x_m[i] += 5.0;
    state.time_s = kEvent;
    EXPECT_NEAR(meter.of(state).elastic_j, 0.0, 1e-12);
}

TEST(Phases, OfEventsAtTheStartAreThereAtOnce) {
    RopeDef rope = swinging();
    rope.cuts = {{5, 0.0}};
    rope.releases = {{0, 0.0}};
    for (const MethodDef& method : all_methods()) {
        test::SolverRun<> run(rope, WorldDef{}, method);
        ASSERT_TRUE(run.go(0.5));
        EXPECT_NEAR(run.tip_y(), swinging().points_m.back().y - 0.125 * 9.81,
                    std::holds_alternative<RelaxationDef>(method) ? 0.01 : 1e-13)
            << method_text(method);
        EXPECT_NEAR(run.tip_x(), swinging().points_m.back().x, 1e-13);
        EXPECT_NEAR(run.state().y_m[0], run.tip_y() - swinging().points_m.back().y, 1e-12);
    }
}

TEST(Phases, OfOneTimeAreOne) {
    RopeDef rope = swinging();
    rope.cuts = {{1, kEvent}, {4, kEvent}};
    rope.releases = {{0, kEvent}};
    EXPECT_THAT(event_times_s(build_system({&rope, 1})), ElementsAre(kEvent));
}

TEST(Phases, FillInTheMethodsSteps) {
    RopeDef rope = swinging();
    rope.payload_kg = 100.0;
    rope.cuts = {{5, 0.5}};
    const MethodDef rattle = RattleDef{};
    const System system = build_system({&rope, 1});
    const auto solver = make_solver(system, WorldDef{}, {&rattle, 1}, 1.0 / 60.0);
    const std::vector<MethodDef> methods = solver->methods();
    ASSERT_TRUE(fixed_step_s(methods.front()));
    test::SolverRun<> by_default(rope, WorldDef{}, rattle);
    test::SolverRun<> again(rope, WorldDef{}, methods.front());
    EXPECT_EQ(test::largest_distance_m(by_default, again, 12), 0.0);
}

TEST(Phases, MoveSeveralBodiesEachWithItsOwn) {
    RopeDef cut = swinging();
    cut.cuts = {{2, 0.2}};
    RopeDef released = swinging();
    released.releases = {{0, 0.4}};
    const std::array ropes{swinging(), cut, released};
    for (const MethodDef& method : all_methods()) {
        test::SolverRun<> all(build_system(ropes), WorldDef{}, method);
        ASSERT_TRUE(all.go(0.9));
        for (std::size_t b = 0; b < ropes.size(); ++b) {
            test::SolverRun<> alone(ropes[b], WorldDef{}, method);
            ASSERT_TRUE(alone.go(0.9));
            for (std::size_t i = 0; i < 7; ++i) {
                EXPECT_EQ(all.state().x_m[7 * b + i], alone.state().x_m[i]) << method_text(method) << b;
            }
        }
    }
}

TEST(Phases, OfAnIncompleteMotionNameTheTimeOfARefusal) {
    // A string of which the event leaves a straight row between two pins.
    NetDef net;
    net.points_m = {{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}, {1.0, -1.0}, {1.0, 1.0}};
    net.bars = {{0, 1}, {1, 2}, {1, 3}, {3, 4}, {0, 4}};
    net.pinned = {0, 2};
    net.cuts = {{2, 0.2}};
    test::SolverRun<> run(net, WorldDef{}, ExactDef{1e-9});
    // The row holds; what hung from it goes on.
    ASSERT_TRUE(run.go(1.0));
    EXPECT_NEAR(run.state().y_m[1], 0.0, 1e-9);
    const auto refused = [](const System&, const Forces& forces, const MethodDef&,
                            std::span<const std::size_t>) -> std::unique_ptr<Solver> {
        if (forces.next_key_s(0.0) < HUGE_VAL) {
            static RopeDef rope = reference::straight_rope(6, 1.0, 65.0);
            static const System system = build_system({&rope, 1});
            const MethodDef exact = ExactDef{};
            return make_solver(system, forces, {&exact, 1}, 1.0);
        }
        throw Refusal(Refusal::Reason::kUndecidedString, "it is not decided");
    };
    RopeDef rope = swinging();
    rope.cuts = {{2, 0.25}};
    const System system = build_system({&rope, 1});
    const auto solver = solve_in_phases(system, WorldDef{}, ExactDef{}, refused);
    State state{0.0, system.x_m, system.y_m};
    ASSERT_EQ(solver->advance_to(0.2, state), Status::kOk);
    try {
        static_cast<void>(solver->advance_to(0.3, state));
        FAIL();
    } catch (const Refusal& refusal) {
        EXPECT_EQ(refusal.reason(), Refusal::Reason::kUndecidedString);
        EXPECT_STREQ(refusal.what(), "from 0.25 s on: it is not decided");
    }
}

}  // namespace
}  // namespace corda::sim
