#include "corda/sim/relaxation_kernels.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#include "corda/sim/distance.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
// Inlined into functions for newer CPUs, and compiled for those there.
#define CORDA_INLINE [[gnu::always_inline]] inline
#define CORDA_TARGET_AVX [[gnu::target("avx")]]
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
    // Two particles in one place have no direction to be pushed along; other bars part them.
    if (distance == 0.0) return;
    const double adjust = distance - rest_m;
    const double move_x = dx / distance * adjust;
    const double move_y = dy / distance * adjust;
    a[0] += share_a * move_x;
    a[1] += share_a * move_y;
    b[0] -= share_b * move_x;
    b[1] -= share_b * move_y;
}

/// The passes of particles without bars.
void run_updates(std::span<const std::uint32_t> particles, const RelaxationPasses& passes,
                 RelaxationMotion& motion) {
    for (std::uint64_t pass = passes.starts_updated ? passes.sweeps : 0; pass < passes.count;
         pass += passes.sweeps) {
        for (const std::uint32_t particle : particles) {
            update(std::size_t{2} * particle, motion);
            update(std::size_t{2} * particle + 1, motion);
        }
    }
}

#if defined(__x86_64__)

/// Passes under way at once. Three hide a bar's latency behind one another where the rope is long enough for
/// so many; more share what a rope too large for the caches reads from memory.
constexpr std::size_t kPassesAtOnce = 6;

/// With more independent packets at a time, four bars at once are faster than two and two. With fewer, bars
/// wait for one another, and the fewer of them share an instruction, the sooner it has all it needs.
constexpr std::size_t kPacketsALevel = 2;

/// A pass under way.
struct Cursor {
    std::size_t packet = 0;  ///< the next one
    bool updates = false;    ///< this pass is the first of a step
};

/// What a kernel needs of a schedule and of the motion, at hand.
struct Pointers {
    const RelaxationPacket* packets;
    const PacketShares* shares;
    const std::uint32_t* share_index;
    const std::uint32_t* updates;
    const std::uint32_t* update_begin;
    double* position_m;
    double* move_m;
    double* unrelaxed_m;
    double* last_move_m;
    const double* push_m;
    double keep;

    [[nodiscard]] const PacketShares& shares_of(std::size_t k) const { return shares[share_index[k]]; }
};

/// Relaxes the bars in lanes `from` to `from` + `count` - 1: for those that a bar without length is among.
[[gnu::noinline, gnu::cold]] void relax_one_by_one(const Pointers& p, std::size_t k, std::size_t from,
                                                   std::size_t count) {
    const RelaxationPacket& packet = p.packets[k];
    const PacketShares& shares = p.shares_of(k);
    for (std::size_t lane = from; lane < from + count; ++lane) {
        const bool is_repeated =
            std::count(packet.a.begin() + from, packet.a.begin() + lane, packet.a[lane]) > 0;
        if (is_repeated) continue;
        relax(p.position_m + packet.a[lane], p.position_m + packet.b[lane], packet.rest_m[lane],
              shares.a[PacketShares::kPlaceOfLane[lane]], shares.b[PacketShares::kPlaceOfLane[lane]]);
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

CORDA_INLINE void update_ahead_of(const Pointers& p, std::size_t k) {
    for (std::uint32_t j = p.update_begin[k]; j < p.update_begin[k + 1]; ++j)
        update_particle(p, p.updates[j]);
}

/// Relaxes the bars in lanes `from` and `from` + 1 of packet k.
CORDA_INLINE void relax_two(const Pointers& p, std::size_t k, std::size_t from) {
    const RelaxationPacket& packet = p.packets[k];
    double* const a0 = p.position_m + packet.a[from];
    double* const a1 = p.position_m + packet.a[from + 1];
    double* const b0 = p.position_m + packet.b[from];
    double* const b1 = p.position_m + packet.b[from + 1];
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
        return relax_one_by_one(p, k, from, 2);
    const __m128d adjust = _mm_sub_pd(distance, _mm_load_pd(packet.rest_m.data() + from));
    const __m128d move0 =
        _mm_mul_pd(_mm_div_pd(along0, _mm_unpacklo_pd(distance, distance)), _mm_unpacklo_pd(adjust, adjust));
    const __m128d move1 =
        _mm_mul_pd(_mm_div_pd(along1, _mm_unpackhi_pd(distance, distance)), _mm_unpackhi_pd(adjust, adjust));
    const double* const share_a = p.shares_of(k).a.data() + from;
    const double* const share_b = p.shares_of(k).b.data() + from;
    _mm_storeu_pd(a0, _mm_add_pd(at_a0, _mm_mul_pd(_mm_load_pd(share_a), move0)));
    _mm_storeu_pd(a1, _mm_add_pd(at_a1, _mm_mul_pd(_mm_load_pd(share_a + 4), move1)));
    _mm_storeu_pd(b0, _mm_sub_pd(at_b0, _mm_mul_pd(_mm_load_pd(share_b), move0)));
    _mm_storeu_pd(b1, _mm_sub_pd(at_b1, _mm_mul_pd(_mm_load_pd(share_b + 4), move1)));
}

/// Runs `packets` packets of each pass under way, one of each in turn.
void run_sse2(const Pointers& p, std::span<Cursor> passes, std::size_t packets) {
    for (; packets > 0; --packets) {
        for (Cursor& pass : passes) {
            const std::size_t k = pass.packet++;
            if (pass.updates) update_ahead_of(p, k);
            relax_two(p, k, 0);
            if (!p.packets[k].is_half()) relax_two(p, k, 2);
        }
    }
}

/// (x, y) of two particles.
CORDA_TARGET_AVX CORDA_INLINE __m256d load_two(const double* first, const double* second) {
    return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(first)), _mm_loadu_pd(second), 1);
}

