#include "corda/sim/relaxation/schedule.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace corda::sim {
namespace {

constexpr std::size_t kLanes = RelaxationPacket::kLanes;

/// Verlet's updates that are made together where a rope is long enough, whose loop is then predictable.
constexpr std::size_t kUpdatesAtOnce = 8;
/// Minimum number of such blocks in overlapping sweeps, which updates ahead keep apart.
constexpr std::size_t kMinBlocks = 16;

/// Number of packets from which several sweeps over the same ones fill the CPU, and read memory once.
constexpr std::size_t kManyPackets = 500;

/// Stage of an unused lane, which is never active.
constexpr std::uint8_t kNoStage = PackedSweeps::kMaxStages - 1;

/// 0, 1, ... ordered by key[i]; indices of equal keys stay in order.
std::vector<std::uint32_t> sorted_by(const std::vector<std::uint32_t>& key) {
    std::vector<std::uint32_t> place(key.empty() ? 1 : *std::max_element(key.begin(), key.end()) + 2U, 0);
    for (const std::uint32_t k : key) ++place[k + 1U];
    std::partial_sum(place.begin(), place.end(), place.begin());
    std::vector<std::uint32_t> order(key.size());
    for (std::uint32_t i = 0; i < key.size(); ++i) order[place[key[i]]++] = i;
    return order;
}

/// Times of the bars of a sweep, in packets since its start.
class Timing {
  public:
    Timing(std::span<const RelaxationBar> bars, std::uint32_t first_particle, std::uint32_t particle_count)
        : bars_(bars),
          first_particle_(first_particle),
          first_(particle_count),
          end_(particle_count),
          time_(bars.size()) {
        std::vector<std::uint32_t> level;
        level.reserve(bars.size());
        for (const RelaxationBar& bar : bars) {
            std::uint32_t& of_a = end_[bar.a - first_particle_];
            std::uint32_t& of_b = end_[bar.b - first_particle_];
            level.push_back(std::max(of_a, of_b));
            of_a = of_b = level.back() + 1U;
            levels_ = std::max(levels_, of_a);
        }
        order_ = sorted_by(level);
    }

    /// Finds times for sweeps that begin every `period` packets, or returns false. A bar comes at least
    /// `distance` packets after the last one that it depends on, and updates may be `block` - 1 packets
    /// early.
    bool find_times(std::uint32_t period, std::uint32_t distance, std::size_t block) {
        period_ = period;
        std::fill(first_.begin(), first_.end(), kNone);
        std::fill(end_.begin(), end_.end(), 0U);
        std::vector<std::uint8_t> filled(period, 0);
        next_.resize(period);
        std::iota(next_.begin(), next_.end(), 0U);
        for (const std::uint32_t bar : order_) {
            const std::array particles{bars_[bar].a - first_particle_, bars_[bar].b - first_particle_};
            std::uint32_t from = 0;
            for (const std::uint32_t i : particles)
                if (first_[i] != kNone) from = std::max(from, end_[i] - 1 + distance);
            const std::uint32_t slot = with_room(from % period);
            const std::uint32_t time = from + (slot + period - from % period) % period;
            if (++filled[slot] == kLanes) next_[slot] = (slot + 1U) % period;
            time_[bar] = time;
            for (const std::uint32_t i : particles) {
                first_[i] = std::min(first_[i], time);
                end_[i] = time + 1;
                if (end_[i] - first_[i] + block > period + 1) return false;
            }
            if (time / period >= kNoStage) return false;
        }
        std::replace(first_.begin(), first_.end(), kNone, 0U);
        return true;
    }

    [[nodiscard]] std::uint32_t levels() const { return levels_; }
    [[nodiscard]] std::uint32_t period() const { return period_; }
    [[nodiscard]] const std::vector<std::uint32_t>& times() const { return time_; }
    /// Times of the first bar of each particle; 0 for one without a bar.
    [[nodiscard]] const std::vector<std::uint32_t>& first() const { return first_; }
    /// The longest time from the first to the last bar of a particle, both included.
    [[nodiscard]] std::size_t lag() const {
        std::uint32_t lag = 1;
        for (std::size_t i = 0; i < end_.size(); ++i)
            lag = std::max(lag, end_[i] - std::min(first_[i], end_[i]));
        return lag;
    }

  private:
    static constexpr auto kNone = static_cast<std::uint32_t>(-1);

    /// The first packet from `k` on, cyclically, that has room. Paths are halved on the way, so that a long
    /// row of full packets is walked once.
    std::uint32_t with_room(std::uint32_t k) {
        while (next_[k] != k) {
            next_[k] = next_[next_[k]];
            k = next_[k];
        }
        return k;
    }

