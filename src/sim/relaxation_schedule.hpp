#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace corda::sim {

/// A bar as a pass of relaxation sees it. At least one of its particles is free.
struct RelaxationBar {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    double rest_m = 0.0;
    double share_a = 0.5;  ///< of the adjustment: 0, 1/2 or 1
    double share_b = 0.5;
};

/// Four bars without a common particle, relaxed at once. Where there are fewer, one stands in several lanes:
/// computed from the same numbers and stored again, it is still relaxed once. A packet of one or two bars has
/// them in lanes 0 and 1 and once more in lanes 2 and 3; one of three has the third in lanes 2 and 3.
struct alignas(64) RelaxationPacket {
    static constexpr std::size_t kLanes = 4;

    std::array<double, kLanes> rest_m{};
    std::array<std::uint32_t, kLanes> a{};  ///< where the x of a bar's first particle stands: 2 * its index
    std::array<std::uint32_t, kLanes> b{};

    /// Lanes 2 and 3 repeat the others: at most two bars.
    [[nodiscard]] bool is_half() const { return a[2] == a[0]; }
};

/// What the two particles of each of a packet's bars take of its adjustment, in the order in which a kernel
/// has x and y of the bars: lanes 0 and 2, then lanes 1 and 3, each share twice.
struct alignas(64) PacketShares {
    /// Where the first of a lane's two equal entries is.
    static constexpr std::array<std::size_t, RelaxationPacket::kLanes> kPlaceOfLane{0, 4, 2, 6};

    std::array<double, 2 * RelaxationPacket::kLanes> a{};
    std::array<double, 2 * RelaxationPacket::kLanes> b{};

    auto operator<=>(const PacketShares&) const = default;
};

/// One pass over the bars of some bodies, put into packets for a kernel (relaxation_kernels.hpp).
///
/// A bar's level is one more than that of the last bar before it that has a particle in common with it. Bars
/// of one level are independent, and a rope's levels are a wavefront: level t holds bar (t, t + 1) of reach 1
/// and behind it one bar of each longer reach, or more where the shorter reaches have come to the rope's end.
/// Packets are filled level by level, each bar in the first packet that has room behind the packets of its
/// particles' bars before. So every particle meets its bars in the given order, one a packet, and since a bar
/// reads and writes its two particles alone, every number is the one that the given order yields, bit for
/// bit.
///
/// The same holds from pass to pass, and with Verlet's update of a particle, which comes just ahead of its
/// first packet: a pass may begin while the one before is under way, as long as it stays `lag` packets
/// behind.
struct RelaxationSchedule {
    std::vector<RelaxationPacket> packets;
    /// Particles in the order of their first packet; those without a bar come first.
    std::vector<std::uint32_t> updates;
    /// Packet k is preceded by the updates[j] with update_begin[k] <= j < update_begin[k + 1].
    std::vector<std::uint32_t> update_begin;
    std::vector<PacketShares> shares;        ///< all that occur
    std::vector<std::uint32_t> share_index;  ///< a packet: its place in `shares`
    /// The most bars that have to wait for one another, each for the one before.
    std::size_t levels = 0;
    /// Packet k of a pass comes after packet k + lag - 1 of the pass before; from 1 to the number of packets.
    std::size_t lag = 1;
};

/// Schedules `bars`, to be relaxed in this order, of the `particle_count` particles from `first_particle` on;
/// no bar may leave them. Takes time and memory in proportion to the bars and particles.
[[nodiscard]] RelaxationSchedule schedule_bars(std::span<const RelaxationBar> bars,
                                               std::uint32_t first_particle, std::uint32_t particle_count);

}  // namespace corda::sim
