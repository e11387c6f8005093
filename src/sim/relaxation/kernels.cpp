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
    const PacketShares* shares;
    const std::uint8_t* share_index;
    const std::uint32_t* updates;
    const std::uint32_t* update_begin;
    double* position_m;
    double* move_m;
    double* unrelaxed_m;
    double* last_move_m;
    const double* push_m;
    double keep;

    [[nodiscard]] const PacketShares& shares_of(std::size_t packet) const {
        return shares[share_index[packet]];
    }
};

/// Relaxes the bars in lanes `lane` and `lane` + 1 of packet k, one of which has no length.
[[gnu::noinline, gnu::cold]] void relax_one_by_one(const Pointers& p, std::size_t k, std::size_t lane) {
    const RelaxationPacket& packet = p.packets[k];
    const PacketShares& shares = p.shares_of(k);
    const auto relax_lane = [&](std::size_t i, double share_a, double share_b) {
        relax(p.position_m + packet.a[i], p.position_m + packet.b[i], packet.rest_m[i], share_a, share_b);
    };
    relax_lane(lane, shares.even_a[lane], shares.even_b[lane]);
    if (packet.a[lane + 1] != packet.a[lane]) relax_lane(lane + 1, shares.odd_a[lane], shares.odd_b[lane]);
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
    _mm_storeu_pd(a0, _mm_add_pd(at_a0, _mm_mul_pd(_mm_load_pd(shares.even_a.data() + lane), move0)));
    _mm_storeu_pd(a1, _mm_add_pd(at_a1, _mm_mul_pd(_mm_load_pd(shares.odd_a.data() + lane), move1)));
    _mm_storeu_pd(b0, _mm_sub_pd(at_b0, _mm_mul_pd(_mm_load_pd(shares.even_b.data() + lane), move0)));
    _mm_storeu_pd(b1, _mm_sub_pd(at_b1, _mm_mul_pd(_mm_load_pd(shares.odd_b.data() + lane), move1)));
}