CORDA_TARGET_AVX CORDA_INLINE void store_two(double* first, double* second, __m256d value) {
    _mm_storeu_pd(first, _mm256_castpd256_pd128(value));
    _mm_storeu_pd(second, _mm256_extractf128_pd(value, 1));
}

/// Lanes 0 0 2 2 and 1 1 3 3 of `v`: a number for x and for y of the bars 0 and 2, and 1 and 3.
CORDA_TARGET_AVX CORDA_INLINE __m256d even(__m256d v) {
    return _mm256_movedup_pd(v);
}
CORDA_TARGET_AVX CORDA_INLINE __m256d odd(__m256d v) {
    return _mm256_permute_pd(v, 0xf);
}

/// Relaxes all bars of packet k.
CORDA_TARGET_AVX CORDA_INLINE void relax_four(const Pointers& p, std::size_t k) {
    const RelaxationPacket& packet = p.packets[k];
    double* const position = p.position_m;
    const __m256d at_a02 = load_two(position + packet.a[0], position + packet.a[2]);
    const __m256d at_a13 = load_two(position + packet.a[1], position + packet.a[3]);
    const __m256d at_b02 = load_two(position + packet.b[0], position + packet.b[2]);
    const __m256d at_b13 = load_two(position + packet.b[1], position + packet.b[3]);
    const __m256d along02 = _mm256_sub_pd(at_b02, at_a02);
    const __m256d along13 = _mm256_sub_pd(at_b13, at_a13);
    const __m256d square02 = _mm256_mul_pd(along02, along02);
    const __m256d square13 = _mm256_mul_pd(along13, along13);
    const __m256d distance = _mm256_sqrt_pd(
        _mm256_add_pd(_mm256_unpacklo_pd(square02, square13), _mm256_unpackhi_pd(square02, square13)));
    const __m256d has_no_length = _mm256_cmp_pd(distance, _mm256_setzero_pd(), _CMP_EQ_OQ);
    if (_mm256_movemask_pd(has_no_length) != 0) [[unlikely]]
        return relax_one_by_one(p, k, 0, 4);
    const __m256d adjust = _mm256_sub_pd(distance, _mm256_load_pd(packet.rest_m.data()));
    const __m256d move02 = _mm256_mul_pd(_mm256_div_pd(along02, even(distance)), even(adjust));
    const __m256d move13 = _mm256_mul_pd(_mm256_div_pd(along13, odd(distance)), odd(adjust));
    const double* const share_a = p.shares_of(k).a.data();
    const double* const share_b = p.shares_of(k).b.data();
    store_two(position + packet.a[0], position + packet.a[2],
              _mm256_add_pd(at_a02, _mm256_mul_pd(_mm256_load_pd(share_a), move02)));
    store_two(position + packet.a[1], position + packet.a[3],
              _mm256_add_pd(at_a13, _mm256_mul_pd(_mm256_load_pd(share_a + 4), move13)));
    store_two(position + packet.b[0], position + packet.b[2],
              _mm256_sub_pd(at_b02, _mm256_mul_pd(_mm256_load_pd(share_b), move02)));
    store_two(position + packet.b[1], position + packet.b[3],
              _mm256_sub_pd(at_b13, _mm256_mul_pd(_mm256_load_pd(share_b + 4), move13)));
}

