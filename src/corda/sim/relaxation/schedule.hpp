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
    double share_a = 0.5;  ///< of the adjustment that particle a takes: 0, 1/2 or 1; b takes the rest
};

/// Up to four bars without a common particle. Unused lanes repeat bars: relaxed from the same numbers and
/// stored again, each is still relaxed once.
struct alignas(32) RelaxationPacket {
    static constexpr std::size_t kLanes = 4;

    std::array<double, kLanes> rest_m{};
    std::array<double, kLanes> share_a{};
    std::array<std::uint32_t, kLanes> a{};  ///< index of the x of a bar's first particle: 2 * the particle's
    std::array<std::uint32_t, kLanes> b{};
};

/// One sweep over the bars of some bodies, in packets for the AVX2 kernel (kernels.hpp).
///
/// Each bar goes into the first packet that has room, after those of all earlier bars that share a particle
/// with it. So every particle meets its bars in the given order, at most one per packet, and every number has
/// the bits of that order. The same holds from sweep to sweep, and for Verlet's update of a particle before
/// its first packet.
struct RelaxationSchedule {
    std::vector<RelaxationPacket> packets;
    /// Particles in the order of their first packet; those without a bar come first.
    std::vector<std::uint32_t> updates;
    /// Packet k is preceded by the updates[j] with update_begin[k] <= j < update_begin[k + 1].
    std::vector<std::uint32_t> update_begin;
    /// A sweep may begin while its predecessor is under way: packet k of it comes after packet k + lag - 1 of
    /// the predecessor; 1 .. number of packets.
    std::size_t lag = 1;
};

/// Schedules `bars`, to be relaxed in this order, of the `particle_count` particles from `first_particle` on;
/// no bar may join others. Takes time and memory in proportion to the bars and particles.
[[nodiscard]] RelaxationSchedule schedule_bars(std::span<const RelaxationBar> bars,
                                               std::uint32_t first_particle, std::uint32_t particle_count);

}  // namespace corda::sim
