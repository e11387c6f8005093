// Method `exact` with strings of rigid links, which pull and never push, against closed forms: R9
// (src/corda/sim/README.md) and other motions made of parabolas, circles and plastic snaps.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "accuracy/root.hpp"
#include "benchmark/study/reference/ropes.hpp"
#include "corda/sim/exact/string/part.hpp"
#include "support/gravity.hpp"
#include "support/solver_run.hpp"
#include "support/strings.hpp"

namespace corda::sim {
namespace {

using test::kGravity;

/// A string under the method `exact`, with its events.
class StringRun {
  public:
    explicit StringRun(const RopeDef& rope, double tolerance = 1e-9, const WorldDef& world = {})
        : system(build_system({&rope, 1})),
          part(system, world, tolerance),
          state{0.0, system.x_m, system.y_m} {}

    Loads loads() {
        std::vector<double> tension_n(system.bars.size());
        EXPECT_TRUE(part.tensions(tension_n));
        return LoadMeter(system).of(system, state, tension_n).value();
    }
    bool advance_to(double time_s) { return part.advance_to(time_s, state) == Status::kOk; }

    System system;
    StringPart part;
    State state;
};

/// The last time up to which `is_before` holds in a run: by bisection.
template <class Predicate>
double last_time_s(const RopeDef& rope, double tolerance, double low_s, double high_s, Predicate is_before) {
    for (int k = 0; k < 60; ++k) {
        const double middle_s = 0.5 * (low_s + high_s);
        StringRun run(rope, tolerance);
        EXPECT_TRUE(run.advance_to(middle_s));
        (is_before(run) ? low_s : high_s) = middle_s;
    }
    return low_s;
}

TEST(SnapR9, KeepsTheTangentialPart) {
    const RopeDef rope = test::string_of({{0.0, 0.0}, {0.6, 0.0}}, {1.0});
    const double fall_s = std::sqrt(2.0 * 0.8 / kGravity);
    const double snap_s =
        last_time_s(rope, 1e-9, 0.3, 0.6, [](const StringRun& run) { return run.part.events() == 0; });
    std::printf("R9: time of the snap off by %.1e s\n", snap_s - fall_s);
    EXPECT_NEAR(snap_s, fall_s, 1e-12);  // measured 3.2e-15

    StringRun run(rope);
    ASSERT_TRUE(run.advance_to(fall_s * (1.0 - 1e-9)));
    EXPECT_EQ(run.loads().largest_tension_n, 0.0);
    const double energy_before_j = run.part.energy_j();
    ASSERT_TRUE(run.advance_to(fall_s * (1.0 + 1e-9)));
    const double kinetic_j = kGravity * 0.8;
    EXPECT_NEAR(energy_before_j, 0.0, 1e-12);
    const double kept = (run.part.energy_j() + kinetic_j) / kinetic_j;
    std::printf("R9: kept %.16g of the kinetic energy\n", kept);
    EXPECT_NEAR(kept, 0.36, 1e-12);  // measured 8.5e-15

    // Highest on the other side: y is stationary there, so the time need not be exact.
    const auto height_m = [&](double time_s) {
        StringRun at(rope);
        EXPECT_TRUE(at.advance_to(time_s));
        EXPECT_LT(at.state.x_m[1], 0.0);
        return at.state.y_m[1];
    };
    double low_s = fall_s + 0.6;
    double high_s = fall_s + 1.4;
    for (int k = 0; k < 60; ++k) {
        const double third_s = (high_s - low_s) / 3.0;
        if (height_m(low_s + third_s) < height_m(high_s - third_s)) {
            low_s += third_s;
        } else {
            high_s -= third_s;
        }
    }
    const double cosine = -height_m(0.5 * (low_s + high_s));
    std::printf("R9: turns at cosine %.16g\n", cosine);
    EXPECT_NEAR(cosine, 0.512, 1e-10);  // measured 2.3e-12
    ASSERT_TRUE(run.advance_to(high_s));
    EXPECT_EQ(run.part.events(), 1U);
}

TEST(SnapR9, HappensAtTheTimeThatDragGives) {
    const RopeDef rope = test::string_of({{0.0, 0.0}, {0.6, 0.0}}, {1.0});
    constexpr double kDrag = 0.8;
    StringRun run(rope, 1e-9, WorldDef{{0.0, -kGravity}, 10.0, kDrag});
    const auto height_m = [&](double time_s) {
        return -kGravity / kDrag * (time_s - (1.0 - std::exp(-kDrag * time_s)) / kDrag);
    };
    const double snap_s = test::root([&](double time_s) { return height_m(time_s) + 0.8; }, 0.3, 0.6);
    ASSERT_TRUE(run.advance_to(snap_s * (1.0 - 1e-12)));
    EXPECT_EQ(run.part.events(), 0U);
    const double place_m = run.state.y_m[1] + 0.8;
    const double kinetic_before_j = run.part.energy_j() - kGravity * run.state.y_m[1];
    const double speed_m_s = kGravity / kDrag * (1.0 - std::exp(-kDrag * snap_s));
    ASSERT_TRUE(run.advance_to(snap_s * (1.0 + 1e-12)));
    EXPECT_EQ(run.part.events(), 1U);
    const double kinetic_after_j = run.part.energy_j() - kGravity * run.state.y_m[1];
    const double energy_j = kinetic_before_j - 0.5 * speed_m_s * speed_m_s;
    const double kept = kinetic_after_j / kinetic_before_j - 0.36;
    std::printf("R9 with drag: off by %.1e m, %.1e J, %.1e kept\n", place_m, energy_j, kept);
    EXPECT_LT(std::abs(place_m), 1e-11);   // measured 1.6e-13
    EXPECT_LT(std::abs(energy_j), 1e-10);  // measured 1.4e-11
    EXPECT_LT(std::abs(kept), 1e-10);      // measured 1.2e-12
}

TEST(TautPendulum, MovesLikeARigidOne) {
    // Two integrators: the string's is Dop853, the rigid rope's a Taylor series.
    double apart_m = 0.0;
    for (const int links : {1, 5}) {
        RopeDef rope = reference::straight_rope(links, 1.0, 40.0);
        test::ExactRun rigid(rope);
        rope.material.is_string = true;
        test::ExactRun string(rope);
        for (const double time_s : {0.1, 1.0, 4.0}) {
            ASSERT_TRUE(rigid.go(time_s) && string.go(time_s));
            for (std::size_t i = 0; i < rope.points_m.size(); ++i) {
                apart_m = std::max(apart_m, length(rigid.state().x_m[i] - string.state().x_m[i],
                                                   rigid.state().y_m[i] - string.state().y_m[i]));
            }
        }
        EXPECT_TRUE(rigid.solver().conserves_energy());
        EXPECT_FALSE(string.solver().conserves_energy());
        EXPECT_NEAR(rigid.loads()->largest_tension_n, string.loads()->largest_tension_n, 1e-8);
        EXPECT_NEAR(rigid.solver().energy_j(), string.solver().energy_j(), 1e-9);
    }
    std::printf("taut: %.1e m apart\n", apart_m);
    EXPECT_LT(apart_m, 1e-9);  // measured 2.6e-11
}

TEST(Circle, IsLeftAtZeroTensionAndMetAgainAtThreeTimesTheAngle) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {0.0, -1.0}}, {});
    rope.velocity_m_s[1] = {2.0 * std::sqrt(kGravity), 0.0};
    const double sine = 2.0 / 3.0;  // ((v0^2 / (g L)) - 2) / 3
    const double angle = std::asin(sine);
    const double speed_m_s = std::sqrt(kGravity * sine);
    const double flight_s = 4.0 * speed_m_s * std::cos(angle) / kGravity;
    const double leave_s =
        last_time_s(rope, 1e-12, 0.3, 1.5, [](const StringRun& run) { return run.part.events() == 0; });
    const auto expect_at = [&](double time_s, Vec2 expected, const char* name) {
        StringRun run(rope, 1e-12);
        ASSERT_TRUE(run.advance_to(time_s));
        const double error_m = length(run.state.x_m[1] - expected.x, run.state.y_m[1] - expected.y);
        std::printf("circle, %s: off by %.1e m\n", name, error_m);
        EXPECT_LT(error_m, 1e-10);  // measured 2.2e-12
    };
    const Vec2 start_m{std::cos(angle), sine};
    expect_at(leave_s, start_m, "left");
    const Vec2 velocity = speed_m_s * Vec2{-sine, std::cos(angle)};
    const double half_s = 0.5 * flight_s;
    expect_at(leave_s + half_s, start_m + half_s * velocity + Vec2{0.0, -0.5 * kGravity * half_s * half_s},
              "half way");
    const Vec2 end_m{std::cos(-3.0 * angle), std::sin(-3.0 * angle)};
    expect_at(leave_s + flight_s, end_m, "met again");
    // The tangential part of the velocity is kept.
    StringRun run(rope, 1e-12);
    ASSERT_TRUE(run.advance_to(leave_s + flight_s - 1e-6));
    EXPECT_EQ(run.part.events(), 1U);
    EXPECT_NEAR(run.part.energy_j(), kGravity, 1e-11);
    EXPECT_EQ(run.loads().largest_tension_n, 0.0);
    ASSERT_TRUE(run.advance_to(leave_s + flight_s + 1e-6));
    EXPECT_EQ(run.part.events(), 2U);
    const Vec2 hit = velocity + Vec2{0.0, -kGravity * flight_s};
    const double kept_m_s = dot(left_of(end_m), hit);
    EXPECT_NEAR(run.part.energy_j(), 0.5 * kept_m_s * kept_m_s + kGravity * end_m.y, 1e-9);
}