CORDA_TARGET_AVX void run_avx(const Pointers& p, std::span<Cursor> passes, std::size_t packets) {
    for (; packets > 0; --packets) {
        for (Cursor& pass : passes) {
            const std::size_t k = pass.packet++;
            if (pass.updates) update_ahead_of(p, k);
            if (p.packets[k].is_half()) {
                relax_two(p, k, 0);
            } else {
                relax_four(p, k);
            }
        }
    }
}

/// Runs `passes` of `length` packets, each `lag` packets or more behind the one before: calls run(cursors,
/// packets) for stretches in which no pass begins or ends.
template <class Run>
void run_staggered(const RelaxationPasses& passes, std::size_t length, std::size_t lag, const Run& run) {
    std::array<Cursor, kPassesAtOnce> cursors;
    std::size_t under_way = 0;
    std::uint64_t begun = 0;
    const auto may_begin = [&] { return begun < passes.count && under_way < cursors.size(); };
    while (begun < passes.count || under_way > 0) {
        if (may_begin() && (under_way == 0 || cursors[under_way - 1].packet >= lag)) {
            const bool updates = begun % passes.sweeps == 0 && !(begun == 0 && passes.starts_updated);
            cursors[under_way++] = {0, updates};
            ++begun;
        }
        std::size_t packets = length - cursors[0].packet;
        if (may_begin()) packets = std::min(packets, lag - cursors[under_way - 1].packet);
        run(std::span(cursors.data(), under_way), packets);
        if (cursors[0].packet < length) continue;
        std::copy(cursors.begin() + 1, cursors.begin() + under_way, cursors.begin());
        --under_way;
    }
}

#endif

}  // namespace

std::span<const RelaxationKernel> relaxation_kernels() {
#if defined(__x86_64__)
    static constexpr std::array kKernels{RelaxationKernel::kScalar, RelaxationKernel::kSse2,
                                         RelaxationKernel::kAvx};
    return std::span(kKernels).first(__builtin_cpu_supports("avx") != 0 ? 3 : 2);
#else
    static constexpr std::array kKernels{RelaxationKernel::kScalar};
    return kKernels;
#endif
}

void run_passes(std::span<const RelaxationBar> bars, const RelaxationPasses& passes,
                RelaxationMotion& motion) {
    double* const position = motion.position_m.data();
    for (std::uint64_t pass = 0; pass < passes.count; ++pass) {
        if (pass % passes.sweeps == 0 && !(pass == 0 && passes.starts_updated)) {
            for (std::size_t k = 0; k < motion.position_m.size(); ++k) update(k, motion);
        }
        for (const RelaxationBar& bar : bars) {
            relax(position + std::size_t{2} * bar.a, position + std::size_t{2} * bar.b, bar.rest_m,
                  bar.share_a, bar.share_b);
        }
    }
}

void run_passes(const RelaxationSchedule& schedule, const RelaxationPasses& passes,
                [[maybe_unused]] RelaxationKernel kernel, RelaxationMotion& motion) {
    assert(kernel != RelaxationKernel::kScalar);
    if (schedule.packets.empty()) return run_updates(schedule.updates, passes, motion);
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
    const auto run = [&](std::span<Cursor> cursors, std::size_t packets) {
        const bool is_wide = cursors.size() * schedule.packets.size() > kPacketsALevel * schedule.levels;
        if (kernel == RelaxationKernel::kAvx && is_wide) {
            run_avx(pointers, cursors, packets);
        } else {
            run_sse2(pointers, cursors, packets);
        }
    };
    run_staggered(passes, schedule.packets.size(), schedule.lag, run);
#endif
}

}  // namespace corda::sim
