#include "corda/sim/exact/radau_chain.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/cpu.hpp"
#include "corda/sim/exact/radau_stages.hpp"

namespace corda::sim {
namespace {

using namespace radau;

/// Share of the length below which corrections are rounding alone.
constexpr double kMinCorrection = 1e-14;
/// Share of a step's tolerance that Newton's method may leave: it adds up.
constexpr double kShareOfNewton = 0.001;
constexpr int kMaxNewtonIterations = 7;
/// Errors in parts of the tolerance that are taken for small ones.
constexpr double kMinError = 1e-9;
constexpr double kMinLastError = 1e-2;
/// Cost of an iteration per link, in updates of count_work().
constexpr std::uint64_t kUpdatesPerIteration = 1;

/// Turns directions by small angles. No arrays overlap.
CORDA_AVX2_CLONES void turn_links(Index links, const double* __restrict turn, Directions<const double> from,
                                  Directions<double> to) {
    const double* __restrict const c = from.c;
    const double* __restrict const s = from.s;
    double* __restrict const to_c = to.c;
    double* __restrict const to_s = to.s;
    for (Index i = 0; i < links; ++i) {
        const auto [turn_c, turn_s] = cosine_sine_of_small(turn[i]);
        const double x = c[i] * turn_c - s[i] * turn_s;
        const double y = s[i] * turn_c + c[i] * turn_s;
        // The inverse length, because the length differs from 1 by rounding alone.
        const double shrink = 1.5 - 0.5 * (x * x + y * y);
        to_c[i] = x * shrink;
        to_s[i] = y * shrink;
    }
}

bool solve_stages(RadauChain& r) {
    predict(r);
    factorise(r);
    const double enough_m = std::max(kShareOfNewton * r.tolerance_m, kMinCorrection * r.chain_length_m);
    double last_m = 0.0;
    for (r.iterations = 1; r.iterations <= kMaxNewtonIterations; ++r.iterations) {
        count_work(1 + kUpdatesPerIteration * r.links);
        const double correction_m = correct(r);
        if (correction_m <= enough_m) return true;
        if (!std::isfinite(correction_m)) return false;
        if (r.iterations > 1) {
            const double rate = correction_m / last_m;
            if (!(rate < 1.0)) return false;
            double left_m = correction_m * rate / (1.0 - rate);
            if (left_m <= enough_m) return true;
            for (int k = r.iterations; k < kMaxNewtonIterations; ++k) left_m *= rate;
            if (left_m > enough_m) return false;
        }
        last_m = correction_m;
    }
    return false;
}

/// Bound on the rate in 1/s at which compressed links buckle; 0 without compression. Steps resolve it,
/// because an implicit method would damp it.
double buckling_1_s(const RadauChain& r) {
    constexpr Index kEnd = 2;
    double fastest = 0.0;
    for (Index i = 1; i <= r.links; ++i) {
        const double pull_n =
            r.wc[kEnd][i - 1] * r.tension[kEnd][i - 1] + r.wc[kEnd][i] * r.tension[kEnd][i + 1];
        const double stretch_m = r.stretches ? r.stretch_m_n[i] * r.tension[kEnd][i] : 0.0;
        fastest = std::max(fastest, -2.0 * pull_n / (r.length_m[i] + stretch_m));
    }
    return std::sqrt(fastest);
}

/// True if every link stays longer than a share of its length at rest at all stages: shorter ones may pass
/// through a point, where they have no direction.
bool keeps_lengths(const RadauChain& r) {
    constexpr double kShortest = 0.25;
    for (const RadauChain::Array& tension : r.tension) {
        for (Index i = 1; i <= r.links; ++i) {
            if (!(r.stretch_m_n[i] * tension[i] > (kShortest - 1.0) * r.length_m[i])) return false;
        }
    }
    return true;
}

/// Where derivatives at the end of a step are written.
struct SlopeArrays {
    double *first, *second;
};

/// Finds them for values that were `start` at its start, with the first derivative `before`. No arrays
/// overlap.
template <bool kStartsAt0>
CORDA_INLINE void find_slopes_at_end(Index links, double step_s, const RadauChain::Stages& of,
                                     const double* start, const double* before, SlopeArrays to) {
    const double per_step = 1.0 / step_s;
    const double* const first = of[0].data();
    const double* const middle = of[1].data();
    const double* const last = of[2].data();
    CORDA_INDEPENDENT
    for (Index i = 1; i <= links; ++i) {
        const Three at = Three{first[i], middle[i], last[i]}.slopes(kStartsAt0 ? 0.0 : start[i], per_step);
        to.first[i] = at.last;
        to.second[i] = at.slopes(before[i], per_step).last;
    }
}
CORDA_AVX2_CLONES void slopes_of_turns(const RadauChain& r, SlopeArrays to) {
    find_slopes_at_end<true>(r.links, r.step_s, r.turn, nullptr, r.old_omega.data(), to);
}
CORDA_AVX2_CLONES void slopes_of_tensions(const RadauChain& r, SlopeArrays to) {
    find_slopes_at_end<false>(r.links, r.step_s, r.tension, r.old_pull.data(), r.old_pull_rate.data(), to);
}

/// The polynomial of degree 5 by Hermite that is 0 at the start of a step and `end` at its end, with these
/// first and second derivatives there, times the step and its square.
struct Hermite {
    double d0, e0, p3, p4, p5;

