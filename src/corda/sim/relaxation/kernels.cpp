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
void update(RelaxationMove& verlet, double* position_m, double keep) {
    for (std::size_t k = 0; k < 2; ++k) {
        verlet.last_move_m[k] = verlet.move_m[k] + (position_m[k] - verlet.unrelaxed_m[k]);
        verlet.move_m[k] = keep * verlet.last_move_m[k] + verlet.push_m[k];
        position_m[k] += verlet.move_m[k];
        verlet.unrelaxed_m[k] = position_m[k];
    }
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

/// Maximum number of concurrent sweeps over the same packets. Three hide a bar's latency if the rope is long
/// enough; more share the memory reads of a rope too large for the caches.
constexpr std::size_t kSweepsAtOnce = 4;

/// A sweep in progress, or overlapping ones.
struct Cursor {
    std::size_t packet = 0;      ///< the next one
    std::uint64_t updating = 0;  ///< bit s: the sweep in stage s is the first of a step
};

/// Pointers into packed sweeps and a motion.
struct Pointers {
    const RelaxationPacket* packets;
    const PacketShares* shares;
    const std::uint8_t* share_index;
    const std::array<std::uint8_t, RelaxationPacket::kLanes>* stage;
    const PackedSweeps::Update* updates;
    const std::uint32_t* update_begin;
    double* position_m;
    RelaxationMove* moves;
    double keep;
    std::uint64_t active = 1;  ///< bit s: stage s works
    bool is_whole = true;      ///< all stages work

    Pointers(const PackedSweeps& sweeps, RelaxationMotion& motion)
        : packets(sweeps.packets.data()),
          shares(sweeps.shares.data()),
          share_index(sweeps.share_index.data()),
          stage(sweeps.stage.data()),
          updates(sweeps.updates.data()),
          update_begin(sweeps.update_begin.data()),
          position_m(motion.position_m.data()),
          moves(motion.moves.data()),
          keep(motion.keep) {}
};

/// Relaxes the bars of active stages in lanes `lane` to `end` - 1 of packet k, one of which has no length.
[[gnu::noinline, gnu::cold]] void relax_one_by_one(Pointers p, std::size_t k, std::size_t lane,
                                                   std::size_t end) {
    const RelaxationPacket& packet = p.packets[k];
    const PacketShares& shares = p.shares[p.share_index[k]];
    for (std::size_t i = lane; i < end; ++i) {
        if ((p.active >> p.stage[k][i] & 1U) == 0) continue;
        relax(p.position_m + packet.a[i], p.position_m + packet.b[i], packet.rest_m[i], shares.a[i],
              shares.b[i]);
    }
}

/// Verlet's update of one particle.
CORDA_INLINE void update_particle(const Pointers& p, std::uint32_t particle) {
    RelaxationMove& verlet = p.moves[particle];
    double* const at = p.position_m + std::size_t{2} * particle;
    __m128d position = _mm_loadu_pd(at);
    const __m128d last = _mm_add_pd(_mm_load_pd(verlet.move_m.data()),
                                    _mm_sub_pd(position, _mm_load_pd(verlet.unrelaxed_m.data())));
    const __m128d move = _mm_add_pd(_mm_mul_pd(_mm_set1_pd(p.keep), last), _mm_load_pd(verlet.push_m.data()));
    position = _mm_add_pd(position, move);
    _mm_storeu_pd(at, position);
    _mm_store_pd(verlet.move_m.data(), move);
    _mm_store_pd(verlet.unrelaxed_m.data(), position);
    _mm_store_pd(verlet.last_move_m.data(), last);
}

/// Makes the updates before the next `packets` packets of a sweep.
CORDA_INLINE void update_ahead(const Pointers& p, const Cursor& sweep, std::size_t packets) {
    if (sweep.updating == 0) return;
    const std::uint32_t end = p.update_begin[sweep.packet + packets];
    for (std::uint32_t j = p.update_begin[sweep.packet]; j < end; ++j) {
        const auto [particle, stage] = p.updates[j];
        if ((sweep.updating >> stage & 1U) != 0) update_particle(p, particle);
    }
}

/// Relaxes the bars in lanes `lane` and `lane` + 1 of packet k.
CORDA_INLINE void relax_two(const Pointers& p, std::size_t k, std::size_t lane) {
    const RelaxationPacket& packet = p.packets[k];
    const PacketShares& shares = p.shares[p.share_index[k]];
    double* const a0 = p.position_m + packet.a[lane];
    double* const a1 = p.position_m + packet.a[lane + 1];
    double* const b0 = p.position_m + packet.b[lane];
    double* const b1 = p.position_m + packet.b[lane + 1];
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
        return relax_one_by_one(p, k, lane, lane + 2);
    const __m128d adjust = _mm_sub_pd(distance, _mm_load_pd(packet.rest_m.data() + lane));
    const __m128d move0 =
        _mm_mul_pd(_mm_div_pd(along0, _mm_unpacklo_pd(distance, distance)), _mm_unpacklo_pd(adjust, adjust));
    const __m128d move1 =
        _mm_mul_pd(_mm_div_pd(along1, _mm_unpackhi_pd(distance, distance)), _mm_unpackhi_pd(adjust, adjust));
    _mm_storeu_pd(a0, _mm_add_pd(at_a0, _mm_mul_pd(_mm_set1_pd(shares.a[lane]), move0)));
    _mm_storeu_pd(a1, _mm_add_pd(at_a1, _mm_mul_pd(_mm_set1_pd(shares.a[lane + 1]), move1)));
    _mm_storeu_pd(b0, _mm_sub_pd(at_b0, _mm_mul_pd(_mm_set1_pd(shares.b[lane]), move0)));
    _mm_storeu_pd(b1, _mm_sub_pd(at_b1, _mm_mul_pd(_mm_set1_pd(shares.b[lane + 1]), move1)));
}

/// Runs `packets` packets of each sweep under way, one of each in turn.
void run_by_sse2(Pointers p, std::span<Cursor> sweeps, std::size_t packets) {
    for (; packets > 0; --packets) {
        for (Cursor& sweep : sweeps) {
            update_ahead(p, sweep, 1);
            const std::size_t k = sweep.packet++;
            relax_two(p, k, 0);
            if (p.packets[k].a[0] != p.packets[k].a[2]) relax_two(p, k, 2);
        }
    }
}

using Indices = std::array<std::uint32_t, RelaxationPacket::kLanes>;

/// The positions of the particles of lanes `lane` and `lane` + 2.
CORDA_AVX2 CORDA_INLINE __m256d load_pairs(const double* position_m, const Indices& at, std::size_t lane) {
    return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(position_m + at[lane])),
                                _mm_loadu_pd(position_m + at[lane + 2]), 1);
}