TEST(TwoFreeMasses, KeepMomentumWhenTheirStringSnaps) {
    for (const double heavy_kg : {3.0, 1000.0}) {
        RopeDef rope = test::string_of({{0.0, 0.0}, {0.5, 0.0}}, {1.0});
        rope.pinned = {};
        rope.mass_kg[1] = 2.0;
        rope.payload_kg = heavy_kg - 2.0;
        rope.velocity_m_s = {{-0.3, -0.2}, {0.4, 0.5}};
        StringRun run(rope, 1e-9, WorldDef{{0.0, 0.0}, 10.0, 0.0});
        const Vec2 relative{0.7, 0.7};
        // |(0.5, 0) + t (0.7, 0.7)| = 1
        const double snap_s = (-0.35 + std::sqrt(0.35 * 0.35 + 0.98 * 0.75)) / 0.98;
        const Vec2 along = Vec2{0.5, 0.0} + snap_s * relative;
        const double apart_m_s = dot(along, relative);
        const double turn_1_s = dot(left_of(along), relative);
        const double reduced_kg = heavy_kg / (1.0 + heavy_kg);
        const double start_j = run.part.energy_j();
        const double time_s = snap_s + 7.0;
        ASSERT_TRUE(run.advance_to(time_s));
        EXPECT_EQ(run.part.events(), 1U);
        EXPECT_NEAR((run.part.energy_j() - start_j) / start_j,
                    -0.5 * reduced_kg * apart_m_s * apart_m_s / start_j, 1e-12);
        EXPECT_NEAR(run.loads().largest_tension_n, reduced_kg * turn_1_s * turn_1_s, 1e-11);
        const double share = 1.0 / (1.0 + heavy_kg);
        const Vec2 centre_m = share * (time_s * rope.velocity_m_s[0]) +
                              (1.0 - share) * (Vec2{0.5, 0.0} + time_s * rope.velocity_m_s[1]);
        const double turned = 7.0 * turn_1_s;
        const Vec2 direction = std::cos(turned) * along + std::sin(turned) * left_of(along);
        const Vec2 light_m = centre_m - (1.0 - share) * direction;
        const Vec2 heavy_m = centre_m + share * direction;
        const double error_m = std::max(length(run.state.x_m[0] - light_m.x, run.state.y_m[0] - light_m.y),
                                        length(run.state.x_m[1] - heavy_m.x, run.state.y_m[1] - heavy_m.y));
        std::printf("two masses 1:%g: off by %.1e m\n", heavy_kg, error_m);
        EXPECT_LT(error_m, 1e-10);  // measured 1.7e-12
    }
}

