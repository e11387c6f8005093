#include "corda/sim/exact/radau_chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/cpu.hpp"
#include "corda/sim/exact/chain_closing.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {
namespace {

using namespace radau;

/// Share of the tolerance that one step may use. Errors add up: 40 of them in 4 s of a swing of 1000 links.
constexpr double kShareOfAnImplicitStep = 0.002;
/// Shares of the length below which estimates are rounding alone.
constexpr double kMinShareOfAnImplicitStep = 1e-14;
constexpr double kMinCorrection = 1e-14;
/// Share of a step's tolerance that Newton's method may leave.
constexpr double kShareOfNewton = 0.03;
/// Share of the length by which a link's angle counts in Newton's method: links that are not solved well turn
/// to and fro without displacing much, until the motion is lost. At a share of 0 to 0.01 swings of 10 000
/// links are lost at tolerances of 1e-2 and 1e-3.
constexpr double kShareOfAngle = 0.1;
constexpr int kMaxNewtonIterations = 7;
/// Errors in parts of the tolerance that are taken for small ones.
constexpr double kMinError = 1e-9;
constexpr double kMinLastError = 1e-2;
/// A link that turns farther in one step is not followed: half the range of cosine_sine_of_small().
constexpr double kMaxTurn = 0.5 * kSmallAngle;
/// Cost of an iteration per link, in updates of count_work().
constexpr std::uint64_t kUpdatesPerIteration = 1;

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

/// Residuals of (4) and (3) at the stages, with opposite signs, in the eigenvectors of B.
CORDA_AVX2_CLONES void residuals(RadauChain& r) {
    const double per_step = 1.0 / r.step_s;
    for (Index i = 1; i <= r.links; ++i) {
        double speed[3];
        double across[3];
        double along[3];
        for (int k = 0; k < 3; ++k)
            speed[k] = per_step * slope_at(k, r.turn[0][i], r.turn[1][i], r.turn[2][i]);
        const double before = r.omega[i];
        for (int k = 0; k < 3; ++k) {
            const double slope =
                per_step * slope_at(k, speed[0] - before, speed[1] - before, speed[2] - before);
            const double next = r.tension[k][i + 1];
            const double last = r.tension[k][i - 1];
            across[k] =
                r.ws[k][i] * next - r.ws[k][i - 1] * last - r.length_m[i] * (slope + r.drag_1_s * speed[k]);
            along[k] = (r.inverse_mass_1_kg[i - 1] + r.inverse_mass_1_kg[i]) * r.tension[k][i] -
                       r.wc[k][i] * next - r.wc[k][i - 1] * last - r.length_m[i] * (speed[k] * speed[k]);
        }
        const auto combine = [](const double* x, int row) {
            return kTo[row][0] * x[0] + kTo[row][1] * x[1] + kTo[row][2] * x[2];
        };
        r.across[i] = combine(across, 0);
        r.along[i] = combine(along, 0);
        r.complex_across[i] = {combine(across, 1), combine(across, 2)};
        r.complex_along[i] = {combine(along, 1), combine(along, 2)};
    }
}

/// The bodies that implicit steps can move.
const std::vector<Body>& bodies_of(const System& system) {
    if (ImplicitPart::can_move(system, system.bodies.front())) return system.bodies;
    throw Refusal(
        Refusal::Reason::kImplicit,
        "implicit steps move ropes of rigid links with a pin that neither resist bending nor are strings");
}

void measure_joints(RadauChain& r) {
    for (Index j = 1; j < r.links; ++j) {
        r.joint_c[j] = r.c[j] * r.c[j + 1] + r.s[j] * r.s[j + 1];
        r.joint_s[j] = r.c[j] * r.s[j + 1] - r.s[j] * r.c[j + 1];
    }
}

/// A chain of `dynamics` that starts pinned, at its initial state.
RadauChain make_radau_chain(ChainDynamics& dynamics, const System& system, const Chain& chain,
                            double tolerance) {
    const Chains& chains = dynamics.chains();
    RadauChain r;
    r.links = chain.link_count;
    r.first_link = chain.first_link;
    r.link_stride = chains.link_count();
    r.ends_pinned = chain.ends_pinned;
    r.drag_1_s = chains.forces.drag_1_s();
    r.control = step_control(chain.inverse_timescale_1_s, tolerance);
    r.tolerance_m = std::max(kShareOfAnImplicitStep * tolerance, kMinShareOfAnImplicitStep) * chain.length_m;
    r.chain_length_m = chain.length_m;
    r.step_s = r.control.first_s;
    const auto resize = [&r](RadauChain::Array& array) { array.assign(r.links + 2, 0.0); };
    for (RadauChain::Array* array :
         {&r.length_m, &r.inverse_mass_1_kg, &r.c, &r.s, &r.omega, &r.slope, &r.old_c, &r.old_s, &r.old_omega,
          &r.old_slope, &r.turned, &r.joint_c, &r.joint_s, &r.matrix_wc, &r.matrix_ws, &r.matrix_tension,
          &r.matrix_omega, &r.across, &r.along})
        resize(*array);
    for (RadauChain::Stages* stages : {&r.turn, &r.tension, &r.old_turn, &r.old_tension, &r.wc, &r.ws})
        std::for_each(stages->begin(), stages->end(), resize);
    r.complex_across.resize(r.links + 2);
    r.complex_along.resize(r.links + 2);
    r.pivots.resize(r.links + 2);
    r.complex_pivots.resize(r.links + 2);
    const double* const y = dynamics.initial_state().data();
    std::vector<double> slope(dynamics.initial_state().size());
    std::vector<double> tension_n(system.bars.size());
    dynamics.derivative(y, slope.data());
    dynamics.tensions(y, tension_n);
    for (Index i = 1; i <= r.links; ++i) {
        const Index link = r.first_link + i - 1;
        r.length_m[i] = chains.length_m[link];
        r.inverse_mass_1_kg[i] = chains.inverse_mass_1_kg[link];
        r.c[i] = y[link];
        r.s[i] = y[r.link_stride + link];
        r.omega[i] = y[2 * r.link_stride + link];
        r.slope[i] = slope[2 * r.link_stride + link];
        for (RadauChain::Array& stage : r.old_tension) stage[i] = tension_n[chain.lower_particle(i - 1)];
    }
    measure_joints(r);
    return r;
}

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
        const std::array<double, 3> of_tension = weights_of_stages(time, false);
        for (Index i = 1; i <= r.links; ++i) {
            r.turn[k][i] =
                of_turn[0] * r.old_turn[0][i] + of_turn[1] * r.old_turn[1][i] + of_turn[2] * r.old_turn[2][i];
            r.tension[k][i] = of_tension[0] * r.old_tension[0][i] + of_tension[1] * r.old_tension[1][i] +
                              of_tension[2] * r.old_tension[2][i];
        }
    }
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
    residuals(r);
    for (Index k = 0; k < RadauChain::kStages; ++k) {
        for (const Index i : {Index{1}, r.links}) {
            const Pull here = pull_of_pin(r, i, k);
            r.across[i] += kTo[0][k] * here.across;
            r.along[i] -= kTo[0][k] * here.along;
            r.complex_across[i] = r.complex_across[i] + here.across * Complex{kTo[1][k], kTo[2][k]};
            r.complex_along[i] = r.complex_along[i] - here.along * Complex{kTo[1][k], kTo[2][k]};
            if (!r.ends_pinned) break;
        }
    }
}

