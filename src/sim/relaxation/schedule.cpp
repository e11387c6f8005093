#include "corda/sim/relaxation/schedule.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace corda::sim {
namespace {

constexpr std::size_t kLanes = RelaxationPacket::kLanes;

/// Verlet's updates that are made together where a rope is long enough, whose loop is then predictable.
constexpr std::size_t kUpdatesAtOnce = 8;

/// Bars of a packet.
struct Lanes {
    std::array<std::uint32_t, kLanes> bars{};  ///< their indices: 0 0 0 0, 0 1 0 1, 0 1 2 2 or 0 1 2 3
    std::size_t count = 0;                     ///< different ones

    void add(std::uint32_t bar) {
        for (std::size_t lane = count; lane < kLanes; lane += count == 1 ? 2 : 1) bars[lane] = bar;
        ++count;
    }
};

/// 0, 1, ... ordered by key[i]; indices of equal keys stay in order.
std::vector<std::uint32_t> sorted_by(const std::vector<std::uint32_t>& key) {
    std::vector<std::uint32_t> place(key.empty() ? 1 : *std::max_element(key.begin(), key.end()) + 2U, 0);
    for (const std::uint32_t k : key) ++place[k + 1U];
    std::partial_sum(place.begin(), place.end(), place.begin());
    std::vector<std::uint32_t> order(key.size());
    for (std::uint32_t i = 0; i < key.size(); ++i) order[place[key[i]]++] = i;
    return order;
}

/// Bars in packets.
class Packing {
  public:
    Packing(std::span<const RelaxationBar> bars, std::uint32_t first_particle, std::uint32_t particle_count)
        : bars_(bars), first_particle_(first_particle), end_of_last_(particle_count, 0) {
        const std::vector<std::uint32_t> level = level_of_bars();
        if (!level.empty()) levels_ = *std::max_element(level.begin(), level.end()) + 1U;
        for (const std::uint32_t bar : sorted_by(level)) place(bar);
    }

    [[nodiscard]] std::size_t size() const { return lanes_.size(); }
    [[nodiscard]] std::size_t levels() const { return levels_; }
    [[nodiscard]] RelaxationPacket packet(std::size_t k) const {
        RelaxationPacket packet;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const RelaxationBar& bar = bars_[lanes_[k].bars[lane]];
            packet.rest_m[lane] = bar.rest_m;
            packet.a[lane] = 2U * bar.a;
            packet.b[lane] = 2U * bar.b;
        }
        return packet;
    }
    [[nodiscard]] PacketShares shares(std::size_t k) const {
        PacketShares shares;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            shares.a[lane] = bars_[lanes_[k].bars[lane]].share_a;
            shares.b[lane] = bars_[lanes_[k].bars[lane]].share_b;
        }
        shares.is_half = lanes_[k].count <= 2;
        return shares;
    }
    /// The number of packets up to and including the last one of each particle.
    [[nodiscard]] const std::vector<std::uint32_t>& end_of_last() const { return end_of_last_; }
    /// The first packet of each particle; 0 for one without a bar.
    [[nodiscard]] std::vector<std::uint32_t> first() const {
        std::vector<std::uint32_t> first(end_of_last_.size(), 0);
        for (std::size_t k = lanes_.size(); k-- > 0;) {
            for (const std::uint32_t bar : lanes_[k].bars) {
                first[bars_[bar].a - first_particle_] = static_cast<std::uint32_t>(k);
                first[bars_[bar].b - first_particle_] = static_cast<std::uint32_t>(k);
            }
        }
        return first;
    }

  private:
    /// One more than the level of the last bar before it that it depends on: bars of one level are
    /// independent.
    [[nodiscard]] std::vector<std::uint32_t> level_of_bars() const {
        std::vector<std::uint32_t> next(end_of_last_.size(), 0);
        std::vector<std::uint32_t> level;
        level.reserve(bars_.size());
        for (const RelaxationBar& bar : bars_) {
            std::uint32_t& of_a = next[bar.a - first_particle_];
            std::uint32_t& of_b = next[bar.b - first_particle_];
            level.push_back(std::max(of_a, of_b));
            of_a = of_b = level.back() + 1U;
        }
        return level;
    }

    /// The first packet from `k` on that has room. Paths are halved on the way, so that a long row of full
    /// packets is walked once.
    std::uint32_t with_room(std::uint32_t k) {
        while (next_[k] != k) {
            next_[k] = next_[next_[k]];
            k = next_[k];
        }
        return k;
    }

    void place(std::uint32_t bar) {
        std::uint32_t& of_a = end_of_last_[bars_[bar].a - first_particle_];
        std::uint32_t& of_b = end_of_last_[bars_[bar].b - first_particle_];
        const std::uint32_t k = with_room(std::max(of_a, of_b));
        if (k == lanes_.size()) {
            lanes_.emplace_back();
            next_.push_back(k + 1U);
        }
        lanes_[k].add(bar);
        if (lanes_[k].count == kLanes) next_[k] = k + 1U;
        of_a = of_b = k + 1U;
    }

    std::span<const RelaxationBar> bars_;
    std::uint32_t first_particle_;
    std::vector<std::uint32_t> end_of_last_;
    std::size_t levels_ = 0;
    std::vector<Lanes> lanes_;
    std::vector<std::uint32_t> next_ = {0};  ///< k if packet k has room, else a later packet
};

}  // namespace

RelaxationSchedule schedule_bars(std::span<const RelaxationBar> bars, std::uint32_t first_particle,
                                 std::uint32_t particle_count) {
    assert(first_particle + particle_count <= 1U << 31U);  // twice an index has to fit
    const Packing packing(bars, first_particle, particle_count);
    RelaxationSchedule schedule;
    const std::size_t length = packing.size();
    schedule.packets.reserve(length);
    schedule.shares = {PacketShares{}, PacketShares{.is_half = true}};
    std::size_t half = 0;
    for (std::size_t k = 0; k < packing.size(); ++k) {
        schedule.packets.push_back(packing.packet(k));
        const PacketShares shares = packing.shares(k);
        const auto known = std::find(schedule.shares.begin(), schedule.shares.end(), shares);
        schedule.share_index.push_back(static_cast<std::uint8_t>(known - schedule.shares.begin()));
        if (known == schedule.shares.end()) schedule.shares.push_back(shares);
        half += shares.is_half ? 1 : 0;
    }
    schedule.is_narrow = 2 * half > length;
    const std::vector<std::uint32_t> first = packing.first();
    schedule.updates = sorted_by(first);
    schedule.update_begin.assign(packing.size() + 1, particle_count);
    for (std::uint32_t j = particle_count, k = static_cast<std::uint32_t>(packing.size()); k-- > 0;) {
        while (j > 0 && first[schedule.updates[j - 1U]] >= k) --j;
        schedule.update_begin[k] = j;
    }
    for (std::uint32_t i = 0; i < particle_count; ++i) {
        const std::uint32_t end = packing.end_of_last()[i];
        if (end > first[i]) schedule.lag = std::max<std::size_t>(schedule.lag, end - first[i]);
    }
    schedule.levels = packing.levels();
    // A short rope has fewer sweeps under way, the more its updates run ahead.
    if (length > 2 * std::min(schedule.lag, schedule.levels))
        schedule.block = std::max<std::size_t>(1, kUpdatesAtOnce * length / std::max(1U, particle_count));
    schedule.lag = std::min(schedule.lag + schedule.block - 1, std::max<std::size_t>(1, length));
    for (std::uint32_t& particle : schedule.updates) particle += first_particle;
    return schedule;
}

}  // namespace corda::sim