/// Adds to the positions of the particles of lanes `lane` and `lane` + 2, or subtracts from them: one after
/// the other, because an unused lane has particles of another one.
template <bool kAdds>
CORDA_AVX2 CORDA_INLINE void move_pairs(double* position_m, const Indices& at, std::size_t lane, __m256d by) {
    double* const first = position_m + at[lane];
    const __m128d by_first = _mm256_castpd256_pd128(by);
    const __m128d at_first = _mm_loadu_pd(first);
    _mm_storeu_pd(first, kAdds ? _mm_add_pd(at_first, by_first) : _mm_sub_pd(at_first, by_first));
    double* const second = position_m + at[lane + 2];
    const __m128d by_second = _mm256_extractf128_pd(by, 1);
    const __m128d at_second = _mm_loadu_pd(second);
    _mm_storeu_pd(second, kAdds ? _mm_add_pd(at_second, by_second) : _mm_sub_pd(at_second, by_second));
}

/// The first number of each pair, twice, and the second.
CORDA_AVX2 CORDA_INLINE __m256d first_of(__m256d pairs) {
    return _mm256_movedup_pd(pairs);
}
CORDA_AVX2 CORDA_INLINE __m256d second_of(__m256d pairs) {
    return _mm256_permute_pd(pairs, 0xf);
}

/// Four bars between the square root and the division: lanes 0 and 2, and lanes 1 and 3.
struct Begun {
    __m256d along0, along1, distance;
};

CORDA_AVX2 CORDA_INLINE Begun begin_bars(const RelaxationPacket& packet, const double* position_m) {
    const __m256d along0 =
        _mm256_sub_pd(load_pairs(position_m, packet.b, 0), load_pairs(position_m, packet.a, 0));
    const __m256d along1 =
        _mm256_sub_pd(load_pairs(position_m, packet.b, 1), load_pairs(position_m, packet.a, 1));
    const __m256d square0 = _mm256_mul_pd(along0, along0);
    const __m256d square1 = _mm256_mul_pd(along1, along1);
    return {along0, along1,
            _mm256_sqrt_pd(
                _mm256_add_pd(_mm256_unpacklo_pd(square0, square1), _mm256_unpackhi_pd(square0, square1)))};
}