/// Moreau's time stepping (J.-J. Moreau, Unilateral contact and dry friction in finite freedom dynamics,
/// Springer 1988): velocities at the end of a step such that no link that is at its rest length in the middle
/// of it gets longer. Knows no event; of first order.
class MoreauString {
  public:
    MoreauString(const RopeDef& rope, Vec2 gravity_m_s2)
        : system_(build_system({&rope, 1})), gravity_(gravity_m_s2) {}

    void advance(double span_s, int steps) {
        const double h = span_s / steps;
        impulse_.assign(system_.bars.size(), 0.0);
        for (int step = 0; step < steps; ++step) {
            move(0.5 * h);
            for (std::size_t i = 0; i < system_.particle_count(); ++i) {
                if (!system_.is_pinned(i)) kick(i, h * gravity_, 1.0);
            }
            relax();
            move(0.5 * h);
        }
    }
    [[nodiscard]] double distance_m(const State& state) const {
        double largest = 0.0;
        for (std::size_t i = 0; i < system_.particle_count(); ++i) {
            largest = std::max(largest, length(system_.x_m[i] - state.x_m[i], system_.y_m[i] - state.y_m[i]));
        }
        return largest;
    }

  private:
    void move(double span_s) {
        for (std::size_t i = 0; i < system_.particle_count(); ++i) {
            system_.x_m[i] += span_s * system_.vx_m_s[i];
            system_.y_m[i] += span_s * system_.vy_m_s[i];
        }
    }
    void kick(std::size_t i, Vec2 by, double times) {
        system_.vx_m_s[i] += times * by.x;
        system_.vy_m_s[i] += times * by.y;
    }
    /// Gauss and Seidel's sweeps, impulses never below 0.
    void relax() {
        std::fill(impulse_.begin(), impulse_.end(), 0.0);
        for (double change = 1.0; change > 1e-13;) {
            change = 0.0;
            for (std::size_t k = 0; k < system_.bars.size(); ++k) {
                const Vec2 apart{system_.x_m[k + 1] - system_.x_m[k], system_.y_m[k + 1] - system_.y_m[k]};
                const double distance_m = length(apart.x, apart.y);
                if (distance_m < system_.bars[k].rest_m) continue;
                const Vec2 along = (1.0 / distance_m) * apart;
                const double speed_m_s = dot(along, {system_.vx_m_s[k + 1] - system_.vx_m_s[k],
                                                     system_.vy_m_s[k + 1] - system_.vy_m_s[k]});
                const double inverse_1_kg = system_.inverse_mass_1_kg[k] + system_.inverse_mass_1_kg[k + 1];
                const double before = impulse_[k];
                impulse_[k] = std::max(0.0, before + speed_m_s / inverse_1_kg);
                kick(k, along, (impulse_[k] - before) * system_.inverse_mass_1_kg[k]);
                kick(k + 1, along, (before - impulse_[k]) * system_.inverse_mass_1_kg[k + 1]);
                change = std::max(change, std::abs(impulse_[k] - before));
            }
        }
    }

