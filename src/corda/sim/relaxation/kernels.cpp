#include "corda/sim/relaxation/kernels.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "corda/core/cpu.hpp"
#include "corda/sim/defs.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace corda::sim {
namespace {

/// x and y. In memory they are read and written together: a CPU forwards no two halves to a read of both.
using Two [[gnu::vector_size(16)]] = double;

CORDA_INLINE Two load(const double* from) {
    Two value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

CORDA_INLINE void store(double* to, Two value) {
    std::memcpy(to, &value, sizeof value);
}

/// d <- (1 - delta) d + (h^2 / m) f, current <- current + d, after d has taken up what the bars moved.
CORDA_INLINE void update(RelaxationMove& verlet, double* position_m, double keep) {
    const Two before_m = load(position_m);
    const Two last_m = load(verlet.move_m.data()) + (before_m - load(verlet.unrelaxed_m.data()));
    const Two move_m = keep * last_m + load(verlet.push_m.data());
    const Two after_m = before_m + move_m;
    store(verlet.last_move_m.data(), last_m);
    store(verlet.move_m.data(), move_m);
    store(verlet.unrelaxed_m.data(), after_m);
    store(position_m, after_m);
}

/// Moves the particles at `a` and `b` by their shares of the bar's adjustment.
CORDA_INLINE void relax(double* a, double* b, double rest_m, double share_a) {
    const Two from = load(a);
    const Two to = load(b);
    const Two along = to - from;
    const double distance = length(along[0], along[1]);
    // Two particles in one place have no direction; other bars separate them.
    if (distance == 0.0) return;
    const Two move = along / distance * (distance - rest_m);
    store(a, from + share_a * move);
    store(b, to - (1.0 - share_a) * move);
}

#if defined(__x86_64__)

/// Maximum number of concurrent sweeps over the same packets. Three hide a bar's latency if the rope is long
/// enough; more help ropes of few bars per packet, and share the memory reads of a rope too large for the
/// caches.
constexpr std::size_t kSweepsAtOnce = 6;

/// A sweep in progress.
struct Cursor {
    std::size_t packet = 0;  ///< the next one
    bool updates = false;    ///< this sweep is the first of a step
};

/// The numbers of two particles, or of bars in lanes 0 and 2 or 1 and 3: x and y of one, then of the other.
CORDA_AVX2 CORDA_INLINE __m256d load_two(const double* first, const double* second) {
    return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(first)), _mm_loadu_pd(second), 1);
}
CORDA_AVX2 CORDA_INLINE void store_two(double* first, double* second, __m256d value) {
    _mm_storeu_pd(first, _mm256_castpd256_pd128(value));
    _mm_storeu_pd(second, _mm256_extractf128_pd(value, 1));
}
/// Numbers of lanes 0 and 2, and of lanes 1 and 3, for x and y.
CORDA_AVX2 CORDA_INLINE __m256d even(__m256d lanes) {
    return _mm256_movedup_pd(lanes);
}
CORDA_AVX2 CORDA_INLINE __m256d odd(__m256d lanes) {
    return _mm256_permute_pd(lanes, 0xf);
}

/// Subtracts 0 where a particle stays, which changes no number; to add it would change -0.
CORDA_AVX2 CORDA_INLINE __m256d moved(__m256d at, __m256d toward, __m256d by, __m256d stays) {
    return _mm256_sub_pd(at, _mm256_andnot_pd(stays, _mm256_mul_pd(toward, by)));
}

/// Relaxes the bars of a packet.
CORDA_AVX2 CORDA_INLINE void relax_packet(const RelaxationPacket& packet, double* position_m) {
    double* const a[4] = {position_m + packet.a[0], position_m + packet.a[1], position_m + packet.a[2],
                          position_m + packet.a[3]};
    double* const b[4] = {position_m + packet.b[0], position_m + packet.b[1], position_m + packet.b[2],
                          position_m + packet.b[3]};
    if (a[0] == a[1]) return relax(a[0], b[0], packet.rest_m[0], packet.share_a[0]);  // one bar
    const __m256d even_a = load_two(a[0], a[2]);
    const __m256d odd_a = load_two(a[1], a[3]);
    const __m256d even_b = load_two(b[0], b[2]);
    const __m256d odd_b = load_two(b[1], b[3]);
    const __m256d even_along = _mm256_sub_pd(even_b, even_a);
    const __m256d odd_along = _mm256_sub_pd(odd_b, odd_a);
    const __m256d even_square = _mm256_mul_pd(even_along, even_along);
    const __m256d odd_square = _mm256_mul_pd(odd_along, odd_along);
    const __m256d distance = _mm256_sqrt_pd(_mm256_add_pd(_mm256_unpacklo_pd(even_square, odd_square),
                                                          _mm256_unpackhi_pd(even_square, odd_square)));
    const __m256d is_zero = _mm256_cmp_pd(distance, _mm256_setzero_pd(), _CMP_EQ_OQ);
    const __m256d even_toward = _mm256_div_pd(even_along, even(distance));
    const __m256d odd_toward = _mm256_div_pd(odd_along, odd(distance));
    // Shares are 0, 1/2 or 1: their products are exact, so they may come first.
    const __m256d adjust = _mm256_sub_pd(distance, _mm256_load_pd(packet.rest_m.data()));
    const __m256d share_a = _mm256_load_pd(packet.share_a.data());
    const __m256d adjust_a = _mm256_mul_pd(_mm256_xor_pd(share_a, _mm256_set1_pd(-0.0)), adjust);
    const __m256d adjust_b = _mm256_mul_pd(_mm256_sub_pd(_mm256_set1_pd(1.0), share_a), adjust);
    store_two(a[0], a[2], moved(even_a, even_toward, even(adjust_a), even(is_zero)));
    store_two(a[1], a[3], moved(odd_a, odd_toward, odd(adjust_a), odd(is_zero)));
    store_two(b[0], b[2], moved(even_b, even_toward, even(adjust_b), even(is_zero)));
    store_two(b[1], b[3], moved(odd_b, odd_toward, odd(adjust_b), odd(is_zero)));
}