CORDA_AVX2 CORDA_INLINE void finish_bars(const Pointers& p, std::size_t k, const Begun& begun) {
    const RelaxationPacket& packet = p.packets[k];
    const __m256d distance = begun.distance;
    if (_mm256_movemask_pd(_mm256_cmp_pd(distance, _mm256_setzero_pd(), _CMP_EQ_OQ)) != 0) [[unlikely]]
        return relax_one_by_one(p, k, 0, RelaxationPacket::kLanes);
    const __m256d toward0 = _mm256_div_pd(begun.along0, first_of(distance));
    const __m256d toward1 = _mm256_div_pd(begun.along1, second_of(distance));
    const __m256d adjust = _mm256_sub_pd(distance, _mm256_load_pd(packet.rest_m.data()));
    // Shares are 0, 1/2 or 1: their products are exact, so they may come before the other factors.
    if (p.is_whole && p.share_index[k] == PackedSweeps::kFree) [[likely]] {
        const __m256d half = _mm256_mul_pd(_mm256_set1_pd(0.5), adjust);
        const __m256d move0 = _mm256_mul_pd(toward0, first_of(half));
        const __m256d move1 = _mm256_mul_pd(toward1, second_of(half));
        move_pairs<true>(p.position_m, packet.a, 0, move0);
        move_pairs<true>(p.position_m, packet.a, 1, move1);
        move_pairs<false>(p.position_m, packet.b, 0, move0);
        move_pairs<false>(p.position_m, packet.b, 1, move1);
        return;
    }
    // Inactive lanes subtract 0, which changes no number; a sum with 0 would change -0.
    const PacketShares& shares = p.shares[p.share_index[k]];
    const __m256d adjust_a =
        _mm256_xor_pd(_mm256_set1_pd(-0.0), _mm256_mul_pd(_mm256_load_pd(shares.a.data()), adjust));
    const __m256d adjust_b = _mm256_mul_pd(_mm256_load_pd(shares.b.data()), adjust);
    const __m256i stage = _mm256_cvtepu8_epi64(_mm_loadu_si32(p.stage[k].data()));
    const __m256i active = _mm256_srlv_epi64(_mm256_set1_epi64x(static_cast<long long>(p.active)), stage);
    // All bits of the lanes of active stages.
    const __m256d mask = _mm256_castsi256_pd(
        _mm256_sub_epi64(_mm256_setzero_si256(), _mm256_and_si256(active, _mm256_set1_epi64x(1))));
    const __m256d mask0 = first_of(mask);
    const __m256d mask1 = second_of(mask);
    move_pairs<false>(p.position_m, packet.a, 0,
                      _mm256_and_pd(mask0, _mm256_mul_pd(toward0, first_of(adjust_a))));
    move_pairs<false>(p.position_m, packet.a, 1,
                      _mm256_and_pd(mask1, _mm256_mul_pd(toward1, second_of(adjust_a))));
    move_pairs<false>(p.position_m, packet.b, 0,
                      _mm256_and_pd(mask0, _mm256_mul_pd(toward0, first_of(adjust_b))));
    move_pairs<false>(p.position_m, packet.b, 1,
                      _mm256_and_pd(mask1, _mm256_mul_pd(toward1, second_of(adjust_b))));
}

/// Relaxes `packets` packets of kCount sweeps in turn. While bars wait for their square roots, those of
/// another sweep begin.
template <std::size_t kCount>
CORDA_AVX2 void run_fours(Pointers p, const Cursor* sweeps, std::size_t packets) {
    constexpr bool kIsPipelined = kCount > 1;
    std::size_t first[kCount];
    for (std::size_t i = 0; i < kCount; ++i) first[i] = sweeps[i].packet;
    Begun next{};
    if (kIsPipelined) next = begin_bars(p.packets[first[0]], p.position_m);
    for (std::size_t k = 0; k < packets; ++k) {
#pragma GCC unroll 4
        for (std::size_t i = 0; i < kCount; ++i) {
            if (!kIsPipelined) next = begin_bars(p.packets[first[i] + k], p.position_m);
            const Begun begun = next;
            if (kIsPipelined && i + 1 < kCount) next = begin_bars(p.packets[first[i + 1] + k], p.position_m);
            if (kIsPipelined && i + 1 == kCount && k + 1 < packets)
                next = begin_bars(p.packets[first[0] + k + 1], p.position_m);
            finish_bars(p, first[i] + k, begun);
        }
    }
}

/// By the number of sweeps, less one.
constexpr std::array kRunFours{run_fours<1>, run_fours<2>, run_fours<3>, run_fours<4>};