    System system_;
    Vec2 gravity_;
    std::vector<double> impulse_;
};

/// The distance from Moreau's stepping has to shrink with its step.
void expect_moreau(const RopeDef& rope, Vec2 gravity_m_s2, double time_s, const char* name) {
    StringRun run(rope, 1e-9, WorldDef{gravity_m_s2, 10.0, 0.0});
    ASSERT_TRUE(run.advance_to(time_s));
    std::printf("%s: %d events;", name, static_cast<int>(run.part.events()));
    std::vector<double> error_m;
    for (const int steps : {1000, 4000, 16000, 64000}) {
        MoreauString moreau(rope, gravity_m_s2);
        moreau.advance(time_s, steps);
        error_m.push_back(moreau.distance_m(run.state));
        std::printf(" %.1e", error_m.back());
    }
    std::printf(" m from Moreau's stepping\n");
    EXPECT_GT(run.part.events(), 1U);
    EXPECT_LT(error_m[3], error_m[0] / 16.0) << name;  // of first order: 64
    EXPECT_LT(error_m[3], 3e-4) << name;               // measured 8.5e-5
}

TEST(Thrown, TwoLinksMoveAsByMoreausStepping) {
    RopeDef rope = test::string_of({{0.0, 0.0}, {0.5, 0.1}, {0.7, -0.3}}, {0.7, 0.5});
    rope.pinned = {};
    rope.mass_kg = {1.0, 2.0, 0.5};
    rope.velocity_m_s = {{-1.0, 2.0}, {0.5, 3.0}, {2.0, 1.0}};
    expect_moreau(rope, {0.0, -kGravity}, 1.0, "two links thrown");
}

