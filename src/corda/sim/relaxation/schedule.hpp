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

/// Up to four bars without a common particle. Unused lanes repeat bars: 0 1 0 1 if there are two, 0 1 2 2 if
/// there are three.
struct alignas(64) RelaxationPacket {
    static constexpr std::size_t kLanes = 4;

    std::array<double, kLanes> rest_m{};
    std::array<std::uint32_t, kLanes> a{};  ///< index of the x of a bar's first particle: 2 * the particle's
    std::array<std::uint32_t, kLanes> b{};
};

/// Shares of the adjustments that the particles of a packet take. Few different ones occur: large ropes are
/// bound by the memory that they read, so packets refer to them.
struct alignas(64) PacketShares {
    std::array<double, RelaxationPacket::kLanes> a{0.5, 0.5, 0.5, 0.5};
    std::array<double, RelaxationPacket::kLanes> b{0.5, 0.5, 0.5, 0.5};

    auto operator<=>(const PacketShares&) const = default;
};

/// Sweeps over the bars of some bodies, in packets for the SIMD kernels (kernels.hpp).
///
/// Each bar goes into the first packet that has room, after those of all earlier bars that share a particle
/// with it. So every particle meets its bars in the given order, at most one per packet, and every number has
/// the bits of that order. The same holds from sweep to sweep, and for Verlet's update of a particle at most
/// `block` - 1 packets ahead of its first one.
struct PackedSweeps {
    struct Update {
        std::uint32_t particle = 0;
        std::uint32_t stage = 0;
    };
    static constexpr std::size_t kMaxStages = 64;
    static constexpr std::uint8_t kFree = 0;  ///< index of the shares of four bars without pinned particles

    std::vector<RelaxationPacket> packets;
    std::vector<PacketShares> shares;       ///< all that occur
    std::vector<std::uint8_t> share_index;  ///< per packet: an index of `shares`
    /// Per packet and lane: the stage (RelaxationSchedule::overlapping), kMaxStages - 1 for an unused lane.
    std::vector<std::array<std::uint8_t, RelaxationPacket::kLanes>> stage;
    /// In the order of the first packet of their particles; those without a bar come first.
    std::vector<Update> updates;
    /// Packet k is preceded by the updates[j] with update_begin[k] <= j < update_begin[k + 1].
    std::vector<std::uint32_t> update_begin;
    /// Number of packets whose updates may be made together.
    std::size_t block = 1;
    std::size_t stages = 1;
};

/// Packets for all numbers of sweeps.
struct RelaxationSchedule {
    /// One sweep. The next one may begin while it is running, as long as it stays `lag` packets behind.
    PackedSweeps alone;
    /// Packet k of a sweep comes after packet k + lag - 1 of the sweep before; 1 .. number of packets.
    std::size_t lag = 1;
    /// Length of the longest row of bars each of which has to wait for its predecessor.
    std::size_t levels = 0;
    /// Many sweeps, for bodies that would leave lanes or the CPU without work; no packets for others. A sweep
    /// begins each time the packets run, and takes `stages` times (modulo scheduling: Rau and Glaeser 1981):
    /// in run r, a lane or update of stage s works for sweep r - s. Bars come some packets after those that
    /// they depend on.
    PackedSweeps overlapping;
};

/// Schedules `bars`, to be relaxed in this order, of the `particle_count` particles from `first_particle` on;
/// no bar may join others. Takes time and memory in proportion to the bars and particles.
[[nodiscard]] RelaxationSchedule schedule_bars(std::span<const RelaxationBar> bars,
                                               std::uint32_t first_particle, std::uint32_t particle_count);

}  // namespace corda::sim
