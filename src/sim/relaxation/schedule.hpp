#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace corda::sim {

/// A bar as relaxation needs it. At least one of its particles is free.
struct RelaxationBar {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    double rest_m = 0.0;
    double share_a = 0.5;  ///< of the adjustment that particle a takes: 0, 1/2 or 1
    double share_b = 0.5;
};

/// Up to four bars without a common particle. Bars repeat in lanes without one: computed from the same
/// numbers and stored again, a bar is still relaxed once. Lanes 2 and 3 are unused if there are at most two
/// bars.
struct alignas(64) RelaxationPacket {
    static constexpr std::size_t kLanes = 4;

    std::array<double, kLanes> rest_m{};
    std::array<std::uint32_t, kLanes> a{};  ///< index of the x of a bar's first particle: 2 * the particle's
    std::array<std::uint32_t, kLanes> b{};
};

/// Shares of the adjustments that the particles of a packet take. Few different ones occur: large ropes are
/// bound by the memory that they read, so packets refer to them.
struct PacketShares {
    std::array<double, RelaxationPacket::kLanes> a{0.5, 0.5, 0.5, 0.5};
    std::array<double, RelaxationPacket::kLanes> b{0.5, 0.5, 0.5, 0.5};
    bool is_half = false;  ///< only lanes 0 and 1 are used

    auto operator<=>(const PacketShares&) const = default;
};

/// One sweep over the bars of some bodies, in packets for the SIMD kernel (kernels.hpp).
///
/// Each bar goes into the first packet that has room after the packets of all earlier bars that share a
/// particle with it. So every particle meets its bars in the given order, at most one per packet, and every
/// number has the bits of that order. The same holds from sweep to sweep, and for Verlet's update of a
/// particle at most `block` - 1 packets ahead of its first one: a sweep may begin while its predecessor is
/// running, as long as it stays `lag` packets behind.
struct RelaxationSchedule {
    static constexpr std::uint8_t kFree = 0;  ///< index of the shares of a packet without pinned particles
    static constexpr std::uint8_t kFreeHalf = 1;  ///< the same with lanes 0 and 1 alone

    std::vector<RelaxationPacket> packets;
    std::vector<PacketShares> shares;       ///< all that occur, after those of kFree and kFreeHalf
    std::vector<std::uint8_t> share_index;  ///< per packet: an index of `shares`
    /// Particles in the order of their first packet; those without a bar come first.
    std::vector<std::uint32_t> updates;
    /// Packet k is preceded by the updates[j] with update_begin[k] <= j < update_begin[k + 1].
    std::vector<std::uint32_t> update_begin;
    /// Number of packets whose updates may be made together.
    std::size_t block = 1;
    /// Packet k of a sweep comes after packet k + lag - 1 of the sweep before; 1 .. number of packets.
    std::size_t lag = 1;
    /// Length of the longest row of bars each of which has to wait for its predecessor.
    std::size_t levels = 0;
    bool is_narrow = false;  ///< most packets have at most two bars
};

/// Schedules `bars`, to be relaxed in this order, of the `particle_count` particles from `first_particle` on;
/// no bar may join others. Takes time and memory in proportion to the bars and particles.
[[nodiscard]] RelaxationSchedule schedule_bars(std::span<const RelaxationBar> bars,
                                               std::uint32_t first_particle, std::uint32_t particle_count);

}  // namespace corda::sim