    /// At x in parts of the step.
    [[nodiscard]] double value(double x) const {
        return x * (d0 + x * (0.5 * e0 + x * (p3 + x * (p4 + x * p5))));
    }
    /// Its derivative, times the step.
    [[nodiscard]] double slope(double x) const {
        return d0 + x * (e0 + x * (3.0 * p3 + x * (4.0 * p4 + x * (5.0 * p5))));
    }
};

Hermite hermite(double end, double d0, double d1, double e0, double e1) {
    return {d0, e0, 10.0 * end - 6.0 * d0 - 4.0 * d1 - 1.5 * e0 + 0.5 * e1,
            -15.0 * end + 8.0 * d0 + 7.0 * d1 + 1.5 * e0 - e1, 6.0 * end - 3.0 * (d0 + d1) + 0.5 * (e1 - e0)};
}

}  // namespace

void RadauChain::resize(std::size_t link_count) {
    links = link_count;
    const auto resize = [&](Array& array) { array.assign(links + 2, 0.0); };
    for (Array* array :
         {&length_m, &inverse_mass_1_kg, &c, &s, &omega, &slope, &old_c, &old_s, &old_omega, &old_slope,
          &turned, &joint_c, &joint_s, &matrix_wc, &matrix_ws, &matrix_tension, &matrix_omega})
        resize(*array);
    for (Stages* stages : {&turn, &tension, &old_turn, &old_tension, &wc, &ws, &across, &along})
        std::for_each(stages->begin(), stages->end(), resize);
    real_part.resize(links);
    complex_part.resize(links);
    if (!stretches) return;
    for (Array* array : {&stretch_m_n, &pull, &pull_rate, &pull_slope, &old_pull, &old_pull_rate,
                         &old_pull_slope, &matrix_length, &matrix_growth, &matrix_turning})
        resize(*array);
}

void measure_joints(RadauChain& r) {
    for (Index j = 1; j < r.links; ++j) {
        r.joint_c[j] = r.c[j] * r.c[j + 1] + r.s[j] * r.s[j + 1];
        r.joint_s[j] = r.c[j] * r.s[j + 1] - r.s[j] * r.c[j + 1];
    }
}

void accept_step(RadauChain& r) {
    std::swap(r.old_c, r.c);
    std::swap(r.old_s, r.s);
    r.turned = r.turn[2];
    turn_links(r.links + 2, r.turned.data(), {r.old_c.data(), r.old_s.data()}, {r.c.data(), r.s.data()});
    std::swap(r.old_omega, r.omega);
    std::swap(r.old_slope, r.slope);
    slopes_of_turns(r, {r.omega.data(), r.slope.data()});
    if (r.stretches) {
        std::swap(r.old_pull, r.pull);
        std::swap(r.old_pull_rate, r.pull_rate);
        std::swap(r.old_pull_slope, r.pull_slope);
        r.pull = r.tension[2];
        slopes_of_tensions(r, {r.pull_rate.data(), r.pull_slope.data()});
    }
    std::swap(r.old_turn, r.turn);
    std::swap(r.old_tension, r.tension);
    r.start_s = std::exchange(r.end_s, r.end_s + r.step_s);
    r.last_step_s = r.step_s;
    ++r.steps;
}

double try_step(RadauChain& r) {
    constexpr double kCaution = 0.9;
    constexpr double kMinFactor = 0.125;
    constexpr double kMaxFactor = 8.0;
    constexpr double kEnough = 1.2;  // steps stay as long for a smaller gain
    constexpr double kShorter = 0.7;
    // After a step that was not solved, steps become longer slowly: those as long would not be solved either.
    constexpr double kOfUnsolved = 0.8;
    constexpr double kLongerEachStep = 1.05;
    if (!solve_stages(r) || (r.stretches && !keeps_lengths(r))) {
        r.longest_s = kOfUnsolved * r.step_s;
        return -kShorter;
    }
    const double buckling = r.step_s * buckling_1_s(r);
    if (buckling > 1.0) return -std::max(kMinFactor, kCaution / buckling);
    const double error = std::max(error_m(r) / r.tolerance_m, kMinError);
    const double safety =
        kCaution * (2 * kMaxNewtonIterations + 1) / (2 * kMaxNewtonIterations + r.iterations);
    double factor = safety / std::sqrt(std::sqrt(error));
    if (!(error <= 1.0)) return -std::max(kMinFactor, factor);
    // Gustafsson's predictive controller.
    if (r.last_step_s > 0.0)
        factor *= std::min(1.0, r.step_s / r.last_step_s * std::sqrt(std::sqrt(r.last_error / error)));
    r.last_error = std::max(error, kMinLastError);
    r.longest_s *= kLongerEachStep;
    factor = std::min(std::clamp(factor, kMinFactor, kMaxFactor), std::max(1.0, r.longest_s / r.step_s));
    if (buckling > 0.0) factor = std::min(factor, 1.0 / buckling);
    return factor > 1.0 && factor < kEnough ? 1.0 : factor;
}

void interpolate(RadauChain& r, double time_s, const LinkMotion& to) {
    const double h = r.last_step_s;
    const double x = (time_s - r.start_s) / h;
    for (Index i = 1; i <= r.links; ++i) {
        const Hermite turned = hermite(r.turned[i], h * r.old_omega[i], h * r.omega[i],
                                       h * h * r.old_slope[i], h * h * r.slope[i]);
        r.across[0][i] = turned.value(x);
        to.omega[i - 1] = turned.slope(x) / h;
    }
    turn_links(r.links, &r.across[0][1], {&r.old_c[1], &r.old_s[1]}, {to.c, to.s});
    if (!r.stretches) return;
    for (Index i = 1; i <= r.links; ++i) {
        const Hermite pull = hermite(r.pull[i] - r.old_pull[i], h * r.old_pull_rate[i], h * r.pull_rate[i],
                                     h * h * r.old_pull_slope[i], h * h * r.pull_slope[i]);
        to.length_m[i - 1] = r.length_m[i] + r.stretch_m_n[i] * (r.old_pull[i] + pull.value(x));
        to.growth_m_s[i - 1] = r.stretch_m_n[i] * (pull.slope(x) / h);
    }
}

}  // namespace corda::sim
