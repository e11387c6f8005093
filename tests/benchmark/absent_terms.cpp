// What a term that a scene does not name (compliance, string, bending) costs: the time of a plain rope with
// the terms compiled in, over that with a copy of the simulation in which they are not. Both take turns in
// one program, and the shortest of many runs counts, so that other work of the machine cancels out. The
// places that the linker gives to the loops do not: ratios from 0.99 to 1.01 mean nothing.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <limits>

#include "plain_rope.hpp"

namespace {

/// Shortest times of two ways to do the same, in turns.
template <class WithTerms, class Plain>
void compare(benchmark::State& bench, WithTerms with_terms, Plain plain) {
    double with_terms_s = std::numeric_limits<double>::infinity();
    double plain_s = std::numeric_limits<double>::infinity();
    bool plain_first = false;
    for (auto _ : bench) {
        TimedRun without;
        if (plain_first) without = plain();
        const TimedRun with = with_terms();
        if (!plain_first) without = plain();
        plain_first = !plain_first;
        if (with.seconds == 0.0 || with.tip_x_m != without.tip_x_m || with.tip_y_m != without.tip_y_m) {
            bench.SkipWithError("the two copies do not give the same bits");
            break;
        }
        with_terms_s = std::min(with_terms_s, with.seconds);
        plain_s = std::min(plain_s, without.seconds);
    }
    bench.counters["ratio"] = with_terms_s / plain_s;
    bench.counters["with_terms_s"] = with_terms_s;
    bench.counters["plain_s"] = plain_s;
}

void absent_terms_rope(benchmark::State& bench) {
    const int links = static_cast<int>(bench.range(0));
    const int steps = 20'000 / links;
    compare(
        bench, [&] { return corda::test::time_rope(links, steps); },
        [&] { return corda_plain::test::time_rope(links, steps); });
}

void absent_terms_exact(benchmark::State& bench) {
    const int links = static_cast<int>(bench.range(0));
    const double duration_s = links > 20 ? 0.2 : 2.0;
    compare(
        bench, [&] { return corda::test::time_exact(links, duration_s); },
        [&] { return corda_plain::test::time_exact(links, duration_s); });
}

BENCHMARK(absent_terms_rope)->Arg(20)->Arg(100)->Arg(1000)->MinTime(2.0)->Unit(benchmark::kMillisecond);
BENCHMARK(absent_terms_exact)->Arg(20)->Arg(100)->MinTime(2.0)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
