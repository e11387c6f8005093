#include "corda/sim/relaxation/kernels.hpp"

#include <algorithm>
#include <array>

#include "corda/core/cpu.hpp"
#include "corda/sim/defs.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
// Compiled for AVX2 where a function for AVX2 calls them.
#define CORDA_INLINE [[gnu::always_inline]] inline
#endif

namespace corda::sim {
namespace {

/// d <- (1 - delta) d + (h^2 / m) f, current <- current + d, after d has taken up what the bars moved.
void update(std::size_t k, RelaxationMotion& motion) {
    motion.last_move_m[k] = motion.move_m[k] + (motion.position_m[k] - motion.unrelaxed_m[k]);
    motion.move_m[k] = motion.keep * motion.last_move_m[k] + motion.push_m[k];
    motion.position_m[k] += motion.move_m[k];
    motion.unrelaxed_m[k] = motion.position_m[k];
}

/// Moves the particles at `a` and `b` by their shares of the bar's adjustment.
void relax(double* a, double* b, double rest_m, double share_a, double share_b) {
    const double dx = b[0] - a[0];
    const double dy = b[1] - a[1];
    const double distance = length(dx, dy);
    // Two particles in one place have no direction; other bars separate them.
    if (distance == 0.0) return;
    const double adjust = distance - rest_m;
    const double move_x = dx / distance * adjust;
    const double move_y = dy / distance * adjust;
    a[0] += share_a * move_x;
    a[1] += share_a * move_y;
    b[0] -= share_b * move_x;
    b[1] -= share_b * move_y;
}

#if defined(__x86_64__)

/// Number of concurrent sweeps. Three hide a bar's latency if the rope is long enough; more share the memory
/// reads of a rope too large for the caches.
constexpr std::size_t kSweepsAtOnce = 6;

/// A sweep in progress.
struct Cursor {
    std::size_t packet = 0;  ///< the next one
    bool updates = false;    ///< this sweep is the first of a step
};

/// Pointers into a schedule and a motion.
struct Pointers {
    const RelaxationPacket* packets;
    const std::uint8_t* next_is_independent;
    const std::uint32_t* updates;
    const std::uint32_t* update_begin;
    double* position_m;
    double* move_m;
    double* unrelaxed_m;
    double* last_move_m;
    const double* push_m;
    double keep;
};

/// Relaxes the bars of a packet, one of which has no length.
[[gnu::noinline, gnu::cold]] void relax_one_by_one(const RelaxationPacket& packet, double* position_m) {
    const std::size_t bars = packet.a[0] == packet.a[1] ? 1 : 2;
    for (std::size_t lane = 0; lane < bars; ++lane) {
        relax(position_m + packet.a[lane], position_m + packet.b[lane], packet.rest_m[lane],
              packet.share_a[lane], packet.share_b[lane]);
    }
}

/// Verlet's update of one particle.
CORDA_INLINE void update_particle(const Pointers& p, std::uint32_t particle) {
    const std::size_t at = std::size_t{2} * particle;
    __m128d position = _mm_loadu_pd(p.position_m + at);
    const __m128d last =
        _mm_add_pd(_mm_loadu_pd(p.move_m + at), _mm_sub_pd(position, _mm_loadu_pd(p.unrelaxed_m + at)));
    const __m128d move = _mm_add_pd(_mm_mul_pd(_mm_set1_pd(p.keep), last), _mm_loadu_pd(p.push_m + at));
    position = _mm_add_pd(position, move);
    _mm_storeu_pd(p.last_move_m + at, last);
    _mm_storeu_pd(p.move_m + at, move);
    _mm_storeu_pd(p.unrelaxed_m + at, position);
    _mm_storeu_pd(p.position_m + at, position);
}

CORDA_INLINE void update_before(const Pointers& p, const Cursor& sweep) {
    if (!sweep.updates) return;
    const std::size_t k = sweep.packet;
    for (std::uint32_t j = p.update_begin[k]; j < p.update_begin[k + 1]; ++j)
        update_particle(p, p.updates[j]);
}

/// Relaxes the bars of a packet.
CORDA_INLINE void relax_two(const RelaxationPacket& packet, double* position_m) {
    double* const a0 = position_m + packet.a[0];
    double* const a1 = position_m + packet.a[1];
    double* const b0 = position_m + packet.b[0];
    double* const b1 = position_m + packet.b[1];
    const __m128d at_a0 = _mm_loadu_pd(a0);
    const __m128d at_a1 = _mm_loadu_pd(a1);
    const __m128d at_b0 = _mm_loadu_pd(b0);
    const __m128d at_b1 = _mm_loadu_pd(b1);
    const __m128d along0 = _mm_sub_pd(at_b0, at_a0);
    const __m128d along1 = _mm_sub_pd(at_b1, at_a1);
    const __m128d square0 = _mm_mul_pd(along0, along0);
    const __m128d square1 = _mm_mul_pd(along1, along1);
    const __m128d distance =
        _mm_sqrt_pd(_mm_add_pd(_mm_unpacklo_pd(square0, square1), _mm_unpackhi_pd(square0, square1)));
    if (_mm_movemask_pd(_mm_cmpeq_pd(distance, _mm_setzero_pd())) != 0) [[unlikely]]
        return relax_one_by_one(packet, position_m);
    const __m128d adjust = _mm_sub_pd(distance, _mm_load_pd(packet.rest_m.data()));
    const __m128d move0 =
        _mm_mul_pd(_mm_div_pd(along0, _mm_unpacklo_pd(distance, distance)), _mm_unpacklo_pd(adjust, adjust));
    const __m128d move1 =
        _mm_mul_pd(_mm_div_pd(along1, _mm_unpackhi_pd(distance, distance)), _mm_unpackhi_pd(adjust, adjust));
    _mm_storeu_pd(a0, _mm_add_pd(at_a0, _mm_mul_pd(_mm_set1_pd(packet.share_a[0]), move0)));
    _mm_storeu_pd(a1, _mm_add_pd(at_a1, _mm_mul_pd(_mm_set1_pd(packet.share_a[1]), move1)));
    _mm_storeu_pd(b0, _mm_sub_pd(at_b0, _mm_mul_pd(_mm_set1_pd(packet.share_b[0]), move0)));
    _mm_storeu_pd(b1, _mm_sub_pd(at_b1, _mm_mul_pd(_mm_set1_pd(packet.share_b[1]), move1)));
}

/// Runs the next packet of a sweep.
CORDA_INLINE void advance_one(const Pointers& p, Cursor& sweep) {
    update_before(p, sweep);
    relax_two(p.packets[sweep.packet++], p.position_m);
}

/// Runs `packets` packets of each sweep under way, one of each in turn.
void run_by_sse2(const Pointers& p, std::span<Cursor> sweeps, std::size_t packets) {
    for (; packets > 0; --packets) {
        for (Cursor& sweep : sweeps) advance_one(p, sweep);
    }
}

/// Two pairs of numbers.
CORDA_AVX2 CORDA_INLINE __m256d load_pairs(const double* first, const double* second) {
    return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(first)), _mm_loadu_pd(second), 1);
}