    std::span<const RelaxationBar> bars_;
    std::uint32_t first_particle_;
    std::uint32_t levels_ = 0;
    std::uint32_t period_ = 1;
    std::vector<std::uint32_t> order_;  ///< by level: bars of one level are independent
    std::vector<std::uint32_t> first_;
    std::vector<std::uint32_t> end_;
    std::vector<std::uint32_t> time_;
    std::vector<std::uint32_t> next_;  ///< k if packet k has room, else a later packet
};

/// Adds a packet of up to four bars.
void add_packet(std::span<const RelaxationBar> bars, std::span<const std::uint32_t> chosen,
                const Timing& timing, PackedSweeps& sweeps) {
    RelaxationPacket packet;
    PacketShares shares{{}, {}};
    std::array<std::uint8_t, kLanes> stage{};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        stage[lane] = kNoStage;
        if (chosen.empty()) continue;
        const bool is_used = lane < chosen.size();
        const std::size_t i = is_used ? lane : (chosen.size() == 3 ? 2 : lane % chosen.size());
        const RelaxationBar& bar = bars[chosen[i]];
        packet.rest_m[lane] = bar.rest_m;
        packet.a[lane] = 2U * bar.a;
        packet.b[lane] = 2U * bar.b;
        shares.a[lane] = bar.share_a;
        shares.b[lane] = bar.share_b;
        if (!is_used) continue;
        stage[lane] = static_cast<std::uint8_t>(timing.times()[chosen[i]] / timing.period());
        sweeps.stages = std::max<std::size_t>(sweeps.stages, stage[lane] + 1U);
    }
    sweeps.packets.push_back(packet);
    sweeps.stage.push_back(stage);
    // kFree is for four bars.
    const auto known =
        std::find(sweeps.shares.begin() + (chosen.size() < kLanes ? 1 : 0), sweeps.shares.end(), shares);
    sweeps.share_index.push_back(static_cast<std::uint8_t>(known - sweeps.shares.begin()));
    if (known == sweeps.shares.end()) sweeps.shares.push_back(shares);
}

PackedSweeps pack(std::span<const RelaxationBar> bars, std::uint32_t first_particle, const Timing& timing) {
    const auto within_period = [&](std::vector<std::uint32_t> times) {
        for (std::uint32_t& time : times) time %= timing.period();
        return times;
    };
    const std::vector<std::uint32_t> slot = within_period(timing.times());
    const std::vector<std::uint32_t> update_slot = within_period(timing.first());
    PackedSweeps sweeps;
    sweeps.shares = {PacketShares{}};
    const std::vector<std::uint32_t> order = sorted_by(slot);
    for (std::size_t i = 0; i < order.size();) {
        const std::size_t first = i;
        while (i < order.size() && slot[order[i]] == sweeps.packets.size()) ++i;
        add_packet(bars, std::span(order).subspan(first, i - first), timing, sweeps);
    }
    sweeps.update_begin.assign(sweeps.packets.size() + 1, 0);
    for (const std::uint32_t particle : sorted_by(update_slot)) {
        const std::uint32_t stage = timing.first()[particle] / timing.period();
        sweeps.updates.push_back({first_particle + particle, stage});
        if (!sweeps.packets.empty()) ++sweeps.update_begin[update_slot[particle] + 1U];
    }
    std::partial_sum(sweeps.update_begin.begin(), sweeps.update_begin.end(), sweeps.update_begin.begin());
    return sweeps;
}

/// Packs overlapping sweeps. Returns no packets where a pack of one sweep, `length` packets, does as well.
PackedSweeps overlap(std::span<const RelaxationBar> bars, std::uint32_t first_particle, Timing& timing,
                     std::size_t length) {
    const auto least = static_cast<std::uint32_t>((bars.size() + kLanes - 1) / kLanes);
    if (bars.empty() || (length > kManyPackets && length < least + least / 4)) return {};
    // While a packet waits for its square roots and divisions, the CPU works on those between. A distance of
    // four packets hides the wait; a shorter one is better if the period would get longer by more than this.
    for (const auto& [distance, most] : {std::pair{4U, least + least / 16}, std::pair{3U, least + least / 3},
                                         std::pair{2U, least + least / 2}}) {
        for (std::uint32_t period = least; period <= most; period += 1 + period / 32) {
            const std::size_t block = std::max<std::size_t>(
                2, std::min(kUpdatesAtOnce * period / timing.first().size(), period / kMinBlocks));
            // The kernel has one unfinished packet when it makes updates.
            if (!timing.find_times(period, distance, block + 1)) continue;
            PackedSweeps sweeps = pack(bars, first_particle, timing);
            sweeps.block = block;
            return sweeps;
        }
    }
    return {};
}

}  // namespace

RelaxationSchedule schedule_bars(std::span<const RelaxationBar> bars, std::uint32_t first_particle,
                                 std::uint32_t particle_count) {
    assert(first_particle + particle_count <= 1U << 31U);  // twice an index has to fit
    Timing timing(bars, first_particle, particle_count);
    timing.find_times(static_cast<std::uint32_t>(bars.size()) + 1U, 1, 1);
    RelaxationSchedule schedule;
    schedule.alone = pack(bars, first_particle, timing);
    schedule.lag = timing.lag();
    schedule.levels = timing.levels();
    const std::size_t length = schedule.alone.packets.size();
    // A short rope has fewer sweeps under way, the more its updates run ahead.
    if (length > 2 * std::min<std::size_t>(schedule.lag, schedule.levels))
        schedule.alone.block =
            std::max<std::size_t>(1, kUpdatesAtOnce * length / std::max(1U, particle_count));
    schedule.lag = std::min(schedule.lag + schedule.alone.block - 1, std::max<std::size_t>(1, length));
    schedule.overlapping = overlap(bars, first_particle, timing, length);
    return schedule;
}

}  // namespace corda::sim
