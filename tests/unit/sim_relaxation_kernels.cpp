// Every kernel of the relaxation method gives the bits of the scalar one, and a schedule keeps the order.

#include "corda/sim/relaxation_kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <random>

#include "corda/sim/relaxation.hpp"
#include "corda/sim/relaxation_schedule.hpp"
#include "corda/study/ropes.hpp"
#include "support/simulate.hpp"

namespace corda::sim {
namespace {

using Random = std::mt19937;

int pick(Random& random, int least, int most) {
    return std::uniform_int_distribution<int>(least, most)(random);
}

double pick_real(Random& random, double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random);
}

std::vector<std::uint32_t> random_pins(Random& random, std::size_t particles) {
    std::vector<std::uint32_t> pinned;
    // None, one, or enough for bars between two pins.
    const std::array<double, 3> shares{0.0, 1.0 / static_cast<double>(particles), 0.3};
    const double share = shares[static_cast<std::size_t>(pick(random, 0, 2))];
    for (std::uint32_t i = 0; i < particles; ++i) {
        if (pick_real(random, 0.0, 1.0) < share) pinned.push_back(i);
    }
    return pinned;
}

/// What bars see of a particle: somewhere near, on the particle before or on the one before that, at x = -0,
/// or at an x so small that the moves along x are subnormal numbers.
RopeDef random_rope(Random& random, int particles) {
    RopeDef rope;
    const int coincident_percent = pick(random, 0, 1) * pick(random, 1, 60);
    const double width_m =
        std::array{1.0, 1.0, 1.0, 1e-310, 0.0}[static_cast<std::size_t>(pick(random, 0, 4))];
    for (int i = 0; i < particles; ++i) {
        Vec2 point{width_m * pick_real(random, -1.0, 1.0), -0.7 * i + pick_real(random, -0.3, 0.3)};
        if (i >= 2 && pick(random, 1, 100) <= coincident_percent)
            point = rope.points_m[static_cast<std::size_t>(i - pick(random, 1, 2))];
        if (pick(random, 0, 19) == 0) point.x = -0.0;
        rope.points_m.push_back(point);
        rope.mass_kg.push_back(pick_real(random, 0.5, 2.0));
        rope.velocity_m_s.push_back({width_m * pick_real(random, -1.0, 1.0), pick_real(random, -1.0, 1.0)});
    }
    rope.closed = particles >= 3 && pick(random, 0, 3) == 0;
    rope.pinned = random_pins(random, rope.points_m.size());
    return rope;
}

NetDef random_net(Random& random) {
    NetDef net;
    const int particles = pick(random, 2, 60);
    for (int i = 0; i < particles; ++i) {
        net.points_m.push_back({pick_real(random, -1.0, 1.0), pick_real(random, -1.0, 1.0)});
        net.mass_kg.push_back(1.0);
        net.velocity_m_s.push_back({pick_real(random, -1.0, 1.0), 0.0});
    }
    for (std::uint32_t a = 0; a < net.points_m.size(); ++a) {
        for (std::uint32_t b = 0; b < a; ++b) {
            if (pick(random, 0, 9) == 0) net.bars.push_back({a, b, true});
        }
    }
    std::shuffle(net.bars.begin(), net.bars.end(), random);
    net.pinned = random_pins(random, net.points_m.size());
    return net;
}

System random_system(Random& random) {
    std::vector<RopeDef> ropes;
    const int largest = pick(random, 0, 1) == 0 ? 300 : 30;
    for (int count = pick(random, 1, 4); count > 0; --count)
        ropes.push_back(random_rope(random, pick(random, 2, largest)));
    std::vector<NetDef> nets;
    for (int count = pick(random, 0, 2); count > 0; --count) nets.push_back(random_net(random));
    return build_system(ropes, nets, pick(random, 1, 20));
}

SolverDef random_solver(Random& random) {
    SolverDef solver = test::relaxation();
    solver.sweeps = std::array{1, 1, 2, 3, 7}[static_cast<std::size_t>(pick(random, 0, 4))];
    solver.delta = pick(random, 0, 1) * 0.01;
    if (pick(random, 0, 1) == 0) solver.force_n = Vec2{0.0, pick(random, 0, 1) * -9.8};
    return solver;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// A run by one kernel.
struct KernelRun {
    KernelRun(const System& system, const SolverDef& solver, RelaxationKernel kernel)
        : relaxation(system, WorldDef{}, solver, 1.0 / 64.0, kernel), state{0.0, system.x_m, system.y_m} {}
    Relaxation relaxation;
    State state;
};

class RelaxationKernels : public testing::TestWithParam<RelaxationKernel> {};

TEST_P(RelaxationKernels, GiveTheBitsOfTheScalarOneOnRandomBodies) {
    for (unsigned seed = 0; seed < 250; ++seed) {
        Random random(seed);
        const System system = random_system(random);
        const SolverDef solver = random_solver(random);
        KernelRun scalar(system, solver, RelaxationKernel::kScalar);
        KernelRun run(system, solver, GetParam());
        double time_s = 0.0;
        // Single steps, many at once, and times between two steps.
        for (const double steps : {1.0, 1.0, 1.0, 2.0, 0.25, 0.75, 5.0, 20.0, 1.5, 2.5}) {
            time_s += steps / 64.0;
            ASSERT_EQ(scalar.relaxation.advance_to(time_s, scalar.state), Status::kOk);
            ASSERT_EQ(run.relaxation.advance_to(time_s, run.state), Status::kOk);
            ASSERT_TRUE(same_bits(scalar.state.x_m, run.state.x_m)) << "seed " << seed << ", " << time_s;
            ASSERT_TRUE(same_bits(scalar.state.y_m, run.state.y_m)) << "seed " << seed << ", " << time_s;
            ASSERT_EQ(scalar.relaxation.energy_j(), run.relaxation.energy_j()) << "seed " << seed;
        }
    }
}

TEST_P(RelaxationKernels, GiveTheBitsOfTheScalarOneOverManySteps) {
    for (const int particles : {20, 40, 100, 300}) {
        const RopeDef rope = study::report_rope(particles);
        const System system = build_system({&rope, 1}, 7);
        KernelRun scalar(system, test::relaxation(), RelaxationKernel::kScalar);
        KernelRun run(system, test::relaxation(), GetParam());
        ASSERT_EQ(scalar.relaxation.advance_to(60.0, scalar.state), Status::kOk);
        ASSERT_EQ(run.relaxation.advance_to(60.0, run.state), Status::kOk);
        EXPECT_LT(std::abs(scalar.state.x_m.back()), particles);
        EXPECT_TRUE(same_bits(scalar.state.x_m, run.state.x_m)) << particles << " particles";
        EXPECT_TRUE(same_bits(scalar.state.y_m, run.state.y_m)) << particles << " particles";
    }
}

TEST_P(RelaxationKernels, LeaveAFoldedRopeAloneWhereItsBarsHaveNoLength) {
    // Particles in turn in two places, weightless and at rest: bars of even reach have no length, ever.
    RopeDef rope = study::report_rope(50);
    for (std::size_t i = 0; i < rope.points_m.size(); ++i) rope.points_m[i] = {0.0, i % 2 == 0 ? 0.0 : -1.0};
    SolverDef solver = test::relaxation();
    solver.force_n = Vec2{};
    const System system = build_system({&rope, 1}, 7);
    KernelRun run(system, solver, GetParam());
    ASSERT_EQ(run.relaxation.advance_to(2.0, run.state), Status::kOk);
    EXPECT_EQ(run.state.x_m, system.x_m);
    EXPECT_EQ(run.state.y_m, system.y_m);
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(RelaxationKernels);
INSTANTIATE_TEST_SUITE_P(Other, RelaxationKernels, testing::ValuesIn(relaxation_kernels().subspan(1)));

TEST(RelaxationKernelChoice, BeginsWithTheScalarOneAndHasSse2OnX86) {
    const auto kernels = relaxation_kernels();
    ASSERT_FALSE(kernels.empty());
    EXPECT_EQ(kernels.front(), RelaxationKernel::kScalar);
#if defined(__x86_64__)
    ASSERT_GE(kernels.size(), 2U);
    EXPECT_EQ(kernels[1], RelaxationKernel::kSse2);
#endif
}

/// The bars of a system, each recognised by its rest length.
std::vector<RelaxationBar> numbered_bars(const System& system) {
    std::vector<RelaxationBar> bars;
    for (const Bar& bar : system.bars) bars.push_back({bar.a, bar.b, static_cast<double>(bars.size())});
    return bars;
}

/// What happens to each particle, in its order: -1 for Verlet's update, else the number of the bar.
using Events = std::vector<std::vector<int>>;

Events events_in_order(const std::vector<RelaxationBar>& bars, std::size_t particles, int passes) {
    Events events(particles);
    for (int pass = 0; pass < passes; ++pass) {
        for (auto& of_particle : events) of_particle.push_back(-1);
        for (std::size_t k = 0; k < bars.size(); ++k) {
            events[bars[k].a].push_back(static_cast<int>(k));
            events[bars[k].b].push_back(static_cast<int>(k));
        }
    }
    return events;
}

/// Packet k and what comes ahead of it; false where two of its bars have a particle in common.
bool replay_packet(const RelaxationSchedule& schedule, std::size_t k, Events& events) {
    for (std::uint32_t j = schedule.update_begin[k]; j < schedule.update_begin[k + 1]; ++j)
        events[schedule.updates[j]].push_back(-1);
    const RelaxationPacket& packet = schedule.packets[k];
    std::map<std::uint32_t, double> bar_of;
    for (std::size_t lane = 0; lane < RelaxationPacket::kLanes; ++lane) {
        for (const std::uint32_t at : {packet.a[lane], packet.b[lane]}) {
            const auto [found, is_new] = bar_of.emplace(at / 2, packet.rest_m[lane]);
            if (!is_new && found->second != packet.rest_m[lane]) return false;
        }
    }
    for (const auto& [particle, bar] : bar_of) events[particle].push_back(static_cast<int>(bar));
    return true;
}

TEST(RelaxationSchedule, KeepsTheOrderForEveryParticleWithPassesAtTheirLag) {
    for (unsigned seed = 0; seed < 100; ++seed) {
        Random random(seed);
        const System system = random_system(random);
        const std::vector<RelaxationBar> bars = numbered_bars(system);
        const auto particles = static_cast<std::uint32_t>(system.particle_count());
        const RelaxationSchedule schedule = schedule_bars(bars, 0, particles);
        const std::size_t length = schedule.packets.size();
        ASSERT_GE(schedule.lag, 1U);
        ASSERT_LE(schedule.lag, length);
        constexpr int kPasses = 3;
        Events events(particles);
        // The later pass first: at a time, its packet may not need the earlier one's.
        for (std::size_t time = 0; time < length + (kPasses - 1) * schedule.lag; ++time) {
            for (std::size_t pass = kPasses; pass-- > 0;) {
                const std::size_t start = pass * schedule.lag;
                if (time < start || time - start >= length) continue;
                ASSERT_TRUE(replay_packet(schedule, time - start, events)) << "seed " << seed;
            }
        }
        ASSERT_EQ(events, events_in_order(bars, particles, kPasses)) << "seed " << seed;
    }
}

TEST(RelaxationSchedule, FillsItsLanesAndOverlapsThePassesOfALongRope) {
    const RopeDef rope = study::report_rope(1000);
    const System system = build_system({&rope, 1}, 7);
    const RelaxationSchedule schedule = schedule_bars(numbered_bars(system), 0, 1000);
    // 6972 bars fill 1743 packets at best; measured 1747.
    EXPECT_LE(schedule.packets.size(), 1760U);
    // The reaches' wavefront takes 2 + 3 + ... + 8 = 35 particles, 7 bars each: 61 packets; measured 63.
    EXPECT_LE(schedule.lag, 70U);
    // 999 bars of reach 1, one after the other, and the longer ones behind them; measured 1005.
    EXPECT_GE(schedule.levels, 999U);
    EXPECT_LE(schedule.levels, 1010U);
}

TEST(RelaxationSchedule, OfABodyWithoutBarsUpdatesItsParticles) {
    const RelaxationSchedule schedule = schedule_bars({}, 5, 3);
    EXPECT_TRUE(schedule.packets.empty());
    EXPECT_EQ(schedule.updates, (std::vector<std::uint32_t>{5, 6, 7}));
}

}  // namespace
}  // namespace corda::sim
