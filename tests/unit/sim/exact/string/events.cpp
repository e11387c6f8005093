#include "corda/sim/exact/string/events.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "corda/sim/exact/exact.hpp"
#include "support/strings.hpp"
#include "unit/sim/exact/chains.hpp"

namespace corda::sim {
namespace {

constexpr double kGravity = 9.81;

/// A string at the moment the first of its links changes sides.
struct Event {
    double time_s = 0.0;
    State state;
};

/// The first event of a string whose links are taut as given, before `end_s`.
std::optional<Event> first_event(const RopeDef& rope, std::vector<std::uint8_t> is_taut, double tolerance,
                                 double end_s) {
    System string = build_system({&rope, 1});
    StringContacts contacts(string, WorldDef{}, 1e-9);
    EXPECT_TRUE(contacts.resolve(string, is_taut));
    ChainDynamics dynamics(chains_of_string(string, is_taut, WorldDef{}));
    StringEvents events(string.particle_count());
    events.start(string, is_taut, contacts, dynamics);
    Dop853 integrator(dynamics, dynamics.initial_state(), dynamics.error_scales(),
                      step_control(dynamics.inverse_timescale_1_s(), tolerance));
    while (integrator.time_s() < end_s) {
        if (integrator.step() != Status::kOk) return std::nullopt;
        const std::optional<double> time_s = events.first_in_step(integrator, dynamics);
        if (!time_s) continue;
        std::vector<double> y(integrator.size());
        integrator.interpolate(*time_s, y.data());
        Event event{*time_s, {0.0, string.x_m, string.y_m}};
        dynamics.positions(y.data(), event.state);
        return event;
    }
    return std::nullopt;
}

TEST(StringEvents, FindTheTimeOfFirstContactOfAFall) {
    // From (0.6, 0) straight down to the circle of radius 1.
    const RopeDef rope = test::string_of({{0.0, 0.0}, {0.6, 0.0}}, {1.0});
    const auto event = first_event(rope, {0}, 1e-9, 1.0);
    ASSERT_TRUE(event.has_value());
    EXPECT_NEAR(event->time_s, std::sqrt(2.0 * 0.8 / kGravity), 1e-14);
    EXPECT_NEAR(event->state.y_m[1], -0.8, 1e-13);  // measured 1.5e-14
}

TEST(StringEvents, FindABriefContact) {
    // Thrown up from 0.2 m above the pin, the particle passes the length of 1 m by 1e-6 m for a millisecond:
    // in the middle of steps a hundred times as long.
    constexpr double kOvershoot = 1e-6;
    RopeDef rope = test::string_of({{0.0, 0.0}, {0.0, 0.2}}, {1.0});
    const double speed_m_s = std::sqrt(2.0 * kGravity * (0.8 + kOvershoot));
    rope.velocity_m_s[1] = {0.0, speed_m_s};
    const auto event = first_event(rope, {0}, 1e-9, 1.0);
    ASSERT_TRUE(event.has_value());
    const double expected_s = (speed_m_s - std::sqrt(2.0 * kGravity * kOvershoot)) / kGravity;
    std::printf("moment of contact: off by %.1e s\n", event->time_s - expected_s);
    EXPECT_NEAR(event->time_s, expected_s, 1e-11);  // measured 2.3e-12
    rope.velocity_m_s[1] = {0.0, std::sqrt(2.0 * kGravity * (0.8 - kOvershoot))};
    const auto next = first_event(rope, {0}, 1e-9, 1.5);
    ASSERT_TRUE(next.has_value());
    // It just misses the length above, and meets it below.
    EXPECT_NEAR(next->state.y_m[1], -1.0, 1e-13);
}

TEST(StringEvents, FindTheFirstOfSeveralLinks) {
    // Both fall freely, side by side; the second link is the shorter way from coming taut.
    RopeDef rope = test::string_of({{0.0, 0.0}, {0.1, 0.0}, {0.2, 0.0}}, {1.0, 0.5});
    rope.velocity_m_s = {{}, {0.0, 0.0}, {2.0, 0.0}};
    const auto event = first_event(rope, {0, 0}, 1e-9, 1.0);
    ASSERT_TRUE(event.has_value());
    EXPECT_NEAR(event->time_s, 0.4 / 2.0, 1e-14);  // 0.1 m apart, 2 m/s, length 0.5 m
}

TEST(StringEvents, FindTheTimeAtWhichATautLinkGoesSlack) {
    // Swung up from below with v^2 = 3.5 g L, it goes slack when v^2 / L = -g cos(angle): cos(angle) = -1/2.
    RopeDef rope = test::string_of({{0.0, 0.0}, {0.0, -1.0}}, {1.0});
    rope.velocity_m_s[1] = {std::sqrt(3.5 * kGravity), 0.0};
    const auto event = first_event(rope, {1}, 1e-12, 1.0);
    ASSERT_TRUE(event.has_value());
    std::printf("goes slack: off by %.1e m\n", event->state.y_m[1] - 0.5);
    EXPECT_NEAR(event->state.y_m[1], 0.5, 1e-10);  // measured 1.5e-12
    EXPECT_NEAR(event->state.x_m[1], std::sqrt(0.75), 1e-10);
}

TEST(StringEvents, AreAbsentWhileNothingChanges) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {0.3, -std::sqrt(0.91)}}, {1.0});
    EXPECT_FALSE(first_event(rope, {1}, 1e-9, 5.0).has_value());
}