Matrix matrix_of(const RadauChain& r) {
    return {r.length_m.data(),  r.inverse_mass_1_kg.data(), r.matrix_wc.data(),
            r.matrix_ws.data(), r.matrix_tension.data(),    r.matrix_omega.data()};
}

void factorise(RadauChain& r) {
    constexpr Index kMiddle = 1;
    turn_joints(r.links, {r.joint_c.data(), r.joint_s.data()}, r.inverse_mass_1_kg.data(),
                r.turn[kMiddle].data(), {r.matrix_wc.data(), r.matrix_ws.data()});
    r.matrix_tension = r.tension[kMiddle];
    const double per_step = 1.0 / r.step_s;
    for (Index i = 1; i <= r.links; ++i) {
        r.matrix_omega[i] = per_step * slope_at(kMiddle, r.turn[0][i], r.turn[1][i], r.turn[2][i]);
    }
    const Matrix matrix = matrix_of(r);
    const double rate = kReal * per_step;
    const Complex pair = per_step * kPair;
    const double square = rate * rate + r.drag_1_s * rate;
    const Complex pair_square = pair * pair + r.drag_1_s * pair;
    for (Index i = 1; i <= r.links; ++i) {
        const Pull pull = pull_of_pin(r, i, kMiddle);
        matrix.eliminate(i, pull, rate, square, r.pivots.data());
        matrix.eliminate(i, pull, pair, pair_square, r.complex_pivots.data());
    }
}