/// As run_by_sse2().
void run_by_avx2(const Pointers& p, std::size_t at_once, std::span<Cursor> sweeps, std::size_t packets) {
    while (packets > 0) {
        const std::size_t block = std::min(packets, at_once);
        for (const Cursor& sweep : sweeps) update_ahead(p, sweep, block);
        kRunFours[sweeps.size() - 1](p, sweeps.data(), block);
        for (Cursor& sweep : sweeps) sweep.packet += block;
        packets -= block;
    }
}

/// Runs all packets of overlapping sweeps once. While bars wait for their square roots, the next packet
/// begins.
CORDA_AVX2 void run_period(Pointers p, const Cursor& sweeps, std::size_t at_once, std::size_t packets) {
    Begun next{};
    for (std::size_t k = 0; k < packets;) {
        const std::size_t end = std::min(packets, k + at_once);
        update_ahead(p, {k, sweeps.updating}, end - k);
        for (; k < end; ++k) {
            const Begun begun = next;
            next = begin_bars(p.packets[k], p.position_m);
            if (k > 0) finish_bars(p, k - 1, begun);
        }
    }
    finish_bars(p, packets - 1, next);
}

void run_overlapping(Pointers p, const RelaxationSweeps& sweeps, const PackedSweeps& packed) {
    const std::uint64_t all = ~std::uint64_t{0} >> (PackedSweeps::kMaxStages - packed.stages);
    Cursor cursor;
    p.active = 0;
    for (std::uint64_t next = sweeps.begin;; ++next) {
        const bool begins = next < sweeps.end;
        p.active = (p.active << 1U | (begins ? 1U : 0U)) & all;
        cursor.updating = (cursor.updating << 1U | (begins && sweeps.updates_before(next) ? 1U : 0U)) & all;
        if (p.active == 0) return;
        p.is_whole = p.active == all;
        run_period(p, cursor, packed.block, packed.packets.size());
    }
}

/// Runs sweeps over the same packets, each at least `lag` packets behind its predecessor.
void run_staggered(const Pointers& p, const RelaxationSweeps& sweeps, const RelaxationSchedule& schedule,
                   bool has_avx2) {
    const std::size_t length = schedule.alone.packets.size();
    const std::size_t lag = schedule.lag;
    std::array<Cursor, kSweepsAtOnce> cursors;
    std::size_t under_way = 0;
    std::uint64_t next = sweeps.begin;
    const auto may_begin = [&] { return next < sweeps.end && under_way < kSweepsAtOnce; };
    while (next < sweeps.end || under_way > 0) {
        if (may_begin() && (under_way == 0 || cursors[under_way - 1].packet >= lag)) {
            cursors[under_way++] = {0, sweeps.updates_before(next) ? 1U : 0U};
            ++next;
        }
        // Up to where the next sweep begins or the first one ends.
        std::size_t packets = length - cursors[0].packet;
        if (may_begin()) packets = std::min(packets, lag - cursors[under_way - 1].packet);
        const std::span<Cursor> current(cursors.data(), under_way);
        // Where most packets depend on their predecessors, four bars at a time wait for the last of them.
        const bool is_wide = under_way * length > 3 * schedule.levels ||
                             (length > 2 * lag && length > schedule.levels + schedule.levels / 4);
        if (has_avx2 && is_wide) {
            run_by_avx2(p, schedule.alone.block, current, packets);
        } else {
            run_by_sse2(p, current, packets);
        }
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
    const bool has_avx2 = kernel == RelaxationKernel::kAvx2;
    const Pointers alone(schedule.alone, motion);
    const PackedSweeps& overlapping = schedule.overlapping;
    // A packet of these takes three quarters of the time, but to begin and end takes more of them.
    const std::uint64_t count = sweeps.end - sweeps.begin;
    const bool overlaps =
        !overlapping.packets.empty() && 3 * (count + overlapping.stages - 1) * overlapping.packets.size() <=
                                            4 * count * schedule.alone.packets.size();
    if (has_avx2 && overlaps) return run_overlapping({overlapping, motion}, sweeps, overlapping);
    if (!schedule.alone.packets.empty()) return run_staggered(alone, sweeps, schedule, has_avx2);
    for (std::uint64_t sweep = sweeps.begin; sweep < sweeps.end; ++sweep) {
        if (!sweeps.updates_before(sweep)) continue;
        for (const PackedSweeps::Update& update : schedule.alone.updates)
            update_particle(alone, update.particle);
    }
#endif
}

}  // namespace corda::sim
