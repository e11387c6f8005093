#include "corda/sim/relaxation/schedule.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace corda::sim {
namespace {

/// 0, 1, ... ordered by key[i]; indices of equal keys stay in order.
std::vector<std::uint32_t> sorted_by(const std::vector<std::uint32_t>& key) {
    std::vector<std::uint32_t> place(key.empty() ? 1 : *std::max_element(key.begin(), key.end()) + 2U, 0);
    for (const std::uint32_t k : key) ++place[k + 1U];
    std::partial_sum(place.begin(), place.end(), place.begin());
    std::vector<std::uint32_t> order(key.size());
    for (std::uint32_t i = 0; i < key.size(); ++i) order[place[key[i]]++] = i;
    return order;
}

/// The bars by level: one more than the highest level of the earlier bars that share a particle. Bars of one
/// level are independent.
std::vector<std::uint32_t> by_level(std::span<const RelaxationBar> bars, std::uint32_t first_particle,
                                    std::uint32_t particle_count) {
    std::vector<std::uint32_t> next(particle_count, 0);
    std::vector<std::uint32_t> level;
    level.reserve(bars.size());
    for (const RelaxationBar& bar : bars) {
        std::uint32_t& of_a = next[bar.a - first_particle];
        std::uint32_t& of_b = next[bar.b - first_particle];
        level.push_back(std::max(of_a, of_b));
        of_a = of_b = level.back() + 1U;
    }
    return sorted_by(level);
}

/// Lanes of packets, given out one by one.
class Lanes {
  public:
    explicit Lanes(std::size_t count) : next_(count + 1), taken_(count, 0) {
        std::iota(next_.begin(), next_.end(), 0U);
    }

    /// Takes a lane of the first packet from `k` on that has room. Paths are halved on the way, so that a
    /// long row of full packets is walked once.
    std::uint32_t take(std::uint32_t k) {
        while (next_[k] != k) {
            next_[k] = next_[next_[k]];
            k = next_[k];
        }
        if (++taken_[k] == RelaxationPacket::kLanes) next_[k] = k + 1;
        return k;
    }

  private:
    std::vector<std::uint32_t> next_;  ///< k if packet k has room, else a later packet
    std::vector<std::uint8_t> taken_;
};

/// Packets of the bars, whose places they are.
std::vector<RelaxationPacket> pack(std::span<const RelaxationBar> bars,
                                   const std::vector<std::uint32_t>& place) {
    std::vector<RelaxationPacket> packets;
    const std::vector<std::uint32_t> order = sorted_by(place);
    for (std::size_t i = 0; i < order.size();) {
        const std::size_t first = i;
        while (i < order.size() && place[order[i]] == place[order[first]]) ++i;
        RelaxationPacket& packet = packets.emplace_back();
        for (std::size_t lane = 0; lane < RelaxationPacket::kLanes; ++lane) {
            const RelaxationBar& bar = bars[order[first + lane % (i - first)]];
            packet.rest_m[lane] = bar.rest_m;
            packet.share_a[lane] = bar.share_a;
            packet.a[lane] = 2U * bar.a;
            packet.b[lane] = 2U * bar.b;
        }
    }
    return packets;
}

}  // namespace

RelaxationSchedule schedule_bars(std::span<const RelaxationBar> bars, std::uint32_t first_particle,
                                 std::uint32_t particle_count) {
    assert(first_particle + particle_count <= 1U << 31U);  // twice an index has to fit
    constexpr auto kNone = static_cast<std::uint32_t>(-1);
    std::vector<std::uint32_t> place(bars.size());
    std::vector<std::uint32_t> first(particle_count, kNone);  // packet of each particle
    std::vector<std::uint32_t> end(particle_count, 0);        // after its last packet
    Lanes lanes(bars.size());
    RelaxationSchedule schedule;
    for (const std::uint32_t k : by_level(bars, first_particle, particle_count)) {
        const std::array particles{bars[k].a - first_particle, bars[k].b - first_particle};
        place[k] = lanes.take(std::max(end[particles[0]], end[particles[1]]));
        for (const std::uint32_t i : particles) {
            first[i] = std::min(first[i], place[k]);
            end[i] = place[k] + 1;
            schedule.lag = std::max<std::size_t>(schedule.lag, end[i] - first[i]);
        }
    }
    std::replace(first.begin(), first.end(), kNone, 0U);
    schedule.packets = pack(bars, place);
    schedule.update_begin.assign(schedule.packets.size() + 1, 0);
    for (const std::uint32_t i : sorted_by(first)) {
        schedule.updates.push_back(first_particle + i);
        if (!bars.empty()) ++schedule.update_begin[first[i] + 1U];
    }
    std::partial_sum(schedule.update_begin.begin(), schedule.update_begin.end(),
                     schedule.update_begin.begin());
    return schedule;
}

}  // namespace corda::sim
