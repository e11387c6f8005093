#include "corda/sim/exact/chain_dynamics.hpp"
#include "corda/sim/exact/chain_closing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "corda/sim/solver.hpp"
#include "corda/sim/system.hpp"
#include "unit/sim/exact/chains.hpp"

namespace corda::sim {
namespace {

const WorldDef kWorld{{0.7, -9.81}, 1.0, 0.3};

/// The velocities of all particles; 0 of pinned ones, which are not written.
State velocities(const ChainDynamics& dynamics, const std::vector<double>& y) {
    const std::vector<double> none(test::kChainParticles);
    State state{0.0, {}, {}, none, none};
    dynamics.velocities(y.data(), state);
    return state;
}

/// Of the particles, by the derivative of their velocities along the motion.
std::vector<Vec2> accelerations(const ChainDynamics& dynamics, const std::vector<double>& y,
                                const std::vector<double>& slope) {
    constexpr double kStep = 1e-6;
    const auto moved = [&](double step_s) {
        std::vector<double> there = y;
        for (std::size_t i = 0; i < y.size(); ++i) there[i] += step_s * slope[i];
        return velocities(dynamics, there);
    };
    const State later = moved(kStep);
    const State earlier = moved(-kStep);
    std::vector<Vec2> result;
    for (std::size_t i = 0; i < later.vx_m_s.size(); ++i) {
        result.push_back((0.5 / kStep) *
                         Vec2{later.vx_m_s[i] - earlier.vx_m_s[i], later.vy_m_s[i] - earlier.vy_m_s[i]});
    }
    return result;
}

TEST(ChainDynamics, ObeysNewtonsLawWithItsTensions) {
    for (const test::Pins pins :
         {test::Pins::kNone, test::Pins::kStart, test::Pins::kEnd, test::Pins::kBoth}) {
        const System system = test::chain(pins);
        ChainDynamics dynamics(system, system.bodies, kWorld);
        const std::vector<double>& y = dynamics.initial_state();
        std::vector<double> slope(y.size());
        dynamics.derivative(y.data(), slope.data());
        std::vector<double> tension_n;
        dynamics.tensions(y.data(), tension_n);
        const std::vector<Vec2> acceleration = accelerations(dynamics, y, slope);
        State state{0.0, system.x_m, system.y_m};
        dynamics.positions(y.data(), state);
        const State at_start = velocities(dynamics, y);
        const std::vector<double>& vx = at_start.vx_m_s;
        const std::vector<double>& vy = at_start.vy_m_s;
        // What the bar from one particle to the next does to the first.
        const auto pull = [&](std::size_t i) {
            const Vec2 along{state.x_m[i + 1] - state.x_m[i], state.y_m[i + 1] - state.y_m[i]};
            return (tension_n[i] / std::hypot(along.x, along.y)) * along;
        };
        for (std::size_t i = 0; i < test::kChainParticles; ++i) {
            if (system.is_pinned(i)) continue;
            Vec2 force_n;
            if (i + 1 < test::kChainParticles) force_n = force_n + pull(i);
            if (i > 0) force_n = force_n - pull(i - 1);
            const Vec2 expected = kWorld.gravity_m_s2 + system.inverse_mass_1_kg[i] * force_n -
                                  kWorld.drag_1_s * Vec2{vx[i], vy[i]};
            // measured: 2e-8 of accelerations up to 100 m/s2, by the difference quotient
            EXPECT_NEAR(acceleration[i].x, expected.x, 1e-6) << i;
            EXPECT_NEAR(acceleration[i].y, expected.y, 1e-6) << i;
        }
    }
}

TEST(ChainDynamics, StartsWithoutVelocitiesAlongItsLinks) {
    const System system = test::chain(test::Pins::kNone);
    const ChainDynamics dynamics(system, system.bodies, kWorld);
    const State at_start = velocities(dynamics, dynamics.initial_state());
    const std::vector<double>& vx = at_start.vx_m_s;
    const std::vector<double>& vy = at_start.vy_m_s;
    Vec2 momentum;
    Vec2 given;
    for (std::size_t i = 0; i < test::kChainParticles; ++i) {
        momentum = momentum + system.mass_kg[i] * Vec2{vx[i], vy[i]};
        given = given + system.mass_kg[i] * Vec2{system.vx_m_s[i], system.vy_m_s[i]};
        if (i == 0) continue;
        const Vec2 along{system.x_m[i] - system.x_m[i - 1], system.y_m[i] - system.y_m[i - 1]};
        EXPECT_NEAR(dot(along, {vx[i] - vx[i - 1], vy[i] - vy[i - 1]}), 0.0, 1e-14);
    }
    EXPECT_NEAR(momentum.x, given.x, 1e-13);
    EXPECT_NEAR(momentum.y, given.y, 1e-13);
}

TEST(ChainDynamics, ClosesAChainThatHasDriftedFromItsSecondPin) {
    const System system = test::chain(test::Pins::kBoth);
    const ChainDynamics dynamics(system, system.bodies, kWorld);
    ASSERT_EQ(dynamics.chains().list.size(), 1U);
    std::vector<double> y = dynamics.initial_state();
    const std::size_t links = dynamics.chains().link_count();
    const auto gap = [&](std::size_t first, bool of_velocities) {
        const Chain& chain = dynamics.chains().list[first];
        Vec2 open = of_velocities ? Vec2{} : -1.0 * chain.span_m;
        for (std::size_t i = 0; i < links; ++i) {
            const Vec2 direction{y[i], y[links + i]};
            open = open + dynamics.chains().length_m[i] *
                              (of_velocities ? y[2 * links + i] * left_of(direction) : direction);
        }
        return std::hypot(open.x, open.y);
    };
    y[2] += 1e-5;
    y[2 * links + 4] += 1e-5;
    EXPECT_GT(gap(0, false), 1e-6);
    EXPECT_GT(gap(0, true), 1e-6);
    close_between_pins(dynamics.chains(), dynamics.chains().list.front(), 0.0, y.data());
    EXPECT_LT(gap(0, false), 1e-15);
    EXPECT_LT(gap(0, true), 1e-10);  // measured 1.1e-11: one step with the matrix from before
    for (std::size_t i = 0; i < links; ++i) {
        EXPECT_NEAR(std::hypot(y[i], y[links + i]), 1.0, 1e-15);
        EXPECT_NEAR(y[i], dynamics.initial_state()[i], 1e-4);
    }
}

TEST(ChainDynamics, CutsARopeAtItsPinsIntoChainsThatStartAtOne) {
    RopeDef rope = test::chain_rope();
    rope.pinned = {2, 3, 6};
    const System system = build_system({&rope, 1});
    const ChainDynamics dynamics(system, system.bodies, kWorld);
    ASSERT_EQ(dynamics.chains().list.size(), 3U);  // none between 2 and 3
    const std::vector<Chain>& list = dynamics.chains().list;
    const auto& [back, middle, forth] = std::tie(list[0], list[1], list[2]);
    EXPECT_TRUE(back.runs_backwards);
    EXPECT_EQ(back.first_particle, 2U);
    EXPECT_EQ(back.particle(1), 0U);
    EXPECT_TRUE(middle.starts_pinned && middle.ends_pinned);
    EXPECT_EQ(middle.link_count, 3U);
    EXPECT_FALSE(forth.runs_backwards || forth.ends_pinned);
    EXPECT_EQ(forth.first_particle, 6U);
    EXPECT_FALSE(dynamics.chains().links[2].moves);
    EXPECT_TRUE(dynamics.chains().links[1].runs_backwards);
}

TEST(ChainDynamics, RefusesAChainThatIsTautBetweenTwoPins) {
    EXPECT_NO_THROW(refuse_taut_between_pins(1.0, {0.6, 0.79}, 0, 5));
    try {
        refuse_taut_between_pins(1.0, {0.6, 0.8}, 0, 5);
        ADD_FAILURE() << "not refused";
    } catch (const Refusal& refusal) {
        EXPECT_EQ(refusal.reason(), Refusal::Reason::kTautBetweenPins);
    }
}

constexpr test::Pins kAllPins[] = {test::Pins::kNone, test::Pins::kStart, test::Pins::kEnd,
                                   test::Pins::kBoth};

struct Moving {
    explicit Moving(const System& given, const WorldDef& world = {})
        : system(given), dynamics(system, system.bodies, world) {}
    [[nodiscard]] State positions(const std::vector<double>& y) const {
        State state{0.0, std::vector<double>(system.particle_count(), NAN),
                    std::vector<double>(system.particle_count(), NAN)};
        dynamics.positions(y.data(), state);
        return state;
    }
    [[nodiscard]] Loads loads() {
        const std::vector<double>& y = dynamics.initial_state();
        std::vector<double> tension_n;
        dynamics.tensions(y.data(), tension_n);
        return LoadMeter(system).of(system, positions(y), tension_n).value();
    }
    System system;
    ChainDynamics dynamics;
};

TEST(ChainOutputs, StartAtThePositionsOfTheSystem) {
    for (const test::Pins pins : kAllPins) {
        const Moving moving(test::chain(pins));
        const State state = moving.positions(moving.dynamics.initial_state());
        for (std::size_t i = 0; i < test::kChainParticles; ++i) {
            EXPECT_NEAR(state.x_m[i], moving.system.x_m[i], 1e-15) << i;
            EXPECT_NEAR(state.y_m[i], moving.system.y_m[i], 1e-15) << i;
        }
    }
}

TEST(ChainOutputs, HaveVelocitiesThatAreTheChangeOfThePositions) {
    for (const test::Pins pins : kAllPins) {
        Moving moving(test::chain(pins));
        const std::vector<double>& y = moving.dynamics.initial_state();
        std::vector<double> slope(y.size());
        moving.dynamics.derivative(y.data(), slope.data());
        constexpr double kStep = 1e-6;
        std::vector<double> later = y;
        std::vector<double> earlier = y;
        for (std::size_t i = 0; i < y.size(); ++i) {
            later[i] += kStep * slope[i];
            earlier[i] -= kStep * slope[i];
        }
        const State ahead = moving.positions(later);
        const State behind = moving.positions(earlier);
        const State at_start = velocities(moving.dynamics, y);
        const std::vector<double>& vx = at_start.vx_m_s;
        const std::vector<double>& vy = at_start.vy_m_s;
        for (std::size_t i = 0; i < test::kChainParticles; ++i) {
            EXPECT_NEAR(vx[i], (ahead.x_m[i] - behind.x_m[i]) / (2.0 * kStep), 1e-8) << i;
            EXPECT_NEAR(vy[i], (ahead.y_m[i] - behind.y_m[i]) / (2.0 * kStep), 1e-8) << i;
        }
    }
}

TEST(ChainOutputs, HaveTheEnergyOfTheirParticles) {
    const WorldDef world{{1.5, -9.81}, 1.0, 0.0};
    for (const test::Pins pins : kAllPins) {
        const Moving moving(test::chain(pins), world);
        const std::vector<double>& y = moving.dynamics.initial_state();
        const State state = moving.positions(y);
        const State at_start = velocities(moving.dynamics, y);
        const std::vector<double>& vx = at_start.vx_m_s;
        const std::vector<double>& vy = at_start.vy_m_s;
        double energy_j = 0.0;
        for (std::size_t i = 0; i < test::kChainParticles; ++i) {
            if (moving.system.is_pinned(i)) continue;
            energy_j += moving.system.mass_kg[i] * (0.5 * (vx[i] * vx[i] + vy[i] * vy[i]) -
                                                    dot(world.gravity_m_s2, {state.x_m[i], state.y_m[i]}));
        }
        EXPECT_NEAR(moving.dynamics.energy_j(y.data()), energy_j, 1e-12);
    }
}

TEST(ChainOutputs, HaveTheLoadsOfAHangingRope) {
    // Two sides hang from the pin in the middle: 1.5 and 2 kg.
    RopeDef rope = reference::rope_through({{0.0, -2.0}, {0.0, -1.0}, {0.0, 0.0}, {0.0, -0.5}});
    rope.mass_kg = {0.5, 1.0, 7.0, 2.0};
    rope.pinned = {2};
    Moving moving(build_system({&rope, 1}));
    const Loads loads = moving.loads();
    EXPECT_NEAR(loads.largest_tension_n, 2.0 * 9.81, 1e-13);
    EXPECT_NEAR(loads.pin_force_n, 3.5 * 9.81, 1e-13);
    std::vector<double> tension_n;
    moving.dynamics.tensions(moving.dynamics.initial_state().data(), tension_n);
    EXPECT_NEAR(tension_n[0], 0.5 * 9.81, 1e-13);
    EXPECT_NEAR(tension_n[1], 1.5 * 9.81, 1e-13);
}

TEST(ChainOutputs, HaveTheForceOfAClampAtItsPins) {
    // A link that two pins hold, and one that is bent from it by a right angle: a torque of 3 N m on links of
    // 1 m.
    RopeDef rope = reference::rope_through({{-1.0, 0.0}, {0.0, 0.0}, {0.0, -1.0}});
    rope.pinned = {0, 1};
    rope.bending_n_m2 = 3.0;
    Moving moving(build_system({&rope, 1}), WorldDef{{0.0, 0.0}, 1.0, 0.0});
    // Its couples are 3 N at the ends of each link, across it; at the second pin they meet at a right angle.
    const Loads loads = moving.loads();
    EXPECT_NEAR(loads.pin_force_n, std::hypot(3.0, 3.0), 1e-12);
    EXPECT_NEAR(loads.largest_tension_n, 0.0, 1e-12);
}

}  // namespace
}  // namespace corda::sim