CORDA_AVX2 CORDA_INLINE void store_pairs(double* first, double* second, __m256d pairs) {
    _mm_storeu_pd(first, _mm256_castpd256_pd128(pairs));
    _mm_storeu_pd(second, _mm256_extractf128_pd(pairs, 1));
}

/// The first number of each pair, twice, and the second.
CORDA_AVX2 CORDA_INLINE __m256d first_of(__m256d pairs) {
    return _mm256_movedup_pd(pairs);
}
CORDA_AVX2 CORDA_INLINE __m256d second_of(__m256d pairs) {
    return _mm256_permute_pd(pairs, 0xf);
}

/// Relaxes the bars of two packets without a common particle, as relax_two() does those of one.
CORDA_AVX2 CORDA_INLINE void relax_four(const RelaxationPacket& first, const RelaxationPacket& second,
                                        double* position_m) {
    const __m256d at_a0 = load_pairs(position_m + first.a[0], position_m + second.a[0]);
    const __m256d at_a1 = load_pairs(position_m + first.a[1], position_m + second.a[1]);
    const __m256d at_b0 = load_pairs(position_m + first.b[0], position_m + second.b[0]);
    const __m256d at_b1 = load_pairs(position_m + first.b[1], position_m + second.b[1]);
    const __m256d along0 = _mm256_sub_pd(at_b0, at_a0);
    const __m256d along1 = _mm256_sub_pd(at_b1, at_a1);
    const __m256d square0 = _mm256_mul_pd(along0, along0);
    const __m256d square1 = _mm256_mul_pd(along1, along1);
    const __m256d distance = _mm256_sqrt_pd(
        _mm256_add_pd(_mm256_unpacklo_pd(square0, square1), _mm256_unpackhi_pd(square0, square1)));
    if (_mm256_movemask_pd(_mm256_cmp_pd(distance, _mm256_setzero_pd(), _CMP_EQ_OQ)) != 0) [[unlikely]] {
        relax_one_by_one(first, position_m);
        return relax_one_by_one(second, position_m);
    }
    const __m256d adjust = _mm256_sub_pd(distance, load_pairs(first.rest_m.data(), second.rest_m.data()));
    const __m256d move0 = _mm256_mul_pd(_mm256_div_pd(along0, first_of(distance)), first_of(adjust));
    const __m256d move1 = _mm256_mul_pd(_mm256_div_pd(along1, second_of(distance)), second_of(adjust));
    const __m256d share_a = load_pairs(first.share_a.data(), second.share_a.data());
    const __m256d share_b = load_pairs(first.share_b.data(), second.share_b.data());
    store_pairs(position_m + first.a[0], position_m + second.a[0],
                _mm256_add_pd(at_a0, _mm256_mul_pd(first_of(share_a), move0)));
    store_pairs(position_m + first.a[1], position_m + second.a[1],
                _mm256_add_pd(at_a1, _mm256_mul_pd(second_of(share_a), move1)));
    store_pairs(position_m + first.b[0], position_m + second.b[0],
                _mm256_sub_pd(at_b0, _mm256_mul_pd(first_of(share_b), move0)));
    store_pairs(position_m + first.b[1], position_m + second.b[1],
                _mm256_sub_pd(at_b1, _mm256_mul_pd(second_of(share_b), move1)));
}

