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

/// Maximum number of concurrent sweeps. Three hide a bar's latency if the rope is long enough; more share the
/// memory reads of a rope too large for the caches.
constexpr std::size_t kSweepsAtOnce = 4;
/// The same if two sweeps share an instruction.
constexpr std::size_t kNarrowSweepsAtOnce = 6;

/// A sweep in progress.
struct Cursor {
    std::size_t packet = 0;  ///< the next one
    bool updates = false;    ///< this sweep is the first of a step
};

/// Pointers into a schedule and a motion.
struct Pointers {
    const RelaxationPacket* packets;
    const PacketShares* shares;
    const std::uint8_t* share_index;
    const std::uint32_t* updates;
    const std::uint32_t* update_begin;
    double* position_m;
    RelaxationMove* moves;
    double keep;

    [[nodiscard]] const PacketShares& shares_of(std::size_t packet) const {
        return shares[share_index[packet]];
    }
};

/// Relaxes the bars in lanes `lane` and `lane` + 1 of packet k, one of which has no length.
[[gnu::noinline, gnu::cold]] void relax_one_by_one(Pointers p, std::size_t k, std::size_t lane) {
    const RelaxationPacket& packet = p.packets[k];
    const PacketShares& shares = p.shares_of(k);
    for (std::size_t i = lane; i < lane + 2; ++i) {
        if (i > lane && packet.a[i] == packet.a[lane]) continue;
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
void update_ahead(Pointers p, const Cursor& sweep, std::size_t packets) {
    if (!sweep.updates) return;
    const std::uint32_t* const begin = p.update_begin + sweep.packet;
    const std::uint32_t* const updates = p.updates;
    const std::uint32_t end = begin[packets];
    for (std::uint32_t j = *begin; j < end; ++j) update_particle(p, updates[j]);
}

/// Relaxes the bars in lanes `lane` and `lane` + 1 of packet k.
CORDA_INLINE void relax_two(const Pointers& p, std::size_t k, std::size_t lane) {
    const RelaxationPacket& packet = p.packets[k];
    const PacketShares& shares = p.shares_of(k);
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
        return relax_one_by_one(p, k, lane);
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

CORDA_INLINE void relax_packet(const Pointers& p, std::size_t k) {
    relax_two(p, k, 0);
    if (!p.shares_of(k).is_half) relax_two(p, k, 2);
}

/// For packets of particles that are pinned and of bars that have no length.
[[gnu::noinline]] void relax_other_packet(const Pointers& p, std::size_t k) {
    relax_packet(p, k);
}

/// Runs `packets` packets of each sweep under way, one of each in turn.
void run_by_sse2(Pointers p, std::span<Cursor> sweeps, std::size_t packets) {
    for (; packets > 0; --packets) {
        for (Cursor& sweep : sweeps) {
            update_ahead(p, sweep, 1);
            relax_packet(p, sweep.packet++);
        }
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

/// The particles of four bars: a0 and b0 of lanes 0 and 2, a1 and b1 of lanes 1 and 3.
struct Ends {
    __m256d a0, a1, b0, b1;
};

/// Four bars between the square root and the division.
struct Begun {
    __m256d along0, along1, distance;
};

/// Four bars without a common particle at a time, all particles of which are free: packets of one sweep, or
/// the lanes 0 and 1 of packets of two sweeps, which are at least `lag` packets apart.
template <bool kIsNarrow>
struct Fours {
    const RelaxationPacket* first = nullptr;
    const RelaxationPacket* second = nullptr;
    const std::uint8_t* first_kind = nullptr;
    const std::uint8_t* second_kind = nullptr;

    Fours() = default;
    Fours(const Pointers& p, std::size_t k, std::size_t l)
        : first(p.packets + k),
          second(p.packets + l),
          first_kind(p.share_index + k),
          second_kind(p.share_index + l) {}

    [[nodiscard]] bool are_free(std::size_t k) const {
        // Unused lanes repeat bars, which does not change them.
        if (!kIsNarrow) return first_kind[k] <= RelaxationSchedule::kFreeHalf;
        return first_kind[k] == RelaxationSchedule::kFreeHalf &&
               second_kind[k] == RelaxationSchedule::kFreeHalf;
    }

    CORDA_AVX2 CORDA_INLINE Ends ends(std::size_t k, const double* position_m) const {
        return {load(position_m, first[k].a, second[k].a, 0), load(position_m, first[k].a, second[k].a, 1),
                load(position_m, first[k].b, second[k].b, 0), load(position_m, first[k].b, second[k].b, 1)};
    }

    CORDA_AVX2 CORDA_INLINE static Begun begin(const Ends& at) {
        const __m256d along0 = _mm256_sub_pd(at.b0, at.a0);
        const __m256d along1 = _mm256_sub_pd(at.b1, at.a1);
        const __m256d square0 = _mm256_mul_pd(along0, along0);
        const __m256d square1 = _mm256_mul_pd(along1, along1);
        return {along0, along1,
                _mm256_sqrt_pd(_mm256_add_pd(_mm256_unpacklo_pd(square0, square1),
                                             _mm256_unpackhi_pd(square0, square1)))};
    }

    /// Returns false, with nothing moved, if a bar has no length.
    CORDA_AVX2 CORDA_INLINE bool finish(std::size_t k, const Ends& at, const Begun& begun,
                                        double* position_m) const {
        if (_mm256_movemask_pd(_mm256_cmp_pd(begun.distance, _mm256_setzero_pd(), _CMP_EQ_OQ)) != 0)
            [[unlikely]]
            return false;
        const __m256d rest_m = kIsNarrow ? load_pairs(first[k].rest_m.data(), second[k].rest_m.data())
                                         : _mm256_load_pd(first[k].rest_m.data());
        // Halving is exact, so it may come before the other factors.
        const __m256d adjust = _mm256_mul_pd(_mm256_set1_pd(0.5), _mm256_sub_pd(begun.distance, rest_m));
        const __m256d move0 =
            _mm256_mul_pd(_mm256_div_pd(begun.along0, first_of(begun.distance)), first_of(adjust));
        const __m256d move1 =
            _mm256_mul_pd(_mm256_div_pd(begun.along1, second_of(begun.distance)), second_of(adjust));
        store(position_m, first[k].a, second[k].a, 0, _mm256_add_pd(at.a0, move0));
        store(position_m, first[k].b, second[k].b, 0, _mm256_sub_pd(at.b0, move0));
        store(position_m, first[k].a, second[k].a, 1, _mm256_add_pd(at.a1, move1));
        store(position_m, first[k].b, second[k].b, 1, _mm256_sub_pd(at.b1, move1));
        return true;
    }

  private:
    static constexpr std::size_t kSecondLane = kIsNarrow ? 0 : 2;
    using Index = std::array<std::uint32_t, RelaxationPacket::kLanes>;

    CORDA_AVX2 CORDA_INLINE static __m256d load(const double* position_m, const Index& first,
                                                const Index& second, std::size_t lane) {
        return load_pairs(position_m + first[lane], position_m + second[kSecondLane + lane]);
    }
    CORDA_AVX2 CORDA_INLINE static void store(double* position_m, const Index& first, const Index& second,
                                              std::size_t lane, __m256d pairs) {
        store_pairs(position_m + first[lane], position_m + second[kSecondLane + lane], pairs);
    }
};

/// Relaxes `packets` packets of kCount sweeps, or of pairs of them, in turn.
template <bool kIsNarrow, std::size_t kCount>
CORDA_AVX2 void run_fours(const Pointers& p, const Cursor* sweeps, std::size_t packets) {
    constexpr std::size_t kSweepsEach = kIsNarrow ? 2 : 1;
    // While bars wait for their square roots, those of another sweep begin. With fewer sweeps, the CPU's own
    // order is as good.
    constexpr bool kIsPipelined = kCount > 3;
    double* const position_m = p.position_m;
    Fours<kIsNarrow> fours[kCount];
    for (std::size_t i = 0; i < kCount; ++i)
        fours[i] = {p, sweeps[kSweepsEach * i].packet, sweeps[kSweepsEach * (i + 1) - 1].packet};
    Begun next{};
    if constexpr (kIsPipelined) next = fours[0].begin(fours[0].ends(0, position_m));
    for (std::size_t k = 0; k < packets; ++k) {
#pragma GCC unroll 4
        for (std::size_t i = 0; i < kCount; ++i) {
            Begun begun = next;
            if (kIsPipelined && i + 1 < kCount) next = fours[i + 1].begin(fours[i + 1].ends(k, position_m));
            if (kIsPipelined && i + 1 == kCount && k + 1 < packets)
                next = fours[0].begin(fours[0].ends(k + 1, position_m));
            const Ends at = fours[i].ends(k, position_m);
            if (!kIsPipelined) begun = fours[i].begin(at);
            if (!fours[i].are_free(k) || !fours[i].finish(k, at, begun, position_m)) [[unlikely]] {
                relax_other_packet(p, sweeps[kSweepsEach * i].packet + k);
                if (kIsNarrow) relax_other_packet(p, sweeps[kSweepsEach * i + 1].packet + k);
            }
        }
    }
}

void run_none(const Pointers& /*p*/, const Cursor* /*sweeps*/, std::size_t /*packets*/) {}

/// By the number of sweeps, or of pairs of them.
template <bool kIsNarrow>
constexpr std::array kRunFours{run_none, run_fours<kIsNarrow, 1>, run_fours<kIsNarrow, 2>,
                               run_fours<kIsNarrow, 3>, run_fours<kIsNarrow, 4>};

/// As run_by_sse2().
void run_by_avx2(const Pointers& p, const RelaxationSchedule& schedule, std::span<Cursor> sweeps,
                 std::size_t packets) {
    const std::size_t pairs = schedule.is_narrow ? sweeps.size() / 2 : 0;
    const auto run = schedule.is_narrow ? kRunFours<true>[pairs] : kRunFours<false>[sweeps.size()];
    const std::span<Cursor> alone = schedule.is_narrow ? sweeps.subspan(2 * pairs) : std::span<Cursor>{};
    while (packets > 0) {
        const std::size_t block = std::min(packets, schedule.block);
        for (const Cursor& sweep : sweeps) update_ahead(p, sweep, block);
        run(p, sweeps.data(), block);
        for (std::size_t k = 0; k < block && !alone.empty(); ++k) relax_other_packet(p, alone[0].packet + k);
        for (Cursor& sweep : sweeps) sweep.packet += block;
        packets -= block;
    }
}

/// Runs sweeps over a schedule, each at least `lag` packets behind its predecessor.
void run_staggered(const Pointers& p, const RelaxationSweeps& sweeps, const RelaxationSchedule& schedule,
                   bool has_avx2) {
    const std::size_t length = schedule.packets.size();
    const std::size_t lag = schedule.lag;
    std::array<Cursor, std::max(kSweepsAtOnce, kNarrowSweepsAtOnce)> cursors;
    const std::size_t at_once = schedule.is_narrow ? kNarrowSweepsAtOnce : kSweepsAtOnce;
    std::size_t under_way = 0;
    std::uint64_t next = sweeps.begin;
    const auto may_begin = [&] { return next < sweeps.end && under_way < at_once; };
    while (next < sweeps.end || under_way > 0) {
        if (may_begin() && (under_way == 0 || cursors[under_way - 1].packet >= lag)) {
            cursors[under_way++] = {0, sweeps.updates_before(next)};
            ++next;
        }
        // Up to where the next sweep begins or the first one ends.
        std::size_t packets = length - cursors[0].packet;
        if (may_begin()) packets = std::min(packets, lag - cursors[under_way - 1].packet);
        const std::span<Cursor> current(cursors.data(), under_way);
        // Where most packets depend on their predecessors, four bars at a time wait for the last of them.
        const bool is_wide = under_way * length > 2 * schedule.levels || length > 2 * lag;
        if (has_avx2 && is_wide) {
            run_by_avx2(p, schedule, current, packets);
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
    const Pointers pointers{schedule.packets.data(),      schedule.shares.data(),
                            schedule.share_index.data(),  schedule.updates.data(),
                            schedule.update_begin.data(), motion.position_m.data(),
                            motion.moves.data(),          motion.keep};
    if (!schedule.packets.empty())
        return run_staggered(pointers, sweeps, schedule, kernel == RelaxationKernel::kAvx2);
    for (std::uint64_t sweep = sweeps.begin; sweep < sweeps.end; ++sweep) {
        if (!sweeps.updates_before(sweep)) continue;
        for (const std::uint32_t particle : schedule.updates) update_particle(pointers, particle);
    }
#endif
}

}  // namespace corda::sim
