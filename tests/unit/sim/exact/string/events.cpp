#include "corda/sim/exact/string/events.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "corda/sim/exact/exact_part.hpp"
#include "support/strings.hpp"
#include "support/unstopped.hpp"

namespace corda::sim {
namespace {

constexpr double kGravity = 9.81;

/// What has happened to a string when the first of its links changes sides.
struct Event {
    double time_s = 0.0;
    State state;
};

/// The first event of a string whose links are taut as given, before `end_s`.
std::optional<Event> first_event(const RopeDef& rope, std::vector<std::uint8_t> is_taut, double tolerance,
                                 double end_s) {
    System string = build_system({&rope, 1});
    StringContacts contacts(string, WorldDef{}, 1e-9);
    EXPECT_TRUE(contacts.resolve(string, is_taut, test::unstopped));
    StringDynamics dynamics(string, is_taut, WorldDef{});
    StringEvents events(string.particle_count());
    events.start(string, is_taut, contacts, dynamics);
    Dop853 integrator(dynamics, dynamics.initial_state(), dynamics.error_scales(),
                      step_control(dynamics.inverse_timescale_1_s(), tolerance));
    while (integrator.time_s() < end_s) {
        if (integrator.step(test::unstopped) != Status::kOk) return std::nullopt;
        const std::optional<double> time_s = events.first_in_step(integrator, dynamics, test::unstopped);
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

TEST(StringEvents, FindAContactThatLastsAMoment) {
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

TEST(StringEvents, AreNoneWhileNothingChanges) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {0.3, -std::sqrt(0.91)}}, {1.0});
    EXPECT_FALSE(first_event(rope, {1}, 1e-9, 5.0).has_value());
}

}  // namespace
}  // namespace corda::sim