/// Runs `packets` packets of each sweep under way, one of each in turn.
CORDA_AVX2 void run_packets(const RelaxationSchedule& schedule, std::span<Cursor> sweeps, std::size_t packets,
                            RelaxationMotion& motion) {
    double* const position_m = motion.position_m.data();
    for (; packets > 0; --packets) {
        for (Cursor& sweep : sweeps) {
            const std::size_t k = sweep.packet++;
            const std::uint32_t end = sweep.updates ? schedule.update_begin[k + 1] : 0;
            for (std::uint32_t j = schedule.update_begin[k]; j < end; ++j) {
                const std::size_t i = schedule.updates[j];
                update(motion.moves[i], position_m + 2 * i, motion.keep);
            }
            relax_packet(schedule.packets[k], position_m);
        }
    }
}

/// Runs sweeps over the same packets, each at least `lag` packets behind its predecessor.
void run_staggered(const RelaxationSchedule& schedule, const RelaxationSweeps& sweeps,
                   RelaxationMotion& motion) {
    const std::size_t length = schedule.packets.size();
    std::array<Cursor, kSweepsAtOnce> cursors;
    std::size_t under_way = 0;
    std::uint64_t next = sweeps.begin;
    const auto may_begin = [&] { return next < sweeps.end && under_way < kSweepsAtOnce; };
    while (next < sweeps.end || under_way > 0) {
        if (may_begin() && (under_way == 0 || cursors[under_way - 1].packet >= schedule.lag)) {
            cursors[under_way++] = {0, sweeps.updates_before(next)};
            ++next;
        }
        // Up to where the next sweep begins or the first one ends.
        std::size_t packets = length - cursors[0].packet;
        if (may_begin()) packets = std::min(packets, schedule.lag - cursors[under_way - 1].packet);
        run_packets(schedule, std::span(cursors).first(under_way), packets, motion);
        if (cursors[0].packet < length) continue;
        std::copy(cursors.begin() + 1, cursors.begin() + under_way, cursors.begin());
        --under_way;
    }
}

#endif

}  // namespace

void run_sweeps(std::span<const RelaxationBar> bars, const RelaxationSweeps& sweeps,
                RelaxationMotion& motion) {
    double* const position = motion.position_m.data();
    for (std::uint64_t sweep = sweeps.begin; sweep < sweeps.end; ++sweep) {
        if (sweeps.updates_before(sweep)) {
            for (std::size_t i = 0; i < motion.moves.size(); ++i)
                update(motion.moves[i], position + 2 * i, motion.keep);
        }
        for (const RelaxationBar& bar : bars) {
            relax(position + std::size_t{2} * bar.a, position + std::size_t{2} * bar.b, bar.rest_m,
                  bar.share_a);
        }
    }
}

std::span<const RelaxationKernel> relaxation_kernels() {
    static constexpr std::array kKernels{RelaxationKernel::kScalar, RelaxationKernel::kAvx2};
#if defined(__x86_64__)
    return std::span(kKernels).first(__builtin_cpu_supports("avx2") != 0 ? 2 : 1);
#else
    return std::span(kKernels).first(1);
#endif
}

void run_sweeps([[maybe_unused]] const RelaxationSchedule& schedule,
                [[maybe_unused]] const RelaxationSweeps& sweeps, [[maybe_unused]] RelaxationMotion& motion) {
#if defined(__x86_64__)
    if (!schedule.packets.empty()) return run_staggered(schedule, sweeps, motion);
    for (std::uint64_t sweep = sweeps.begin; sweep < sweeps.end; ++sweep) {
        if (!sweeps.updates_before(sweep)) continue;
        for (const std::size_t i : schedule.updates)
            update(motion.moves[i], motion.position_m.data() + 2 * i, motion.keep);
    }
#endif
}

}  // namespace corda::sim