/// Runs the next packet of a sweep.
CORDA_INLINE void advance_one(const Pointers& p, Cursor& sweep) {
    update_before(p, sweep);
    const std::size_t k = sweep.packet++;
    relax_two(p, k, 0);
    if (!p.shares_of(k).is_half) relax_two(p, k, 2);
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

/// Four bars without a common particle: two of each of two packets, or lanes 0 and 1, and 2 and 3, of one.
struct Four {
    const std::uint32_t* a[2];  ///< RelaxationPacket::a of two lanes each
    const std::uint32_t* b[2];
    __m256d rest_m;
    __m256d even_a, odd_a, even_b, odd_b;  ///< PacketShares
};

/// As relax_two(). Returns false, with nothing moved, if a bar has no length.
CORDA_AVX2 CORDA_INLINE bool relax_four(const Four& four, double* position_m) {
    const auto at = [&](const std::uint32_t* const(&first)[2], int i, int lane) {
        return position_m + first[i][lane];
    };
    const __m256d at_a0 = load_pairs(at(four.a, 0, 0), at(four.a, 1, 0));
    const __m256d at_a1 = load_pairs(at(four.a, 0, 1), at(four.a, 1, 1));
    const __m256d at_b0 = load_pairs(at(four.b, 0, 0), at(four.b, 1, 0));
    const __m256d at_b1 = load_pairs(at(four.b, 0, 1), at(four.b, 1, 1));
    const __m256d along0 = _mm256_sub_pd(at_b0, at_a0);
    const __m256d along1 = _mm256_sub_pd(at_b1, at_a1);
    const __m256d square0 = _mm256_mul_pd(along0, along0);
    const __m256d square1 = _mm256_mul_pd(along1, along1);
    const __m256d distance = _mm256_sqrt_pd(
        _mm256_add_pd(_mm256_unpacklo_pd(square0, square1), _mm256_unpackhi_pd(square0, square1)));
    if (_mm256_movemask_pd(_mm256_cmp_pd(distance, _mm256_setzero_pd(), _CMP_EQ_OQ)) != 0) [[unlikely]]
        return false;
    const __m256d adjust = _mm256_sub_pd(distance, four.rest_m);
    const __m256d move0 = _mm256_mul_pd(_mm256_div_pd(along0, first_of(distance)), first_of(adjust));
    const __m256d move1 = _mm256_mul_pd(_mm256_div_pd(along1, second_of(distance)), second_of(adjust));
    store_pairs(at(four.a, 0, 0), at(four.a, 1, 0), _mm256_add_pd(at_a0, _mm256_mul_pd(four.even_a, move0)));
    store_pairs(at(four.a, 0, 1), at(four.a, 1, 1), _mm256_add_pd(at_a1, _mm256_mul_pd(four.odd_a, move1)));
    store_pairs(at(four.b, 0, 0), at(four.b, 1, 0), _mm256_sub_pd(at_b0, _mm256_mul_pd(four.even_b, move0)));
    store_pairs(at(four.b, 0, 1), at(four.b, 1, 1), _mm256_sub_pd(at_b1, _mm256_mul_pd(four.odd_b, move1)));
    return true;
}

/// Relaxes the bars of packet k.
CORDA_AVX2 CORDA_INLINE void relax_packet(const Pointers& p, std::size_t k) {
    const RelaxationPacket& packet = p.packets[k];
    const PacketShares& shares = p.shares_of(k);
    if (shares.is_half) return relax_two(p, k, 0);
    const bool done = relax_four({{packet.a.data(), packet.a.data() + 2},
                                  {packet.b.data(), packet.b.data() + 2},
                                  _mm256_load_pd(packet.rest_m.data()),
                                  _mm256_load_pd(shares.even_a.data()),
                                  _mm256_load_pd(shares.odd_a.data()),
                                  _mm256_load_pd(shares.even_b.data()),
                                  _mm256_load_pd(shares.odd_b.data())},
                                 p.position_m);
    if (done) return;
    relax_one_by_one(p, k, 0);
    relax_one_by_one(p, k, 2);
}

/// Relaxes the bars of packets k and l, which are half.
CORDA_AVX2 CORDA_INLINE void relax_halves(const Pointers& p, std::size_t k, std::size_t l) {
    const RelaxationPacket& first = p.packets[k];
    const RelaxationPacket& second = p.packets[l];
    const PacketShares& of_first = p.shares_of(k);
    const PacketShares& of_second = p.shares_of(l);
    const bool done = relax_four({{first.a.data(), second.a.data()},
                                  {first.b.data(), second.b.data()},
                                  load_pairs(first.rest_m.data(), second.rest_m.data()),
                                  load_pairs(of_first.even_a.data(), of_second.even_a.data()),
                                  load_pairs(of_first.odd_a.data(), of_second.odd_a.data()),
                                  load_pairs(of_first.even_b.data(), of_second.even_b.data()),
                                  load_pairs(of_first.odd_b.data(), of_second.odd_b.data())},
                                 p.position_m);
    if (done) return;
    relax_one_by_one(p, k, 0);
    relax_one_by_one(p, l, 0);
}

/// Runs `packets` packets of each sweep under way: four bars of a packet at a time, or two of each of two
/// sweeps, which are at least `lag` packets apart and so share no particle.
CORDA_AVX2 void run_by_avx2(const Pointers& p, std::span<Cursor> sweeps, std::size_t packets) {
    for (; packets > 0; --packets) {
        std::size_t i = 0;
        for (; i + 1 < sweeps.size(); i += 2) {
            update_before(p, sweeps[i]);
            update_before(p, sweeps[i + 1]);
            const std::size_t k = sweeps[i].packet++;
            const std::size_t l = sweeps[i + 1].packet++;
            if (p.shares_of(k).is_half && p.shares_of(l).is_half) {
                relax_halves(p, k, l);
            } else {
                relax_packet(p, k);
                relax_packet(p, l);
            }
        }
        if (i == sweeps.size()) continue;
        update_before(p, sweeps[i]);
        relax_packet(p, sweeps[i].packet++);
    }
}

/// Runs sweeps over a schedule, each at least `lag` packets behind its predecessor.
void run_staggered(const Pointers& p, const RelaxationSweeps& sweeps, const RelaxationSchedule& schedule,
                   bool has_avx2) {
    const std::size_t length = schedule.packets.size();
    const std::size_t lag = schedule.lag;
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
        // Where most packets depend on their predecessors, four bars at a time wait for the last of them.
        const bool is_wide = under_way * length > 2 * schedule.levels || length > 2 * lag;
        (has_avx2 && is_wide ? run_by_avx2 : run_by_sse2)(p, std::span(cursors.data(), under_way), packets);
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
    const Pointers pointers{schedule.packets.data(),
                            schedule.shares.data(),
                            schedule.share_index.data(),
                            schedule.updates.data(),
                            schedule.update_begin.data(),
                            motion.position_m.data(),
                            motion.move_m.data(),
                            motion.unrelaxed_m.data(),
                            motion.last_move_m.data(),
                            motion.push_m.data(),
                            motion.keep};
    if (!schedule.packets.empty())
        return run_staggered(pointers, sweeps, schedule, kernel == RelaxationKernel::kAvx2);
    for (std::uint64_t sweep = sweeps.begin; sweep < sweeps.end; ++sweep) {
        if (!sweeps.updates_before(sweep)) continue;
        for (const std::uint32_t particle : schedule.updates) update_particle(pointers, particle);
    }
#endif
}

}  // namespace corda::sim
