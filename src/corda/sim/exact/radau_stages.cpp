#include "corda/sim/exact/radau_stages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "corda/core/cpu.hpp"

namespace corda::sim {
namespace {

using namespace radau;

/// Share of the length by which a link's angle counts in Newton's method: links that are not solved well turn
/// to and fro without displacing much. Without it, 10 000 links that whip take 1.3 times as long.
constexpr double kShareOfAngle = 1e-4;
constexpr Index kMiddle = 1;  // stage at which the matrix is measured
/// A link that turns farther in one step is not followed: half the range of cosine_sine_of_small().
constexpr double kMaxTurn = 0.5 * kSmallAngle;

/// Turns joints from those of the step's start to those of a stage, times the inverse mass. No arrays
/// overlap.
CORDA_AVX2_CLONES void turn_joints(Index links, Directions<const double> joint,
                                   const double* __restrict inverse_mass, const double* __restrict turn,
                                   Directions<double> to) {
    const double* __restrict const joint_c = joint.c;
    const double* __restrict const joint_s = joint.s;
    double* __restrict const wc = to.c;
    double* __restrict const ws = to.s;
    for (Index j = 1; j < links; ++j) {
        const auto [c, s] = cosine_sine_of_small(turn[j + 1] - turn[j]);
        wc[j] = inverse_mass[j] * (joint_c[j] * c - joint_s[j] * s);
        ws[j] = inverse_mass[j] * (joint_s[j] * c + joint_c[j] * s);
    }
}

/// Arrays of the links at a stage.
struct AtStage {
    const double *turn, *tension, *wc, *ws;

