#include "corda/sim/relaxation/schedule.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "support/random_system.hpp"

namespace corda::sim {
namespace {

/// The bars of a system, each recognised by its rest length.
std::vector<RelaxationBar> numbered_bars(const System& system) {
    std::vector<RelaxationBar> bars;
    for (const Bar& bar : system.bars) bars.push_back({bar.a, bar.b, static_cast<double>(bars.size())});
    return bars;
}

/// The operations on each particle, in order: -1 for Verlet's update, else the number of the bar.
using Events = std::vector<std::vector<int>>;

Events events_in_order(const std::vector<RelaxationBar>& bars, std::size_t particles, int sweeps) {
    Events events(particles);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (auto& of_particle : events) of_particle.push_back(-1);
        for (std::size_t k = 0; k < bars.size(); ++k) {
            events[bars[k].a].push_back(static_cast<int>(k));
            events[bars[k].b].push_back(static_cast<int>(k));
        }
    }
    return events;
}

/// Packet k and the updates before it.
void replay(const RelaxationSchedule& schedule, std::size_t k, Events& events) {
    for (std::uint32_t j = schedule.update_begin[k]; j < schedule.update_begin[k + 1]; ++j)
        events[schedule.updates[j]].push_back(-1);
    const RelaxationPacket& packet = schedule.packets[k];
    std::set<int> bars;
    std::set<std::uint32_t> particles;
    for (std::size_t lane = 0; lane < RelaxationPacket::kLanes; ++lane) {
        const auto bar = static_cast<int>(packet.rest_m[lane]);
        if (!bars.insert(bar).second) continue;  // repeated in an unused lane
        for (const std::uint32_t at : {packet.a[lane], packet.b[lane]}) {
            EXPECT_TRUE(particles.insert(at / 2).second) << "packet " << k;
            events[at / 2].push_back(bar);
        }
    }
}

TEST(RelaxationSchedule, KeepsTheOrderForEveryParticleWithSweepsAtTheirLag) {
    for (unsigned seed = 0; seed < 100; ++seed) {
        test::Random random(seed);
        const System system = test::random_system(random);
        const std::vector<RelaxationBar> bars = numbered_bars(system);
        const auto particles = static_cast<std::uint32_t>(system.particle_count());
        const RelaxationSchedule schedule = schedule_bars(bars, 0, particles);
        const std::size_t length = schedule.packets.size();
        ASSERT_GE(schedule.lag, 1U);
        ASSERT_LE(schedule.lag, length);
        constexpr int kSweeps = 3;
        Events events(particles);
        // The later sweep first: at a time, its packet may not need the earlier one's.
        for (std::size_t time = 0; time < length + (kSweeps - 1) * schedule.lag; ++time) {
            for (std::size_t sweep = kSweeps; sweep-- > 0;) {
                const std::size_t start = sweep * schedule.lag;
                if (time >= start && time - start < length) replay(schedule, time - start, events);
            }
        }
        ASSERT_EQ(events, events_in_order(bars, particles, kSweeps)) << "seed " << seed;
    }
}

TEST(RelaxationSchedule, FillsItsLanesAndOverlapsTheSweepsOfALongRope) {
    const System system = test::report_system(1000);
    const RelaxationSchedule schedule = schedule_bars(numbered_bars(system), 0, 1000);
    // 6972 bars fill 1743 packets at best; measured 1749.
    EXPECT_LE(schedule.packets.size(), 1760U);
    // The reaches' wavefront takes 2 + 3 + ... + 8 = 35 particles, 7 bars each: 62 packets; measured 64.
    EXPECT_LE(schedule.lag, 70U);
}

TEST(RelaxationSchedule, OfABodyWithoutBarsUpdatesItsParticles) {
    const RelaxationSchedule schedule = schedule_bars({}, 5, 3);
    EXPECT_TRUE(schedule.packets.empty());
    EXPECT_EQ(schedule.updates, (std::vector<std::uint32_t>{5, 6, 7}));
}

}  // namespace
}  // namespace corda::sim