/// Runs the next packet of two sweeps, which are at least `lag` apart and so share no particle.
CORDA_AVX2 CORDA_INLINE void advance_two(const Pointers& p, Cursor& first, Cursor& second) {
    update_before(p, first);
    update_before(p, second);
    relax_four(p.packets[first.packet++], p.packets[second.packet++], p.position_m);
}

/// Runs `packets` packets of each of `count` sweeps under way, two at a time: those of two sweeps, or two of
/// the last sweep if the count is odd.
template <std::size_t count>
CORDA_AVX2 void run_count_by_avx2(const Pointers& p, Cursor* under_way, std::size_t packets) {
    std::array<Cursor, count> sweeps;
    std::copy_n(under_way, count, sweeps.begin());
    constexpr std::size_t kPaired = count / 2 * 2;
    for (; packets >= 2; packets -= 2) {
        for (int k = 0; k < 2; ++k) {
            for (std::size_t i = 0; i < kPaired; i += 2) advance_two(p, sweeps[i], sweeps[i + 1]);
        }
        if constexpr (kPaired < count) {
            Cursor& last = sweeps[kPaired];
            if (p.next_is_independent[last.packet] != 0) {
                Cursor next{last.packet + 1, last.updates};
                advance_two(p, last, next);
                last.packet = next.packet;
            } else {
                advance_one(p, last);
                advance_one(p, last);
            }
        }
    }
    if (packets > 0) {
        for (std::size_t i = 0; i < kPaired; i += 2) advance_two(p, sweeps[i], sweeps[i + 1]);
        if constexpr (kPaired < count) advance_one(p, sweeps[kPaired]);
    }
    std::copy_n(sweeps.begin(), count, under_way);
}