    AtStage(const RadauChain& r, Index k)
        : turn(r.turn[k].data()), tension(r.tension[k].data()), wc(r.wc[k].data()), ws(r.ws[k].data()) {}
};

/// How a link turns and stretches at a stage.
struct LinkRates {
    double speed, slope, rate, curve;
};

/// Residuals of (4) and (3), or of (16) and (17), at a stage, with opposite signs.
template <bool kStretches>
CORDA_INLINE Pull residual(const RadauChain& r, const double* length_m, const double* inverse_mass,
                           const double* stretch_m_n, const AtStage& at, Index i, const LinkRates& rates) {
    const double next = at.tension[i + 1];
    const double last = at.tension[i - 1];
    double length = length_m[i];
    if constexpr (kStretches) length += stretch_m_n[i] * at.tension[i];
    double across = at.ws[i] * next - at.ws[i - 1] * last - length * (rates.slope + r.drag_1_s * rates.speed);
    double along = (inverse_mass[i - 1] + inverse_mass[i]) * at.tension[i] - at.wc[i] * next -
                   at.wc[i - 1] * last - length * (rates.speed * rates.speed);
    if constexpr (kStretches) {
        across -= 2.0 * (stretch_m_n[i] * rates.rate) * rates.speed;
        along += stretch_m_n[i] * (rates.curve + r.drag_1_s * rates.rate);
    }
    return {along, across};
}

/// Finds all residuals, in the eigenvectors of B.
template <bool kStretches>
CORDA_INLINE void find_residuals_of_links(RadauChain& r) {
    const double per_step = 1.0 / r.step_s;
    const AtStage first(r, 0);
    const AtStage middle(r, 1);
    const AtStage last(r, 2);
    const double* const length_m = r.length_m.data();
    const double* const inverse_mass = r.inverse_mass_1_kg.data();
    const double* const omega = r.omega.data();
    const double* const stretch_m_n = r.stretch_m_n.data();
    const double* const pull = r.pull.data();
    const double* const pull_rate = r.pull_rate.data();
    double* const across_0 = r.across[0].data();
    double* const across_1 = r.across[1].data();
    double* const across_2 = r.across[2].data();
    double* const along_0 = r.along[0].data();
    double* const along_1 = r.along[1].data();
    double* const along_2 = r.along[2].data();
    const Index links = r.links;
    CORDA_INDEPENDENT
    for (Index i = 1; i <= links; ++i) {
        const Three speed = Three{first.turn[i], middle.turn[i], last.turn[i]}.slopes(0.0, per_step);
        const Three slope = speed.slopes(omega[i], per_step);
        Three rate{};
        Three curve{};
        if constexpr (kStretches) {
            rate = Three{first.tension[i], middle.tension[i], last.tension[i]}.slopes(pull[i], per_step);
            curve = rate.slopes(pull_rate[i], per_step);
        }
        const auto at = [&](const AtStage& stage, const LinkRates& rates) {
            return residual<kStretches>(r, length_m, inverse_mass, stretch_m_n, stage, i, rates);
        };
        const Pull a = at(first, {speed.first, slope.first, rate.first, curve.first});
        const Pull b = at(middle, {speed.middle, slope.middle, rate.middle, curve.middle});
        const Pull c = at(last, {speed.last, slope.last, rate.last, curve.last});
        const Three across{a.across, b.across, c.across};
        const Three along{a.along, b.along, c.along};
        across_0[i] = across.weighted(kTo[0]);
        across_1[i] = across.weighted(kTo[1]);
        across_2[i] = across.weighted(kTo[2]);
        along_0[i] = along.weighted(kTo[0]);
        along_1[i] = along.weighted(kTo[1]);
        along_2[i] = along.weighted(kTo[2]);
    }
}
CORDA_AVX2_CLONES void residuals_of_rigid_links(RadauChain& r) {
    find_residuals_of_links<false>(r);
}
CORDA_AVX2_CLONES void residuals_of_stretching_links(RadauChain& r) {
    find_residuals_of_links<true>(r);
}

/// Adds three arrays with these weights. None overlaps with `to`.
CORDA_AVX2_CLONES void add_weighted(Index links, const std::array<double, 3>& weight,
                                    const RadauChain::Stages& of, double* to) {
    const double* const first = of[0].data();
    const double* const middle = of[1].data();
    const double* const last = of[2].data();
    const auto [a, b, c] = weight;
    CORDA_INDEPENDENT
    for (Index i = 1; i <= links; ++i) to[i] = a * first[i] + b * middle[i] + c * last[i];
}

/// The pull that a pin withholds from link `i` at a stage: that at the end enters the other way round.
Pull pull_of_pin(const RadauChain& r, Index i, Index stage) {
    if (i == 1) return pull_of(r.start_pull_m_s2[stage], r.c[1], r.s[1], r.turn[stage][1]);
    if (i < r.links || !r.ends_pinned) return {};
    return pull_of(-1.0 * r.end_pull_m_s2[stage], r.c[i], r.s[i], r.turn[stage][i]);
}

void find_residuals(RadauChain& r) {
    for (Index k = 0; k < RadauChain::kStages; ++k) {
        turn_joints(r.links, {r.joint_c.data(), r.joint_s.data()}, r.inverse_mass_1_kg.data(),
                    r.turn[k].data(), {r.wc[k].data(), r.ws[k].data()});
    }
    if (r.stretches)
        residuals_of_stretching_links(r);
    else
        residuals_of_rigid_links(r);
    for (Index k = 0; k < RadauChain::kStages; ++k) {
        for (const Index i : {Index{1}, r.links}) {
            const Pull here = pull_of_pin(r, i, k);
            for (Index row = 0; row < 3; ++row) {
                r.across[row][i] += kTo[row][k] * here.across;
                r.along[row][i] -= kTo[row][k] * here.along;
            }
            if (!r.ends_pinned) break;
        }
    }
}

template <bool kStretches>
Matrix<kStretches> matrix_of(const RadauChain& r) {
    return {kStretches ? r.matrix_length.data() : r.length_m.data(),
            r.inverse_mass_1_kg.data(),
            r.matrix_wc.data(),
            r.matrix_ws.data(),
            r.matrix_tension.data(),
            r.matrix_omega.data(),
            r.stretch_m_n.data(),
            r.matrix_growth.data(),
            r.matrix_turning.data(),
            r.drag_1_s};
}

/// Measures the links at the middle stage, where the matrix is factorised.
template <bool kStretches>
void measure_middle(RadauChain& r) {
    turn_joints(r.links, {r.joint_c.data(), r.joint_s.data()}, r.inverse_mass_1_kg.data(),
                r.turn[kMiddle].data(), {r.matrix_wc.data(), r.matrix_ws.data()});
    r.matrix_tension = r.tension[kMiddle];
    const double per_step = 1.0 / r.step_s;
    for (Index i = 1; i <= r.links; ++i) {
        const Three speed = Three{r.turn[0][i], r.turn[1][i], r.turn[2][i]}.slopes(0.0, per_step);
        r.matrix_omega[i] = speed.middle;
        if constexpr (kStretches) {
            const Three rate =
                Three{r.tension[0][i], r.tension[1][i], r.tension[2][i]}.slopes(r.pull[i], per_step);
            r.matrix_length[i] = r.length_m[i] + r.stretch_m_n[i] * r.matrix_tension[i];
            r.matrix_growth[i] = r.stretch_m_n[i] * rate.middle;
            r.matrix_turning[i] = speed.slopes(r.omega[i], per_step).middle;
        }
    }
}

template <bool kStretches>
void factorise_links(RadauChain& r) {
    measure_middle<kStretches>(r);
    const Matrix<kStretches> matrix = matrix_of<kStretches>(r);
    const double per_step = 1.0 / r.step_s;
    const double rate = kReal * per_step;
    const Complex pair = per_step * kPair;
    const double square = rate * rate + r.drag_1_s * rate;
    const Complex pair_square = pair * pair + r.drag_1_s * pair;
    const auto pull_at = [&r](Index i) { return pull_of_pin(r, i, kMiddle); };
    const auto two = [](double x) { return both(x, x); };
    const auto two_complex = [](Complex x) { return both(x, x); };
    const Index pairs = r.real_part.pair_count();
    for (Index i = 1; i <= pairs; ++i) {
        const Pair at{i, r.links + 1 - i};
        const Neighbours<Two> near = matrix.neighbours(at);
        PullOf<Two> pull;
        if (i == 1) {
            const Pull first = pull_at(1);
            const Pull last = pull_at(r.links);
            pull = {both(first.along, last.along), both(first.across, last.across)};
        }
        r.real_part.eliminate(matrix, at, near, pull, two(rate), two(square));
        r.complex_part.eliminate(matrix, at, near, pull, two_complex(pair), two_complex(pair_square));
    }
    r.real_part.eliminate_middle(matrix, r.links, pull_at, rate, square);
    r.complex_part.eliminate_middle(matrix, r.links, pull_at, pair, pair_square);
}

/// Solves the systems of all eigenvalues.
void solve(RadauChain& r) {
    const auto matrix = matrix_of<false>(r);
    Substitution real{r.real_part, r.across[0].data(), r.along[0].data()};
    Substitution complex{r.complex_part, ComplexArray{r.across[1].data(), r.across[2].data()},
                         ComplexArray{r.along[1].data(), r.along[2].data()}};
    const Index pairs = r.real_part.pair_count();
    for (Index i = 1; i <= pairs; ++i) {
        const Pair at{i, r.links + 1 - i};
        const Neighbours<Two> near = matrix.neighbours(at);
        real.forward(at, near);
        complex.forward(at, near);
    }
    real.middle(matrix, r.links);
    complex.middle(matrix, r.links);
    for (Index i = pairs; i > 0; --i) {
        real.back({i, r.links + 1 - i});
        complex.back({i, r.links + 1 - i});
    }
}

/// Solves the system of the real eigenvalue.
void solve_real(RadauChain& r) {
    const auto matrix = matrix_of<false>(r);
    Substitution real{r.real_part, r.across[0].data(), r.along[0].data()};
    const Index pairs = r.real_part.pair_count();
    for (Index i = 1; i <= pairs; ++i) {
        const Pair at{i, r.links + 1 - i};
        real.forward(at, matrix.neighbours(at));
    }
    real.middle(matrix, r.links);
    for (Index i = pairs; i > 0; --i) real.back({i, r.links + 1 - i});
}

/// The largest magnitude. NaN does not count.
CORDA_AVX2_CLONES double largest_magnitude(const RadauChain::Array& of) {
    std::array<double, 4> most{};
    const double* const values = of.data();
    const Index fours = of.size() / 4;
    for (Index i = 0; i < fours; ++i) {
        for (Index k = 0; k < 4; ++k) {
            const double value = std::abs(values[4 * i + k]);
            most[k] = value > most[k] ? value : most[k];
        }
    }
    double largest = 0.0;
    for (Index i = 4 * fours; i < of.size(); ++i) largest = std::max(largest, std::abs(values[i]));
    for (const double value : most) largest = std::max(largest, value);
    return largest;
}

/// The largest displacement in m if the links turn by these small angles and, where they stretch, their
/// tensions change by so much. NaN if one is.
template <bool kStretches>
double largest_displacement_m(const RadauChain& r, const RadauChain::Array& angle,
                              const RadauChain::Array& tension) {
    const double* const length_m = kStretches ? r.matrix_length.data() : r.length_m.data();
    const auto of_link = [&](Index i) {
        const double moved_m = length_m[i] * angle[i];
        Vec2 change_m{-r.s[i] * moved_m, r.c[i] * moved_m};
        if constexpr (kStretches)
            change_m = change_m + (r.stretch_m_n[i] * tension[i]) * Vec2{r.c[i], r.s[i]};
        return change_m;
    };
    const auto grow = [](double& most, Vec2 value) {
        const double square = dot(value, value);
        most = square <= most ? most : square;
    };
    // Two links at a time: their sum does not wait for that of all before them.
    Vec2 end_m;
    double odd_m2 = 0.0;
    double even_m2 = 0.0;
    for (Index i = 1; i <= r.links; i += 2) {
        const Vec2 first_m = of_link(i);
        const Vec2 both_m = first_m + of_link(i + 1);  // 0 beyond the last link
        grow(odd_m2, end_m + first_m);
        end_m = end_m + both_m;
        grow(even_m2, end_m);
    }
    return std::sqrt(std::max(even_m2, odd_m2));  // the even one is NaN if one is
}
double displacement_m(const RadauChain& r, const RadauChain::Array& angle, const RadauChain::Array& tension) {
    return r.stretches ? largest_displacement_m<true>(r, angle, tension)
                       : largest_displacement_m<false>(r, angle, tension);
}

/// Adds the corrections to the stages, and leaves those of the end of the step in `turned` and along[0].
CORDA_AVX2_CLONES void add_corrections(RadauChain& r) {
    const auto pointers = [](RadauChain::Stages& of) {
        return std::array{of[0].data(), of[1].data(), of[2].data()};
    };
    const auto [turn_0, turn_1, turn_2] = pointers(r.turn);
    const auto [tension_0, tension_1, tension_2] = pointers(r.tension);
    const auto [across_0, across_1, across_2] = pointers(r.across);
    const auto [along_0, along_1, along_2] = pointers(r.along);
    double* const turned = r.turned.data();
    const Index links = r.links;
    CORDA_INDEPENDENT
    for (Index i = 1; i <= links; ++i) {
        const auto at_stage = [](Index k, double a, double b, double c) {
            return kFrom[k][0] * a + kFrom[k][1] * b + kFrom[k][2] * c;
        };
        turn_0[i] += at_stage(0, across_0[i], across_1[i], across_2[i]);
        turn_1[i] += at_stage(1, across_0[i], across_1[i], across_2[i]);
        turned[i] = at_stage(2, across_0[i], across_1[i], across_2[i]);
        turn_2[i] += turned[i];
        tension_0[i] += at_stage(0, along_0[i], along_1[i], along_2[i]);
        tension_1[i] += at_stage(1, along_0[i], along_1[i], along_2[i]);
        along_0[i] = at_stage(2, along_0[i], along_1[i], along_2[i]);
        tension_2[i] += along_0[i];
    }
}

/// An angle or a tension that changes in a step: its error before the matrix is applied, and that of its
/// rate.
struct RawError {
    double value;
    double rate;
};

/// `rate`, `curve`: the derivatives at the start. `change`: at the stages.
CORDA_INLINE RawError raw_error(double step_s, double rate, double curve, const Three& change) {
    const Three slope = change.slopes(0.0, 1.0 / step_s);
    const Three gained{slope.first - rate, slope.middle - rate, slope.last - rate};
    return {(step_s * rate + change.weighted(kErrorWeights)) / kReal,
            (step_s * curve + gained.weighted(kErrorWeights)) / kReal};
}

/// Right-hand sides of the error estimate, to across[0] and along[0].
template <bool kStretches>
CORDA_INLINE void find_right_sides_of_errors(RadauChain& r) {
    const double* const length_m = kStretches ? r.matrix_length.data() : r.length_m.data();
    const double* const matrix_omega = r.matrix_omega.data();
    const double* const matrix_growth = r.matrix_growth.data();
    const double* const stretch_m_n = r.stretch_m_n.data();
    const double* const omega = r.omega.data();
    const double* const slope = r.slope.data();
    const double* const pull = r.pull.data();
    const double* const pull_rate = r.pull_rate.data();
    const double* const pull_slope = r.pull_slope.data();
    const AtStage first(r, 0);
    const AtStage middle(r, 1);
    const AtStage last(r, 2);
    double* const across = r.across[0].data();
    double* const along = r.along[0].data();
    const double step_s = r.step_s;
    const double drag_1_s = r.drag_1_s;
    const double rate = kReal / step_s;
    const Index links = r.links;
    CORDA_INDEPENDENT
    for (Index i = 1; i <= links; ++i) {
        const auto [angle, speed] =
            raw_error(step_s, omega[i], slope[i], {first.turn[i], middle.turn[i], last.turn[i]});
        across[i] = length_m[i] * rate * ((rate + drag_1_s) * angle + speed);
        along[i] = 2.0 * length_m[i] * matrix_omega[i] * rate * angle;
        if constexpr (kStretches) {
            const auto [tension, tension_rate] = raw_error(
                step_s, pull_rate[i], pull_slope[i],
                {first.tension[i] - pull[i], middle.tension[i] - pull[i], last.tension[i] - pull[i]});
            across[i] += 2.0 * rate * (matrix_growth[i] * angle + stretch_m_n[i] * matrix_omega[i] * tension);
            along[i] -= stretch_m_n[i] * rate * ((rate + drag_1_s) * tension + tension_rate);
        }
    }
}
CORDA_AVX2_CLONES void right_sides_of_rigid_links(RadauChain& r) {
    find_right_sides_of_errors<false>(r);
}
CORDA_AVX2_CLONES void right_sides_of_stretching_links(RadauChain& r) {
    find_right_sides_of_errors<true>(r);
}

}  // namespace

void predict(RadauChain& r) {
    if (r.last_step_s == 0.0) {
        for (RadauChain::Array& stage : r.turn) std::fill(stage.begin(), stage.end(), 0.0);
        r.tension = r.old_tension;
        return;
    }
    const double ratio = r.step_s / r.last_step_s;
    for (Index k = 0; k < RadauChain::kStages; ++k) {
        const double time = 1.0 + ratio * kTime[k];
        std::array<double, 3> of_turn = weights_of_stages(time, true);
        of_turn[2] -= 1.0;
        const std::array<double, 3> of_tension = weights_of_stages(time, r.stretches);
        add_weighted(r.links, of_turn, r.old_turn, r.turn[k].data());
        add_weighted(r.links, of_tension, r.old_tension, r.tension[k].data());
        if (!r.stretches) continue;
        const double of_start = 1.0 - of_tension[0] - of_tension[1] - of_tension[2];
        for (Index i = 1; i <= r.links; ++i) r.tension[k][i] += of_start * r.old_pull[i];
    }
}

void factorise(RadauChain& r) {
    if (r.stretches)
        factorise_links<true>(r);
    else
        factorise_links<false>(r);
}

double correct(RadauChain& r) {
    find_residuals(r);
    solve(r);
    add_corrections(r);
    if (!(largest_magnitude(r.turn[2]) <= kMaxTurn)) return std::numeric_limits<double>::infinity();
    return std::max(displacement_m(r, r.turned, r.along[0]),
                    kShareOfAngle * r.chain_length_m * largest_magnitude(r.turned));
}

double error_m(RadauChain& r) {
    if (r.stretches)
        right_sides_of_stretching_links(r);
    else
        right_sides_of_rigid_links(r);
    solve_real(r);
    return displacement_m(r, r.across[0], r.along[0]);
}

}  // namespace corda::sim