void solve(RadauChain& r) {
    const Matrix matrix = matrix_of(r);
    for (Index i = 1; i <= r.links; ++i) {
        matrix.forward(i, r.pivots[i], r.across.data(), r.along.data());
        matrix.forward(i, r.complex_pivots[i], r.complex_across.data(), r.complex_along.data());
    }
    for (Index i = r.links; i > 0; --i) {
        backward(i, r.pivots[i], r.across.data(), r.along.data());
        backward(i, r.complex_pivots[i], r.complex_across.data(), r.complex_along.data());
    }
}

/// Largest displacement of a particle if the links turn by these small angles.
double displacement_m(const RadauChain& r, const RadauChain::Array& angle) {
    double x_m = 0.0;
    double y_m = 0.0;
    double largest_m2 = 0.0;
    for (Index i = 1; i <= r.links; ++i) {
        const double moved_m = r.length_m[i] * angle[i];
        x_m -= r.s[i] * moved_m;
        y_m += r.c[i] * moved_m;
        const double square_m2 = x_m * x_m + y_m * y_m;
        if (!(square_m2 <= largest_m2)) largest_m2 = square_m2;  // keeps a NaN
    }
    return std::sqrt(largest_m2);
}

/// Returns the largest displacement in m of a particle by the correction at the end of the step; infinite if
/// the stages cannot be used.
double correct(RadauChain& r) {
    double farthest = 0.0;
    double sharpest = 0.0;
    for (Index i = 1; i <= r.links; ++i) {
        const double across[] = {r.across[i], r.complex_across[i].re, r.complex_across[i].im};
        const double along[] = {r.along[i], r.complex_along[i].re, r.complex_along[i].im};
        for (Index k = 0; k < RadauChain::kStages; ++k) {
            r.turn[k][i] += kFrom[k][0] * across[0] + kFrom[k][1] * across[1] + kFrom[k][2] * across[2];
            r.tension[k][i] += kFrom[k][0] * along[0] + kFrom[k][1] * along[1] + kFrom[k][2] * along[2];
        }
        r.turned[i] = kFrom[2][0] * across[0] + kFrom[2][1] * across[1];
        sharpest = std::max(sharpest, std::abs(r.turned[i]));
        const double turn = std::abs(r.turn[2][i]);
        if (!(turn <= farthest)) farthest = turn;
    }
    return farthest <= kMaxTurn
               ? std::max(displacement_m(r, r.turned), kShareOfAngle * r.chain_length_m * sharpest)
               : std::numeric_limits<double>::infinity();
}