void run_by_avx2(const Pointers& p, std::span<Cursor> sweeps, std::size_t packets) {
    static constexpr std::array kRun{run_count_by_avx2<1>, run_count_by_avx2<2>, run_count_by_avx2<3>,
                                     run_count_by_avx2<4>, run_count_by_avx2<5>, run_count_by_avx2<6>};
    static_assert(kRun.size() == kSweepsAtOnce);
    kRun[sweeps.size() - 1](p, sweeps.data(), packets);
}

/// Runs sweeps of `length` packets, each at least `lag` packets behind its predecessor.
void run_staggered(const Pointers& p, const RelaxationSweeps& sweeps, std::size_t length, std::size_t lag,
                   bool is_by_avx2) {
    const auto run_together = is_by_avx2 ? run_by_avx2 : run_by_sse2;
    std::array<Cursor, kSweepsAtOnce> cursors;
    std::size_t under_way = 0;
    std::uint64_t next = sweeps.begin;
    const auto may_begin = [&] { return next < sweeps.end && under_way < cursors.size(); };
    while (next < sweeps.end || under_way > 0) {
        if (may_begin() && (under_way == 0 || cursors[under_way - 1].packet >= lag)) {
            cursors[under_way++] = {0, sweeps.updates_before(next)};
            ++next;
        }
        // Up to where the next sweep begins or the first one ends.
        std::size_t packets = length - cursors[0].packet;
        if (may_begin()) packets = std::min(packets, lag - cursors[under_way - 1].packet);
        run_together(p, std::span(cursors.data(), under_way), packets);
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
            for (std::size_t k = 0; k < motion.position_m.size(); ++k) update(k, motion);
        }
        for (const RelaxationBar& bar : bars) {
            relax(position + std::size_t{2} * bar.a, position + std::size_t{2} * bar.b, bar.rest_m,
                  bar.share_a, bar.share_b);
        }
    }
}

std::span<const RelaxationKernel> relaxation_kernels() {
    static constexpr std::array kKernels{RelaxationKernel::kScalar, RelaxationKernel::kSse2,
                                         RelaxationKernel::kAvx2};
#if defined(__x86_64__)
    return std::span(kKernels).first(__builtin_cpu_supports("avx2") != 0 ? 3 : 2);
#else
    return std::span(kKernels).first(1);
#endif
}

void run_sweeps([[maybe_unused]] const RelaxationSchedule& schedule,
                [[maybe_unused]] const RelaxationSweeps& sweeps, [[maybe_unused]] RelaxationKernel kernel,
                [[maybe_unused]] RelaxationMotion& motion) {
#if defined(__x86_64__)
    const Pointers pointers{schedule.packets.data(),   schedule.next_is_independent.data(),
                            schedule.updates.data(),   schedule.update_begin.data(),
                            motion.position_m.data(),  motion.move_m.data(),
                            motion.unrelaxed_m.data(), motion.last_move_m.data(),
                            motion.push_m.data(),      motion.keep};
    if (!schedule.packets.empty())
        return run_staggered(pointers, sweeps, schedule.packets.size(), schedule.lag,
                             kernel == RelaxationKernel::kAvx2 && schedule.is_wide);
    for (std::uint64_t sweep = sweeps.begin; sweep < sweeps.end; ++sweep) {
        if (!sweeps.updates_before(sweep)) continue;
        for (const std::uint32_t particle : schedule.updates) update_particle(pointers, particle);
    }
#endif
}

}  // namespace corda::sim