TEST(Dropped, SlackLinksMoveAsByMoreausStepping) {
    std::vector<Vec2> points_m;
    for (int i = 0; i <= 6; ++i) points_m.push_back({0.08 * i, 0.02 * (i % 2)});
    RopeDef rope = test::string_of(points_m, std::vector<double>(6, 0.1));
    expect_moreau(rope, {0.0, -kGravity}, 0.35, "six slack links dropped");
    rope.pinned = {0, 6};
    expect_moreau(rope, {0.0, -kGravity}, 0.5, "six slack links between two pins");
}

TEST(ThreeFreeMasses, KeepMomentumAndSymmetryWhenBothLinksSnapAtOnce) {
    // The middle one is thrown across: both links snap when it has gone 0.6 m.
    RopeDef rope = test::string_of({{-0.8, 0.0}, {0.0, 0.0}, {0.8, 0.0}}, {1.0, 1.0});
    rope.pinned = {};
    rope.mass_kg[1] = 3.0;
    rope.velocity_m_s[1] = {0.0, 2.0};
    StringRun run(rope, 1e-9, WorldDef{{0.0, 0.0}, 10.0, 0.0});
    ASSERT_TRUE(run.advance_to(0.3 * (1.0 + 1e-9)));
    EXPECT_EQ(run.part.events(), 1U);
    // A pull p along each link, (0.8, 0.6) from the right one to the middle turned about: the middle one goes
    // at 2 - 2 (0.6 p) / 3, an outer one at p along its link, and their difference along it is 0:
    // 0.6 (2 - 0.4 p) = p.
    const double pull = 1.2 / 1.24;
    const double middle_m_s = 2.0 - 0.4 * pull;
    EXPECT_NEAR(run.part.energy_j(), 1.5 * middle_m_s * middle_m_s + pull * pull, 1e-12);
    for (const double time_s : {0.35, 0.45, 1.0}) {
        ASSERT_TRUE(run.advance_to(time_s));
        EXPECT_NEAR(run.state.x_m[1], 0.0, 1e-10);                // measured 2e-12
        EXPECT_NEAR(run.state.x_m[0], -run.state.x_m[2], 1e-10);  // 5e-12
        EXPECT_NEAR(run.state.y_m[0], run.state.y_m[2], 1e-10);   // the same
        EXPECT_NEAR(3.0 * run.state.y_m[1] + run.state.y_m[0] + run.state.y_m[2], 6.0 * time_s,
                    1e-10);  // 1.2e-11
    }
}

}  // namespace
}  // namespace corda::sim