const WorldDef kWorld{{0.5, -9.81}, 1.0, 0.2};

/// Slack links 0, 3 and 4, so that particles 0 and 4 are loose; 1 to 3 and 5 to 8 are runs.
const std::vector<std::uint8_t> kTaut{0, 1, 1, 0, 0, 1, 1, 1};

System free_string() {
    System system = test::chain(test::Pins::kNone);
    for (const std::size_t k : {0U, 3U, 4U}) system.bars[k].rest_m *= 1.5;
    return system;
}

TEST(ChainsOfString, LetsLooseParticlesFallAndMovesRunsAsChains) {
    const System system = free_string();
    ChainDynamics dynamics(chains_of_string(system, kTaut, kWorld));
    const std::vector<double>& y = dynamics.initial_state();
    std::vector<double> slope(y.size());
    dynamics.derivative(y.data(), slope.data());
    // The displacement and the velocity of the two loose particles come last.
    const std::size_t first = y.size() - 8;
    for (const auto& [at, particle] : {std::pair(first, 0U), std::pair(first + 4, 4U)}) {
        EXPECT_EQ(y[at], 0.0);
        EXPECT_EQ(slope[at], system.vx_m_s[particle]);
        EXPECT_EQ(slope[at + 1], system.vy_m_s[particle]);
        EXPECT_DOUBLE_EQ(slope[at + 2], 0.5 - 0.2 * system.vx_m_s[particle]);
        EXPECT_DOUBLE_EQ(slope[at + 3], -9.81 - 0.2 * system.vy_m_s[particle]);
    }
    Body run;
    run.first_particle = run.first_bar = 5;
    run.particle_count = 4;
    run.bar_count = run.link_count = 3;
    ChainDynamics alone(system, {&run, 1}, kWorld);
    std::vector<double> expected_n;
    alone.tensions(alone.initial_state().data(), expected_n);
    std::vector<double> tension_n;
    dynamics.tensions(y.data(), tension_n);
    ASSERT_EQ(tension_n.size(), kTaut.size());
    for (const std::size_t k : {0U, 3U, 4U}) EXPECT_EQ(tension_n[k], 0.0) << k;
    for (const std::size_t k : {5U, 6U, 7U}) EXPECT_NEAR(tension_n[k], expected_n[k], 1e-12) << k;
    EXPECT_NE(tension_n[1], 0.0);
}

TEST(ChainsOfString, KnowsAllPositionsVelocitiesAndTheEnergy) {
    const System system = free_string();
    const ChainDynamics dynamics(chains_of_string(system, kTaut, kWorld));
    const double* const y = dynamics.initial_state().data();
    const std::vector<double> unknown(test::kChainParticles, NAN);
    State state{0.0, unknown, unknown, unknown, unknown};
    dynamics.positions(y, state);
    dynamics.velocities(y, state);
    const std::vector<double>& vx = state.vx_m_s;
    const std::vector<double>& vy = state.vy_m_s;
    double energy_j = 0.0;
    for (std::size_t i = 0; i < test::kChainParticles; ++i) {
        EXPECT_NEAR(state.x_m[i], system.x_m[i], 1e-15) << i;
        EXPECT_NEAR(state.y_m[i], system.y_m[i], 1e-15) << i;
        energy_j += system.mass_kg[i] * (0.5 * (vx[i] * vx[i] + vy[i] * vy[i]) -
                                         dot(kWorld.gravity_m_s2, {state.x_m[i], state.y_m[i]}));
    }
    EXPECT_EQ(vx[4], system.vx_m_s[4]);
    EXPECT_NEAR(dynamics.energy_j(y), energy_j, 1e-12);
}

TEST(ChainsOfString, MeasuresErrorsOfEveryNumberOfAState) {
    const System system = free_string();
    const ChainDynamics dynamics(chains_of_string(system, kTaut, kWorld));
    std::vector<int> measured(dynamics.initial_state().size(), 0);
    for (const ErrorScale& scale : dynamics.error_scales())
        for (std::size_t i = 0; i < scale.count; ++i) ++measured.at(scale.first + i);
    EXPECT_EQ(measured, std::vector<int>(measured.size(), 1));
}

TEST(ChainsOfString, HasTheTimeScaleOfTheFastestSlackLink) {
    // Two particles of a slack link of 0.1 m that part at 20 m/s: faster than gravity alone would make them.
    RopeDef rope = reference::rope_through({{0.0, 0.0}, {0.05, 0.0}});
    rope.pinned = {};
    rope.velocity_m_s = {{-10.0, 0.0}, {10.0, 0.0}};
    System system = build_system({&rope, 1});
    system.bars[0].rest_m = 0.1;
    const ChainDynamics dynamics(chains_of_string(system, {0}, WorldDef{}));
    EXPECT_GE(dynamics.inverse_timescale_1_s(), 20.0 / 0.1);
    rope.velocity_m_s = {};
    system = build_system({&rope, 1});
    const ChainDynamics resting(chains_of_string(system, {0}, WorldDef{{0.0, 0.0}}));
    EXPECT_EQ(resting.inverse_timescale_1_s(), 1.0);
}

}  // namespace
}  // namespace corda::sim