bool solve_stages(RadauChain& r) {
    predict(r);
    factorise(r);
    const double enough_m = std::max(kShareOfNewton * r.tolerance_m, kMinCorrection * r.chain_length_m);
    double last_m = 0.0;
    for (r.iterations = 1; r.iterations <= kMaxNewtonIterations; ++r.iterations) {
        count_work(1 + kUpdatesPerIteration * r.links);
        find_residuals(r);
        solve(r);
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

/// Estimated error of the step in m.
double error_m(RadauChain& r) {
    const Matrix matrix = matrix_of(r);
    const double rate = kReal / r.step_s;
    for (Index i = 1; i <= r.links; ++i) {
        double turn = r.step_s * r.omega[i];
        double speed = r.step_s * r.slope[i];
        for (Index k = 0; k < RadauChain::kStages; ++k) {
            const double omega = slope_at(k, r.turn[0][i], r.turn[1][i], r.turn[2][i]) / r.step_s;
            turn += kErrorWeights[k] * r.turn[k][i];
            speed += kErrorWeights[k] * (omega - r.omega[i]);
        }
        turn /= kReal;
        speed /= kReal;
        r.across[i] = r.length_m[i] * rate * ((rate + r.drag_1_s) * turn + speed);
        r.along[i] = 2.0 * r.length_m[i] * r.matrix_omega[i] * rate * turn;
    }
    for (Index i = 1; i <= r.links; ++i) matrix.forward(i, r.pivots[i], r.across.data(), r.along.data());
    for (Index i = r.links; i > 0; --i) backward(i, r.pivots[i], r.across.data(), r.along.data());
    return displacement_m(r, r.across);
}

/// Bound on the rate in 1/s at which compressed links buckle; 0 without compression. Steps resolve it,
/// because an implicit method would damp it.
double buckling_1_s(const RadauChain& r) {
    constexpr Index kEnd = 2;
    double fastest = 0.0;
    for (Index i = 1; i <= r.links; ++i) {
        const double pull_n =
            r.wc[kEnd][i - 1] * r.tension[kEnd][i - 1] + r.wc[kEnd][i] * r.tension[kEnd][i + 1];
        fastest = std::max(fastest, -2.0 * pull_n / r.length_m[i]);
    }
    return std::sqrt(fastest);
}

/// Brings the end of a step of `chain` back to its pin. `y`: a state of the chains for scratch.
void close(RadauChain& r, const Chains& chains, const Chain& chain, double* y) {
    double* const c = y + r.first_link;
    double* const s = c + r.link_stride;
    double* const omega = s + r.link_stride;
    std::copy_n(&r.c[1], r.links, c);
    std::copy_n(&r.s[1], r.links, s);
    std::copy_n(&r.omega[1], r.links, omega);
    close_between_pins(chains, chain, r.end_s + r.step_s, y);
    for (Index i = 1; i <= r.links; ++i)  // small angles
        r.turned[i] += r.c[i] * s[i - 1] - r.s[i] * c[i - 1];
    std::copy_n(c, r.links, &r.c[1]);
    std::copy_n(s, r.links, &r.s[1]);
    std::copy_n(omega, r.links, &r.omega[1]);
}

void accept(RadauChain& r, const Chains& chains, const Chain& chain, double* y) {
    std::swap(r.old_c, r.c);
    std::swap(r.old_s, r.s);
    r.turned = r.turn[2];
    turn_links(r.links + 2, r.turned.data(), {r.old_c.data(), r.old_s.data()}, {r.c.data(), r.s.data()});
    for (Index i = 1; i <= r.links; ++i) {
        double omega[RadauChain::kStages];
        for (Index k = 0; k < RadauChain::kStages; ++k)
            omega[k] = slope_at(k, r.turn[0][i], r.turn[1][i], r.turn[2][i]) / r.step_s;
        r.old_omega[i] = r.omega[i];
        r.old_slope[i] = r.slope[i];
        r.slope[i] =
            slope_at(2, omega[0] - r.omega[i], omega[1] - r.omega[i], omega[2] - r.omega[i]) / r.step_s;
        r.omega[i] = omega[2];
    }
    if (r.ends_pinned) close(r, chains, chain, y);
    measure_joints(r);
    std::swap(r.old_turn, r.turn);
    std::swap(r.old_tension, r.tension);
    r.start_s = std::exchange(r.end_s, r.end_s + r.step_s);
    r.last_step_s = r.step_s;
    ++r.steps;
}

/// Solves a step of step_s. Returns the next step in parts of it; minus that, if it must be repeated.
double next_factor(RadauChain& r) {
    constexpr double kCaution = 0.9;
    constexpr double kMinFactor = 0.125;
    constexpr double kMaxFactor = 8.0;
    constexpr double kEnough = 1.2;  // a change that is worth another matrix
    if (!solve_stages(r)) return -0.5;
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
    factor = std::clamp(factor, kMinFactor, kMaxFactor);
    if (buckling > 0.0) factor = std::min(factor, 1.0 / buckling);
    return factor > 1.0 && factor < kEnough ? 1.0 : factor;
}

Status step(RadauChain& r, const Chains& chains, const Chain& chain, double* y) {
    double most = std::numeric_limits<double>::infinity();  // no growth after a rejected step
    for (;;) {
        r.step_s = std::min(r.step_s, chains.next_key_s(chain, r.end_s) - r.end_s);
        if (r.control.is_too_short(r.step_s, r.end_s) || r.steps == StepControl::kMaxSteps)
            return Status::kDiverged;
        // Time and step agree to the last bit, so that no rounding of times adds up.
        r.step_s = (r.end_s + r.step_s) - r.end_s;
        for (Index k = 0; k < RadauChain::kStages; ++k) {
            const double time_s = r.end_s + kTime[k] * r.step_s;
            r.start_pull_m_s2[k] = chains.forces_at_start(chain).uniform_at(time_s);
            r.end_pull_m_s2[k] = chains.forces_at_end(chain).uniform_at(time_s);
        }
        const double factor = next_factor(r);
        if (factor > 0.0) {
            accept(r, chains, chain, y);
            r.step_s = std::min(std::min(factor, most) * r.last_step_s, r.control.largest_s);
            return Status::kOk;
        }
        r.step_s *= -factor;
        most = 1.0;
        ++r.rejected_steps;
    }
}

/// Writes the chain's part of the state at `time_s`, within the last step, to `y`.
void interpolate(RadauChain& r, double time_s, double* y) {
    const double h = r.last_step_s;
    const double x = (time_s - r.start_s) / h;
    double* const c = y + r.first_link;
    double* const omega = c + 2 * r.link_stride;
    for (Index i = 0; i < r.links; ++i) {
        // Hermite's polynomial of degree 5.
        const double end = r.turned[i + 1];
        const double d0 = h * r.old_omega[i + 1];
        const double d1 = h * r.omega[i + 1];
        const double e0 = h * h * r.old_slope[i + 1];
        const double e1 = h * h * r.slope[i + 1];
        const double p3 = 10.0 * end - 6.0 * d0 - 4.0 * d1 - 1.5 * e0 + 0.5 * e1;
        const double p4 = -15.0 * end + 8.0 * d0 + 7.0 * d1 + 1.5 * e0 - e1;
        const double p5 = 6.0 * end - 3.0 * (d0 + d1) + 0.5 * (e1 - e0);
        r.across[i + 1] = x * (d0 + x * (0.5 * e0 + x * (p3 + x * (p4 + x * p5))));
        omega[i] = (d0 + x * (e0 + x * (3.0 * p3 + x * (4.0 * p4 + x * (5.0 * p5))))) / h;
    }
    turn_links(r.links, &r.across[1], {&r.old_c[1], &r.old_s[1]}, {c, c + r.link_stride});
}

}  // namespace

bool ImplicitPart::can_move(const System& system, const Body& body) {
    return moves_as_chains(system, body) && !body.material.is_string && body.material.compliance_1_n == 0.0 &&
           pin_count(system, body) > 0 && system.bends.empty();
}

ImplicitPart::ImplicitPart(const System& system, const Forces& forces, const ExactDef& def)
    : Exact(system, forces, def), dynamics_(system, bodies_of(system), forces) {
    output_ = dynamics_.initial_state();
    for (const Chain& chain : dynamics_.chains().list)
        chains_.push_back(make_radau_chain(dynamics_, system, chain, def.tolerance));
}

Status ImplicitPart::reach(double time_s, State& state) {
    if (!std::isfinite(time_s)) return Status::kDiverged;
    const Chains& chains = dynamics_.chains();
    for (std::size_t i = 0; i < chains_.size(); ++i) {
        RadauChain& chain = chains_[i];
        while (chain.end_s < time_s) {
            if (step(chain, chains, chains.list[i], output_.data()) == Status::kDiverged)
                return Status::kDiverged;
        }
        if (chain.steps == 0) continue;
        interpolate(chain, time_s, output_.data());
        if (chain.ends_pinned) close_between_pins(chains, chains.list[i], time_s, output_.data());
    }
    dynamics_.set_time(time_s);
    dynamics_.positions(output_.data(), state);
    return Status::kOk;
}

std::uint64_t ImplicitPart::steps() const {
    std::uint64_t sum = 0;
    for (const RadauChain& chain : chains_) sum += chain.steps;
    return sum;
}

std::uint64_t ImplicitPart::rejected_steps() const {
    std::uint64_t sum = 0;
    for (const RadauChain& chain : chains_) sum += chain.rejected_steps;
    return sum;
}

}  // namespace corda::sim
