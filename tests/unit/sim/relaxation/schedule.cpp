#include "corda/sim/relaxation/schedule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
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

/// The updates before packet k, if it begins a block, for active stages: bit s for stage s.
void replay_updates(const PackedSweeps& sweeps, std::size_t k, std::uint64_t active, Events& events) {
    if (k % sweeps.block != 0) return;
    const std::size_t end = std::min(k + sweeps.block, sweeps.packets.size());
    for (std::uint32_t j = sweeps.update_begin[k]; j < sweeps.update_begin[end]; ++j) {
        const auto [particle, stage] = sweeps.updates[j];
        if ((active >> stage & 1U) != 0) events[particle].push_back(-1);
    }
}

/// The bars of packet k in active stages. Returns false if two of the packet's bars have a particle in
/// common.
bool replay_packet(const PackedSweeps& sweeps, std::size_t k, std::uint64_t active, Events& events) {
    const RelaxationPacket& packet = sweeps.packets[k];
    std::set<std::uint32_t> particles;
    for (std::size_t lane = 0; lane < RelaxationPacket::kLanes; ++lane) {
        const bool is_used = sweeps.stage[k][lane] < sweeps.stages;
        for (const std::uint32_t at : {packet.a[lane], packet.b[lane]}) {
            if (is_used && !particles.insert(at / 2).second) return false;
            if (is_used && (active >> sweeps.stage[k][lane] & 1U) != 0)
                events[at / 2].push_back(static_cast<int>(packet.rest_m[lane]));
        }
    }
    return true;
}

TEST(RelaxationSchedule, KeepsTheOrderForEveryParticleWithSweepsAtTheirLag) {
    for (unsigned seed = 0; seed < 100; ++seed) {
        test::Random random(seed);
        const System system = test::random_system(random);
        const std::vector<RelaxationBar> bars = numbered_bars(system);
        const auto particles = static_cast<std::uint32_t>(system.particle_count());
        const RelaxationSchedule schedule = schedule_bars(bars, 0, particles);
        const std::size_t length = schedule.alone.packets.size();
        ASSERT_GE(schedule.lag, 1U);
        ASSERT_LE(schedule.lag, length);
        constexpr int kSweeps = 3;
        Events events(particles);
        // The later sweep first: at a time, its packet may not need the earlier one's.
        for (std::size_t time = 0; time < length + (kSweeps - 1) * schedule.lag; ++time) {
            for (std::size_t sweep = kSweeps; sweep-- > 0;) {
                const std::size_t start = sweep * schedule.lag;
                if (time < start || time - start >= length) continue;
                replay_updates(schedule.alone, time - start, 1, events);
                ASSERT_TRUE(replay_packet(schedule.alone, time - start, 1, events)) << "seed " << seed;
            }
        }
        ASSERT_EQ(events, events_in_order(bars, particles, kSweeps)) << "seed " << seed;
    }
}

TEST(RelaxationSchedule, KeepsTheOrderForEveryParticleInOverlappingSweeps) {
    int overlapping = 0;
    for (unsigned seed = 0; seed < 100; ++seed) {
        test::Random random(seed);
        const System system = test::random_system(random);
        const std::vector<RelaxationBar> bars = numbered_bars(system);
        const auto particles = static_cast<std::uint32_t>(system.particle_count());
        const PackedSweeps sweeps = schedule_bars(bars, 0, particles).overlapping;
        if (sweeps.packets.empty()) continue;
        ++overlapping;
        for (const int count : {1, static_cast<int>(sweeps.stages) + 2}) {
            Events events(particles);
            std::uint64_t active = 0;
            for (int run = 0; run < count + static_cast<int>(sweeps.stages) - 1; ++run) {
                active = active << 1U | (run < count ? 1U : 0U);
                // A packet is finished when the next one has begun, after the updates before that.
                for (std::size_t k = 0; k <= sweeps.packets.size(); ++k) {
                    if (k < sweeps.packets.size()) replay_updates(sweeps, k, active, events);
                    if (k == 0) continue;
                    ASSERT_TRUE(replay_packet(sweeps, k - 1, active, events)) << "seed " << seed;
                }
            }
            ASSERT_EQ(events, events_in_order(bars, particles, count)) << "seed " << seed;
        }
    }
    EXPECT_GT(overlapping, 20);
}

TEST(RelaxationSchedule, FillsItsLanesAndOverlapsTheSweepsOfALongRope) {
    const System system = test::report_system(1000);
    const RelaxationSchedule schedule = schedule_bars(numbered_bars(system), 0, 1000);
    // 6972 bars fill 1743 packets at best; measured 1749.
    EXPECT_LE(schedule.alone.packets.size(), 1760U);
    // The reaches' wavefront takes 2 + 3 + ... + 8 = 35 particles, 7 bars each: 62 packets, and updates
    // run 12 packets ahead; measured 76.
    EXPECT_LE(schedule.lag, 82U);
    EXPECT_TRUE(schedule.overlapping.packets.empty());
}

TEST(RelaxationSchedule, FillsTheLanesOfAShortRopeAndKeepsDependentPacketsApart) {
    for (const int reach : {1, 3, 7}) {
        RopeDef rope = reference::report_rope(100);
        rope.reach = reach;
        const System system = build_system({&rope, 1});
        const PackedSweeps sweeps = schedule_bars(numbered_bars(system), 0, 100).overlapping;
        // At best a quarter of 99, 294 and 672 bars: 25, 74, 168; measured 25, 74, 174.
        EXPECT_GT(sweeps.packets.size(), 0U) << reach;
        EXPECT_LE(sweeps.packets.size(), 7 + (system.bars.size() + 3) / 4) << reach;
        std::map<std::uint32_t, std::size_t> last;
        for (std::size_t k = 0; k < sweeps.packets.size(); ++k) {
            std::set<std::uint32_t> particles;
            for (const std::uint32_t at : sweeps.packets[k].a) particles.insert(at);
            for (const std::uint32_t at : sweeps.packets[k].b) particles.insert(at);
            for (const std::uint32_t at : particles) {
                const auto [found, is_new] = last.emplace(at, k);
                EXPECT_TRUE(is_new || k - found->second >= 4U) << reach;
                found->second = k;
            }
        }
    }
}

TEST(RelaxationSchedule, OfABodyWithoutBarsUpdatesItsParticles) {
    const RelaxationSchedule schedule = schedule_bars({}, 5, 3);
    EXPECT_TRUE(schedule.alone.packets.empty());
    EXPECT_TRUE(schedule.overlapping.packets.empty());
    ASSERT_EQ(schedule.alone.updates.size(), 3U);
    for (std::uint32_t i = 0; i < 3; ++i) EXPECT_EQ(schedule.alone.updates[i].particle, 5 + i);
}

}  // namespace
}  // namespace corda::sim
